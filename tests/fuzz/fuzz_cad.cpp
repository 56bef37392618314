// SPDX-License-Identifier: GPL-3.0-or-later
/// Damaged STEP texts against the reader: `fuzz_cad [N] [FIRST SEED]`. A text is refused with an `Error`, or it gives a
/// shape whose nearest points are finite, on it, and not farther than its samples. What OpenCASCADE dies of must become
/// an `Error`.
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "fuzz/arguments.hpp"
#include "fuzz/mutate.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::fuzz {
namespace {

/// Every other text is damaged in its numbers only: up to three digits are others, so that it remains a STEP text.
std::string damaged(const std::string& good, unsigned long long seed) {
  if (seed % 2 == 0) return mutate(good, seed);
  std::mt19937_64 random(seed);
  auto text = good;
  for (auto n = 1 + random() % 3; n > 0;) {
    auto& c = text[random() % text.size()];
    if (c < '0' || c > '9') continue;
    c = static_cast<char>('0' + random() % 10);
    --n;
  }
  return text;
}

/// What is wrong with the nearest points of a shape, or empty.
std::string assess(const geometry::CadSource& source) {
  const auto model = geometry::make_cad_model(source, "mm");
  std::vector<int> all(model->faces().size());
  std::iota(all.begin(), all.end(), 0);
  const geometry::CadSurface surface(model, all);
  for (const auto& face : model->faces())
    for (std::size_t i = 0; i < face.points().size(); i += 1 + face.points().size() / 5) {
      const auto p = face.points()[i] + 0.01 * model->size() * geometry::Vec3{0.3, 0.5, -0.8};
      const auto q = surface.project(p);
      const double allowed = norm(p - face.points()[i]) + 2 * model->largest_tolerance() + 1e-6 * model->size();
      if (!(std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z))) return "a nearest point that is no number";
      if (!(norm(p - q) <= allowed)) return "a sample is nearer than the nearest point";
    }
  return {};
}

int run(unsigned long long n, unsigned long long first) {
  std::ifstream file(PAMR_TEST_DATA "/spool.step", std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(file), {}};
  geometry::require_readable_cad({"good.step", good});
  unsigned long long n_failed = 0, n_read = 0, n_died = 0;
  for (auto seed = first; seed < first + n; ++seed) {
    const geometry::CadSource source{"damaged.step", damaged(good, seed)};
    std::string fault;
    try {
      geometry::require_readable_cad(source);
      ++n_read;
      fault = assess(source);
    } catch (const Error& error) {
      if (n == 1) std::printf("%s\n", error.what());  // one seed alone: what is said of it
      n_died += std::string(error.what()).find("OpenCASCADE failed on it") != std::string::npos;
    } catch (const std::exception& error) {
      fault = error.what();
    }
    if (fault.empty()) continue;
    std::printf("seed %llu: %s\n", seed, fault.c_str());
    ++n_failed;
  }
  std::printf("STEP: %llu damaged texts, %llu read, %llu of which OpenCASCADE died\n", n, n_read, n_died);
  return n_failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace pamr::fuzz

int main(int argc, char** argv) {
  using pamr::fuzz::number_in;
  return pamr::fuzz::run(number_in(argc, argv, 1, 100), number_in(argc, argv, 2, 1));
}
