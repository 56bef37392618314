// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/particles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "support/dice.hpp"

namespace pamr::dsmc {
namespace particles_test {

Particle numbered(std::uint64_t id, LocalId cell) {
  Particle p;
  const auto value = static_cast<double>(id);
  p.position = {value, value + 0.25, value + 0.5};
  p.velocity = {-value, 1 - value, 2 - value};
  p.rotation = 3 * value;
  p.id = id;
  p.cell = cell;
  p.species = static_cast<std::uint32_t>(id % 3);
  p.partner = static_cast<std::uint32_t>(id * 2654435761U);  // all 32 bits
  return p;
}

using Row = std::tuple<LocalId, std::uint64_t>;

/// Particles are where `expected` says, and each still has its own values.
void expect_sorted(const Particles& particles, std::vector<Row> expected, LocalId n_cells) {
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(particles.size(), expected.size());
  ASSERT_EQ(particles.begin().size(), static_cast<std::size_t>(n_cells) + 1);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto [cell, id] = expected[i];
    const auto p = particles.get(i), q = numbered(id, cell);
    EXPECT_EQ(std::tuple(p.id, p.cell, p.species, p.partner, p.rotation),
              std::tuple(q.id, q.cell, q.species, q.partner, q.rotation));
    EXPECT_EQ(p.position, q.position);
    EXPECT_EQ(p.velocity, q.velocity);
    EXPECT_GE(i, particles.begin()[static_cast<std::size_t>(cell)]);
    EXPECT_LT(i, particles.begin()[static_cast<std::size_t>(cell) + 1]);
  }
}

TEST(Particles, AreSortedByCellAndIdAfterSomeHaveMovedLeftAndEntered) {
  constexpr LocalId n_cells = 9;
  test::Dice dice(3);
  Particles particles;
  std::uint64_t next = 0;
  const auto enter = [&](int n) {
    for (int k = 0; k < n; ++k) {
      // The first cells hold many, one none. Some ids are above all others, some fall between.
      const auto cell = static_cast<LocalId>(dice.below(3) == 0 ? dice.below(n_cells - 1) : dice.below(2));
      const auto id = (dice.below(2) == 0 ? std::uint64_t{1} << 63U : 0) + 7919 * ++next % 100003;
      particles.append(numbered(id, cell));
    }
  };
  enter(900);
  for (int step = 0; step < 12; ++step) {
    std::vector<Row> expected;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (dice.below(4) == 0) particles.cell[i] = static_cast<LocalId>(dice.below(n_cells - 1));
      if (dice.below(20) == 0) particles.cell[i] = Particles::gone;
      if (particles.cell[i] != Particles::gone) expected.emplace_back(particles.cell[i], particles.id[i]);
    }
    particles.sort_by_cell(n_cells);
    expect_sorted(particles, expected, n_cells);
    enter(40);
  }
}

/// Adapting the mesh makes copies, which have one id until they are numbered.
TEST(Particles, CopiesOfOneAllStay) {
  constexpr LocalId n_cells = 3;
  test::Dice dice(7);
  Particles particles;
  std::vector<Row> expected;
  for (const std::size_t n : {7, 40, 300})  // particles of a cell
    for (std::size_t k = 0; k < n; ++k) {
      const auto cell = n == 7 ? 0 : n == 40 ? 1 : 2;
      const auto id = dice.below(n / 2);
      particles.append(numbered(id, cell));
      expected.emplace_back(cell, id);
    }
  particles.sort_by_cell(n_cells);
  expect_sorted(particles, expected, n_cells);
}

TEST(Particles, GrowBySixteenthsAlsoAfterSortingHasExchangedTheirMemory) {
  constexpr LocalId n_cells = 100;
  constexpr std::uint64_t n = 100'000;
  Particles particles;
  particles.reserve(n);
  std::uint64_t next = 0;
  const auto enter = [&](std::uint64_t count) {
    for (; count > 0; --count, ++next) particles.append(numbered(next, static_cast<LocalId>(next % n_cells)));
  };
  enter(n);
  for (int step = 0; step < 20; ++step) {
    particles.sort_by_cell(n_cells);
    enter(n / 100);
  }
  EXPECT_LE(particles.bytes(), particles.size() * 88 * 107 / 100);  // 76 and 12 for sorting
}

TEST(Particles, AreSortedAnewAfterTheyWereReplacedAndForAnotherNumberOfCells) {
  test::Dice dice(4);
  Particles particles;
  for (const LocalId n_cells : {5, 5, 3, 8, 1}) {
    particles.clear();
    std::vector<Row> expected;
    for (std::uint64_t k = 0; k < 300; ++k) {
      const auto cell = static_cast<LocalId>(dice.below(static_cast<std::size_t>(n_cells)));
      const auto id = 7919 * k % 100003;
      particles.append(numbered(id, cell));
      expected.emplace_back(cell, id);
    }
    particles.sort_by_cell(n_cells);
    expect_sorted(particles, expected, n_cells);
  }
  particles.clear();
  particles.sort_by_cell(4);
  expect_sorted(particles, {}, 4);
}

}  // namespace particles_test
}  // namespace pamr::dsmc
