// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/nearest.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/dice.hpp"

namespace pamr::dsmc {
namespace {

constexpr std::uint32_t begin = 3;  // the cell's first particle

/// `begin` particles of another cell, then `n` in a slab; every fifth is a copy of the one before it.
Particles slab(std::uint32_t n, test::Dice& dice) {
  Particles particles;
  for (std::uint32_t k = 0; k < begin + n; ++k) {
    Particle p;
    p.position = {dice.unit(), 3 + 0.5 * dice.unit(), 1e-3 * dice.unit()};
    if (k >= begin && k % 5 == 4) p.position = particles.position(k - 1);
    p.id = k;
    particles.append(p);
  }
  return particles;
}

/// The definition: every particle looked at, the first of the nearest taken, copies left out.
std::uint32_t obvious(const Particles& p, std::uint32_t n, std::uint32_t first, std::uint32_t excluded) {
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t found = first == 0 ? 1 : 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double distance = squared_norm(p.position(begin + k) - p.position(begin + first));
    if (distance == 0 || tag_of(p.id[begin + k]) == excluded || distance >= least) continue;
    least = distance;
    found = k;
  }
  return found;
}

TEST(NearestInCell, FindsWhatLookingAtAllFinds) {
  test::Dice dice(7);
  NearestInCell nearest;
  for (const std::uint32_t n : {2U, 3U, 48U, 49U, 200U, 3000U}) {
    const auto particles = slab(n, dice);
    for (const std::int64_t n_searches : {1, 1000}) {
      nearest.start(particles, begin, n, n_searches);
      for (std::uint32_t first = 0; first < n; first += 1 + n / 100) {
        const auto neighbor = obvious(particles, n, first, 0);
        EXPECT_EQ(nearest.find(first, 0), neighbor);
        const auto excluded = tag_of(particles.id[begin + neighbor]);
        EXPECT_EQ(nearest.find(first, excluded), obvious(particles, n, first, excluded));
      }
    }
  }
}

TEST(NearestInCell, TakesParticlesThatAllLieInOnePlace) {
  Particles particles;
  for (std::uint32_t k = 0; k < begin + 100; ++k) {
    Particle p;
    p.position = {1, 2, 3};
    p.id = k;
    particles.append(p);
  }
  NearestInCell nearest;
  nearest.start(particles, begin, 100, 1000);

  EXPECT_EQ(nearest.find(0, 0), 1U);
  EXPECT_EQ(nearest.find(7, 0), 0U);
}

}  // namespace
}  // namespace pamr::dsmc
