// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace pamr::dsmc {

/// What random numbers are drawn for; streams of different purposes are independent.
enum class Purpose : std::uint32_t {
  seed = 1,
  inflow,
  inflow_particle,
  wall,
  collision,
  thinning,
  partition_check,
  remainder
};

/// A stream of random numbers that is a pure function of (seed, purpose, subject, step). The subject is a particle, a
/// global cell or a boundary face, so the numbers depend neither on the number of ranks nor on the order of the work.
/// Capacity: 2^32 steps, 2^24 blocks of four 32-bit words per stream.
/// Source: J. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011 (Philox 4x32-10, Random123).
class Random {
 public:
  Random(std::uint64_t seed, Purpose purpose, std::uint64_t subject, std::uint64_t step, std::uint32_t first_block = 0)
      : counter_{{static_cast<std::uint32_t>(subject), static_cast<std::uint32_t>(subject >> 32U),
                  static_cast<std::uint32_t>(step), (static_cast<std::uint32_t>(purpose) << 24U) + first_block}},
        key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)}} {}

  std::uint32_t word() {
    if (used_ == 4) {
      block_ = philox4x32_R(10, counter_, key_);
      ++counter_.v[3];
      used_ = 0;
    }
    return block_.v[used_++];
  }

  /// In the open interval (0, 1), a multiple of 2^-33.
  double uniform() { return (static_cast<double>(word()) + 0.5) * 0x1p-32; }
  /// In the open interval (0, 1), with 52 random bits.
  double uniform_fine() {
    const auto high = static_cast<std::uint64_t>(word()) << 20U;
    return (static_cast<double>(high | (word() >> 12U)) + 0.5) * 0x1p-52;
  }
  /// 0 .. n-1 for n < 2^32.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(word()) * n) >> 32U);
  }

  struct Pair {
    double a = 0, b = 0;
  };
  /// Two independent normal numbers of variance 1.
  Pair normal_pair() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

  /// Energy in `degrees` degrees of freedom at temperature 1 (units of k T): half the sum of so many squared normals.
  double thermal_energy(int degrees) {
    double energy = 0;
    for (int i = 0; i + 1 < degrees; i += 2) energy -= std::log(uniform());
    if (degrees % 2 == 1) {
      const double one = normal_pair().a;
      energy += 0.5 * one * one;
    }
    return energy;
  }

 private:
  philox4x32_ctr_t counter_;
  philox4x32_key_t key_;
  philox4x32_ctr_t block_{};
  unsigned used_ = 4;
};

}  // namespace pamr::dsmc
