// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads damaged surface files of every format, each a mutation of a good one from a fixed seed, and fails when one
/// throws anything but `pamr::Error`, gives an error that does not name the file, takes longer than 5 seconds, or is
/// accepted without being the closed, oriented surface of finite points that it should be. A crash or a standstill
/// fails the test, too: the last line says which seed was on.
///
///     fuzz_surface [N] [FIRST_SEED]        N damaged files of each format (2000)
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "arguments.hpp"
#include "mutate.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "support/triangulations.hpp"

namespace pamr::fuzz {
namespace {

constexpr double processor_seconds = 5;

struct Format {
  const char* name;
  const char* file;
  std::string good;
};

/// Judged without the library: every edge is run through once in each sense, between points that are there.
bool is_closed_surface(const geometry::Triangulation& surface) {
  std::map<std::pair<int, int>, int> runs;
  for (const auto& triangle : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangle[k] < 0 || static_cast<std::size_t>(triangle[k]) >= surface.points.size()) return false;
      ++runs[{triangle[k], triangle[(k + 1) % 3]}];
    }
  const bool is_closed = std::all_of(runs.begin(), runs.end(), [&](const auto& run) {
    const auto back = runs.find({run.first.second, run.first.first});
    return run.first.first != run.first.second && run.second == 1 && back != runs.end() && back->second == 1;
  });
  const bool is_finite = std::all_of(surface.points.begin(), surface.points.end(), [](const geometry::Vec3 p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
  return is_closed && is_finite && !surface.triangles.empty();
}

/// Each blank before the last number of a face as the end of a line that goes on.
std::string joined(std::string obj) {
  for (auto place = obj.find("\nf "); place != std::string::npos; place = obj.find("\nf ", place + 1))
    obj.replace(obj.rfind(' ', obj.find('\n', place + 1)), 1, "\\\n ");
  return obj;
}

/// With a color behind each point.
std::string colored(const std::string& off, const geometry::Triangulation& surface) {
  std::istringstream in(off);
  std::string line, text;
  for (std::size_t n = 0; std::getline(in, line); ++n)
    text += (n == 0 ? "COFF" : line + (n >= 2 && n < 2 + surface.points.size() ? " 1 0.5 0 1" : "")) + "\n";
  return text;
}

/// What was wrong with reading one file, or null.
const char* assess(const std::string& bytes, const std::string& file, bool& accepted) {
  const auto start = std::clock();
  accepted = false;
  const char* fault = nullptr;
  try {
    accepted = true;
    if (!is_closed_surface(geometry::parse_triangulation(bytes, file))) fault = "accepted, but not valid";
  } catch (const Error& error) {
    accepted = false;
    if (std::string(error.what()).find(file) == std::string::npos) fault = "the error does not name the file";
  } catch (const std::exception&) {
    fault = "an exception other than Error";
  }
  if (static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC > processor_seconds) fault = "takes too long";
  return fault;
}

int run(unsigned long long n, unsigned long long first) {
  const auto surface = testing::icosphere(1);
  const Format formats[] = {{"STL, text", "damaged.stl", testing::as_stl_text(surface)},
                            {"STL, bytes", "damaged.stl", testing::as_stl_bytes(surface)},
                            {"OBJ", "damaged.obj", testing::as_obj(surface)},
                            {"PLY, text", "damaged.ply", testing::as_ply_text(surface)},
                            {"PLY, bytes", "damaged.ply", testing::as_ply_bytes(surface)},
                            {"OFF", "damaged.off", testing::as_off(surface)},
                            {"OBJ, joined", "damaged.obj", joined(testing::as_obj(surface))},
                            {"OFF, colors", "damaged.off", colored(testing::as_off(surface), surface)}};
  bool is_good = true;
  for (const auto& format : formats) {
    unsigned long long n_accepted = 0, n_failed = 0;
    bool accepted = false;
    if (assess(format.good, format.file, accepted) != nullptr || !accepted) {
      std::printf("%s: the good file was refused\n", format.name);
      ++n_failed;
    }
    for (auto seed = first; seed < first + n; ++seed) {
      std::printf("%s, seed %llu\r", format.name, seed);
      const char* fault = assess(mutate(format.good, seed), format.file, accepted);
      if (accepted) ++n_accepted;
      if (fault == nullptr) continue;
      std::printf("%s, seed %llu: %s\n", format.name, seed, fault);
      ++n_failed;
    }
    std::printf("%s: %llu damaged files: %llu refused, %llu accepted, %llu failures\n", format.name, n, n - n_accepted,
                n_accepted, n_failed);
    is_good = is_good && n_failed == 0;
  }
  return is_good ? 0 : 1;
}

}  // namespace
}  // namespace pamr::fuzz

int main(int argc, char** argv) {
  using pamr::fuzz::number_in;
  return pamr::fuzz::run(number_in(argc, argv, 1, 2000), number_in(argc, argv, 2, 1));
}
