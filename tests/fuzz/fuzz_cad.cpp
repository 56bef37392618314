// SPDX-License-Identifier: GPL-3.0-or-later
/// Damaged texts of a CAD format against the reader. A text is refused with an `Error` of one line that names the file,
/// or it gives a shape whose nearest points are finite, on it, and not farther than its samples. What OpenCASCADE dies
/// of must become an `Error`, and what it has read once it must not die of later.
///
///     fuzz_step [N] [FIRST SEED]          N damaged files (100); the same for fuzz_iges, fuzz_brep
///     fuzz_step --one SEED FILE           writes the damaged file of a seed
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cli/check_in_child.hpp"
#include "fuzz/arguments.hpp"
#include "fuzz/mutate.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::fuzz {
namespace {

constexpr unsigned processor_seconds = 1;  ///< a good text takes a hundredth of a second
constexpr const char* ending = "." PAMR_FUZZ_CAD;

std::vector<std::string> good_texts() {
  std::vector<std::string> texts;
  for (const auto* name : {"cone", "spool"}) {
    std::ifstream file(std::string(PAMR_TEST_DATA "/") + name + ending, std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return texts;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Up to three digits are others, so that it remains a text of its format.
void change_digits(std::string& text, std::mt19937_64& random) {
  for (auto n = 1 + random() % 3; n > 0;) {
    auto& c = text[random() % text.size()];
    if (!is_digit(c)) continue;
    c = static_cast<char>('0' + random() % 10);
    --n;
  }
}

/// Two numbers of the same length change places: references, counts, coordinates.
void swap_numbers(std::string& text, std::mt19937_64& random) {
  const auto number_at = [&](std::size_t at) {
    auto begin = at, end = at;
    while (begin > 0 && is_digit(text[begin - 1])) --begin;
    while (end < text.size() && is_digit(text[end])) ++end;
    return std::pair(begin, end - begin);
  };
  for (int tries = 0; tries < 1000; ++tries) {
    const auto [a, a_size] = number_at(random() % text.size());
    const auto [b, b_size] = number_at(random() % text.size());
    if (a_size == 0 || a_size != b_size || a == b) continue;
    std::swap_ranges(text.begin() + static_cast<std::ptrdiff_t>(a),
                     text.begin() + static_cast<std::ptrdiff_t>(a + a_size),
                     text.begin() + static_cast<std::ptrdiff_t>(b));
    return;
  }
}

std::string damaged(const std::vector<std::string>& good, unsigned long long seed) {
  auto text = good[seed / 4 % good.size()];
  std::mt19937_64 random(seed);
  switch (seed % 4) {
    case 0:
      return mutate(text, seed);
    case 2:
      swap_numbers(text, random);
      break;
    default:
      change_digits(text, random);
      break;
  }
  return text;
}

/// What is wrong with the nearest points of a shape, or empty. `is_thorough`: its areas and triangles are made, too.
std::string assess(const geometry::CadSource& source, bool is_thorough) {
  const auto model = geometry::make_cad_model(source, "mm");
  std::vector<int> all(model->faces().size());
  std::iota(all.begin(), all.end(), 0);
  const geometry::CadSurface surface(model, all);
  if (is_thorough) {
    (void)geometry::measure_cad_source(source, "mm");
    (void)geometry::triangulate_cad(source.text, 1, 1e-4);
  }
  for (const auto& face : model->faces())
    for (std::size_t i = 0; i < face.points().size(); i += 1 + face.points().size() / 5) {
      const auto p = face.points()[i] + 0.01 * model->size() * geometry::Vec3{0.3, 0.5, -0.8};
      const auto q = surface.project(p);
      const double allowed = norm(p - face.points()[i]) + 2 * model->largest_tolerance() + 2e-5 * model->size();
      if (!(std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z))) return "a nearest point that is no number";
      if (!(norm(p - q) <= allowed)) return "a sample is nearer than the nearest point";
    }
  return {};
}

constexpr rlim_t memory = rlim_t{4} << 30U;

/// As the tools do before they read a text: what is wrong with it, found by a child.
cli::ChildAnswer try_reading(const geometry::CadSource& source, rlim_t seconds) {
  return cli::in_child(
      [&]() -> std::string {
        try {
          (void)geometry::make_cad_model(source, "mm");
        } catch (const Error& error) {
          return error.what();
        }
        return {};
      },
      {seconds, memory});
}

/// `assess` in a process of its own, so that a death belongs to one text.
std::string assess_apart(const geometry::CadSource& source, bool is_thorough) {
  const auto [fault, trouble] = cli::in_child(
      [&]() -> std::string {
        try {
          return assess(source, is_thorough);
        } catch (const std::exception& error) {
          return error.what();
        }
      },
      {20 * processor_seconds, memory});
  return trouble.empty() ? fault : "read by the trial, then OpenCASCADE failed on it: " + trouble;
}

struct Tally {
  unsigned long long read = 0, died = 0, failed = 0;
};

void try_one(const geometry::CadSource& source, unsigned long long seed, bool is_alone, Tally& tally) {
  const auto [said, trouble] = try_reading(source, processor_seconds);
  std::string fault;
  if (is_alone) std::printf("%s%s\n", said.c_str(), trouble.c_str());
  if (!trouble.empty()) {
    ++tally.died;
  } else if (said.empty()) {
    ++tally.read;
    fault = assess_apart(source, seed / 4 % 4 == 0);
  } else if (said.find(source.file) == std::string::npos) {
    fault = "the error does not name the file";
  } else if (said.find('\n') != std::string::npos) {
    fault = "an error of several lines";
  }
  if (fault.empty()) return;
  std::printf("seed %llu: %s\n", seed, fault.c_str());
  ++tally.failed;
}

int run(unsigned long long n, unsigned long long first) {
  const auto good = good_texts();
  for (const auto& text : good) {
    const geometry::CadSource source{std::string("good") + ending, text};
    if (const auto fault = assess_apart(source, true); !fault.empty()) throw Error("a good text: " + fault);
  }
  Tally tally;
  for (auto seed = first; seed < first + n; ++seed)
    try_one({std::string("damaged") + ending, damaged(good, seed)}, seed, n == 1, tally);
  std::printf("%llu damaged files: %llu refused, %llu accepted, %llu failures; OpenCASCADE died of %llu\n", n,
              n - tally.read, tally.read, tally.failed, tally.died);
  return tally.failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace pamr::fuzz

int main(int argc, char** argv) {
  using namespace pamr::fuzz;
  if (argc == 4 && std::string(argv[1]) == "--one") {
    std::ofstream(argv[3], std::ios::binary) << damaged(good_texts(), number_in(argc, argv, 2, 1));
    return 0;
  }
  return run(number_in(argc, argv, 1, 100), number_in(argc, argv, 2, 1));
}
