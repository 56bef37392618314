// SPDX-License-Identifier: GPL-3.0-or-later
/// Describes and repairs damaged surfaces, each a file of a good one that was mutated from a fixed seed and that the
/// reader of any triangles takes, and decimates what became a surface. Fails when that throws, takes longer than 20
/// seconds, calls something the closed surface of a body that the strict reader refuses, or when the decimation exceeds
/// its error or damages the body. A crash or a standstill fails the test, too: the last line
/// says which seed was on.
///
///     fuzz_surface_mesh [N] [FIRST_SEED]        N damaged files of each format (300)
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string>

#include "arguments.hpp"
#include "mutate.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "support/triangulations.hpp"
#include "surface_mesh/decimate.hpp"
#include "surface_mesh/repair.hpp"

namespace pamr::fuzz {
namespace {

constexpr double processor_seconds = 20;
constexpr double error_part = 0.02;  // of the diagonal

struct Format {
  const char* name;
  const char* file;
  std::string good;
};

struct Counts {
  unsigned long long n_read = 0, n_bodies = 0, n_decimated = 0;
};

/// What was wrong with one file, or empty.
std::string assess(const std::string& bytes, const std::string& file, Counts& counts) {
  geometry::Triangulation soup;
  try {
    soup = geometry::parse_soup(bytes, file);
  } catch (const Error&) {
    return {};
  }
  ++counts.n_read;
  const auto start = std::clock();
  try {
    const auto before = surface_mesh::describe(soup);
    const auto done = surface_mesh::repair(soup);
    if (done.left.is_body()) ++counts.n_bodies;
    if (before.is_body()) geometry::require_valid(soup, "called a body", false);
    if (done.left.is_body()) geometry::require_valid(done.surface, "made a body", false);
    if (done.left.is_surface()) {
      ++counts.n_decimated;
      const double error = error_part * done.left.diagonal();
      const auto fewer = surface_mesh::decimate(done.surface, {.error = error});
      if (!(fewer.from_old.at_most <= error && fewer.to_old.at_most <= error)) return "decimation exceeds its error";
      const auto after = surface_mesh::describe(fewer.surface, {.find_deviation = false});
      if (!after.is_surface()) return "decimation leaves no surface";
      if (done.left.is_body() && !after.is_body()) return "decimation damages a body";
    }
  } catch (const std::exception& fault) {
    return fault.what();
  }
  if (static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC > processor_seconds) return "takes too long";
  return {};
}

int run(unsigned long long n, unsigned long long first) {
  const auto surface = testing::icosphere(1);
  const Format formats[] = {{"STL, text", "damaged.stl", testing::as_stl_text(surface)},
                            {"STL, bytes", "damaged.stl", testing::as_stl_bytes(surface)},
                            {"OBJ", "damaged.obj", testing::as_obj(surface)},
                            {"PLY, bytes", "damaged.ply", testing::as_ply_bytes(surface)},
                            {"OFF", "damaged.off", testing::as_off(surface)}};
  bool is_good = true;
  for (const auto& format : formats) {
    Counts counts;
    unsigned long long n_failed = 0;
    for (auto seed = first; seed < first + n; ++seed) {
      std::printf("%s, seed %llu\r", format.name, seed);
      std::fflush(stdout);
      const auto fault = assess(mutate(format.good, seed), format.file, counts);
      if (fault.empty()) continue;
      std::printf("%s, seed %llu: %s\n", format.name, seed, fault.c_str());
      ++n_failed;
    }
    std::printf("%s: %llu damaged files: %llu read, %llu made bodies, %llu decimated, %llu failures\n", format.name, n,
                counts.n_read, counts.n_bodies, counts.n_decimated, n_failed);
    is_good = is_good && n_failed == 0;
  }
  return is_good ? 0 : 1;
}

}  // namespace
}  // namespace pamr::fuzz

int main(int argc, char** argv) {
  using pamr::fuzz::number_in;
  return pamr::fuzz::run(number_in(argc, argv, 1, 300), number_in(argc, argv, 2, 1));
}
