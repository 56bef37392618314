// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/nearest.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "solvers/dsmc/kernel/near_filter.hpp"
#include "support/dice.hpp"

namespace pamr::dsmc {
namespace nearest_test {

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
  for (const std::uint32_t n : {2U, 3U, 12U, 13U, 48U, 200U, 512U, 513U, 1024U, 3000U}) {
    const auto particles = slab(n, dice);
    for (const std::int64_t n_searches : {1, 3, 1000}) {
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

TEST(NearestInCell, TakesTheFirstOfEquallyNearOnesHoweverManyThereAre) {
  Particles particles;
  test::Dice dice(8);
  std::vector<std::uint32_t> place(begin + 343);
  for (std::uint32_t k = 0; k < place.size(); ++k) place[k] = k;
  dice.shuffle(place);
  for (const auto k : place) {
    Particle p;
    p.position = {1 + 0.25 * (k % 7), 0.25 * (k / 7 % 7), 0.25 * (k / 49)};  // exact distances
    p.id = particles.size();
    particles.append(p);
  }
  NearestInCell nearest;
  nearest.start(particles, begin, 343, 1000);

  for (std::uint32_t first = 0; first < 343; ++first) {
    const auto neighbor = obvious(particles, 343, first, 0);
    EXPECT_EQ(nearest.find(first, 0), neighbor);
    const auto excluded = tag_of(particles.id[begin + neighbor]);
    EXPECT_EQ(nearest.find(first, excluded), obvious(particles, 343, first, excluded));
  }
}

TEST(NearestInCell, DecidesWhatSinglePrecisionCannot) {
  // Two neighbors of the middle one whose distances differ by a part in 10^12, and a cell far from the origin.
  for (const double offset : {0.0, 1e3}) {
    Particles particles;
    for (std::uint32_t k = 0; k < begin + 40; ++k) {
      Particle p;
      p.position = {offset + 1 + 0.1 * k, 0, 0};
      if (k == begin + 20) p.position = {offset - 3, 0, 0};
      if (k == begin + 21) p.position = {offset - 3 - 1e-3, 0, 0};
      if (k == begin + 22) p.position = {offset - 3, 1e-3 * (1 - 1e-9), 0};
      p.id = k;
      particles.append(p);
    }
    NearestInCell nearest;
    nearest.start(particles, begin, 40, 1000);

    EXPECT_EQ(nearest.find(20, 0), obvious(particles, 40, 20, 0));
    EXPECT_EQ(nearest.find(20, tag_of(begin + 22)), 21U);
  }
}

TEST(NearFilter, IsNeverSureOfAPointThatIsNotTheNearest) {
  test::Dice dice(9);
  std::int64_t n_sure = 0, n_all = 0;
  for (const double size : {1e-9, 1.0, 1e9}) {
    std::vector<double> x[3];
    for (auto& values : x)
      for (int k = 0; k < 300; ++k) values.push_back(size * (5 + dice.unit()));
    NearFilter filter;
    ASSERT_TRUE(filter.start(x[0], x[1], x[2]));
    const auto distance = [&](std::size_t a, std::size_t b) {
      return squared_norm(Vec3{x[0][a], x[1][a], x[2][a]} - Vec3{x[0][b], x[1][b], x[2][b]});
    };
    for (std::uint32_t k = 0; k < 300; ++k) {
      filter.look_from(k);
      const auto answer = filter.nearest();
      filter.show_all();
      ++n_all;
      if (!answer.is_sure) continue;
      ++n_sure;
      for (std::uint32_t other = 0; other < 300; ++other) {
        if (other == k) continue;
        EXPECT_GE(distance(k, other), distance(k, answer.point));
      }
    }
  }
  EXPECT_GT(n_sure, 0.98 * static_cast<double>(n_all));
}

TEST(NearFilter, RefusesWhatIsBeyondSinglePrecision) {
  NearFilter filter;
  const std::vector<double> one_place(20, 3.0), zero(20, 0.0);
  std::vector<double> tiny(zero), huge(zero);
  tiny[7] = 1e-13;
  huge[7] = 1e13;

  EXPECT_FALSE(filter.start(one_place, one_place, one_place));
  EXPECT_FALSE(filter.start(tiny, zero, zero));
  EXPECT_FALSE(filter.start(zero, huge, zero));
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

}  // namespace nearest_test
}  // namespace pamr::dsmc
