// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/vibrate.hpp"

#include <algorithm>
#include <cmath>

namespace pamr::dsmc {

std::uint32_t thermal_levels(const Vibration& vibration, double t, Random& random) {
  const auto n = vibration.mode.size();
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double level = -std::log(random.uniform()) * (t / vibration.mode[i]);
    word = levels::with(word, i, n, static_cast<std::uint32_t>(std::min<double>(level, levels::highest(n))));
  }
  return word;
}

std::uint32_t draw_level(double total, double exponent, std::uint32_t highest, Random& random) {
  const auto last = static_cast<std::uint32_t>(std::min<double>(total, highest));
  if (last == 0) return 0;
  for (;;) {
    const auto level = static_cast<std::uint32_t>(random.uniform() * (last + 1.0));
    if (random.uniform() < std::pow(1 - level / total, exponent)) return level;
  }
}

}  // namespace pamr::dsmc
