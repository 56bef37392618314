// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/bulge_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "support/dice.hpp"

namespace pamr::curved {
namespace bulge_energy_test {

using geometry::Vec3;

Vec3 random_vector(test::Dice& dice, double size) {
  return {size * dice.symmetric(), size * dice.symmetric(), size * dice.symmetric()};
}

geometry::TetPoints random_cell(test::Dice& dice) {
  geometry::TetPoints p{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (auto& x : p) x += random_vector(dice, 0.2);
  return p;
}

CellBulges random_bulges(test::Dice& dice, double size) {
  CellBulges bulge;
  for (auto& b : bulge) b = random_vector(dice, size);
  return bulge;
}

SampledRows random_residual(test::Dice& dice, double size) {
  SampledRows residual;
  for (auto& rows : residual)
    for (auto& row : rows) row = random_vector(dice, size);
  return residual;
}

/// A cell with bulges of its edges and a small residual.
struct RandomCase {
  RandomCase(test::Dice& dice, double bulge_size)
      : cell(prepare(random_cell(dice))),
        bulge(random_bulges(dice, bulge_size)),
        residual(random_residual(dice, 0.01)) {}
  StraightCell cell;
  CellBulges bulge;
  SampledRows residual;
};

double& component(CellBulges& bulge, std::size_t i) { return bulge[i / 3][i % 3]; }

double curvature(const BulgeModel& model, CellBulges v, CellBulges w) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < 18; ++i)
    for (std::size_t j = i; j < 18; ++j, ++n)
      sum += model.hessian[n] * (i == j ? component(v, i) * component(w, i)
                                        : component(v, i) * component(w, j) + component(v, j) * component(w, i));
  return sum;
}

CellBulges moved(CellBulges bulge, double length, const CellBulges& direction) {
  for (std::size_t e = 0; e < 6; ++e) bulge[e] += length * direction[e];
  return bulge;
}

double slope(const BulgeModel& model, const CellBulges& direction) {
  double sum = 0;
  for (std::size_t e = 0; e < 6; ++e) sum += dot(model.gradient[e], direction[e]);
  return sum;
}

constexpr Distortion distortions[] = {{0.3, 1}, {0.03, 2}, {1e-3, 3}};

TEST(BulgeEnergy, OfARegularCellIsTwoForEachSample) {
  const geometry::TetPoints regular{Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}};

  const auto cell = prepare(regular);

  EXPECT_NEAR(bulge_energy(cell, {}, nullptr, {0, 1}), 40, 1e-12);
  EXPECT_NEAR(bulge_energy(cell, {}, nullptr, {0, 3}), 40, 1e-12);
  EXPECT_NEAR(smallest_mean_ratio(cell, {}, nullptr), 1, 1e-14);
}

TEST(BulgeEnergy, SeesTheMeanRatioOfAStraightCellOfEitherHand) {
  test::Dice dice(1);
  for (int i = 0; i < 20; ++i) {
    auto corner = random_cell(dice);
    const double expected = std::abs(geometry::mean_ratio(corner));
    EXPECT_NEAR(prepare(corner).mean_ratio, expected, 1e-14);
    EXPECT_NEAR(smallest_mean_ratio(prepare(corner), {}, nullptr), expected, 1e-14);
    std::swap(corner[1], corner[2]);
    EXPECT_NEAR(smallest_mean_ratio(prepare(corner), {}, nullptr), expected, 1e-14);
  }
}

TEST(BulgeEnergy, SeesTheFoldOfAnEdgeThatBulgesThroughItsCell) {
  const auto cell = prepare({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  CellBulges bulge;
  bulge[0] = {0, 0.12, 0.12};  // the determinant at node 1 is 1 - 8 * 0.12
  EXPECT_GT(smallest_mean_ratio(cell, bulge, nullptr), 0);
  bulge[0] = {0, 0.13, 0.13};
  EXPECT_LT(smallest_mean_ratio(cell, bulge, nullptr), 0);
}

TEST(BulgeModel, HasTheGradientOfTheEnergy) {
  test::Dice dice(2);
  int n_folded = 0;
  for (int i = 0; i < 60; ++i) {
    const auto cell = prepare(random_cell(dice));
    const auto bulge = random_bulges(dice, i % 2 == 0 ? 0.05 : 0.5), direction = random_bulges(dice, 1);
    const auto residual = random_residual(dice, 0.05);
    n_folded += smallest_mean_ratio(cell, bulge, &residual) < 0 ? 1 : 0;
    for (auto distortion : distortions) {
      distortion.delta = std::max(distortion.delta, 0.03);  // smooth enough for differences
      const auto energy_at = [&](double length) {
        return bulge_energy(cell, moved(bulge, length, direction), &residual, distortion);
      };
      const double h = 1e-5, difference = (energy_at(h) - energy_at(-h)) / (2 * h);

      const auto model = bulge_model(cell, bulge, &residual, distortion);

      EXPECT_EQ(model.energy, energy_at(0));
      double scale = 0;
      for (const auto& g : model.gradient) scale += norm(g);
      EXPECT_NEAR(slope(model, direction), difference, 1e-5 * scale);
    }
  }
  EXPECT_GT(n_folded, 10);
  EXPECT_LT(n_folded, 50);
}

TEST(BulgeModel, IsPositiveDefiniteForFoldedCellsToo) {
  test::Dice dice(3);
  for (int i = 0; i < 200; ++i) {
    const auto cell = prepare(random_cell(dice));
    const auto bulge = random_bulges(dice, i % 2 == 0 ? 0.05 : 1);
    for (const auto& distortion : distortions) {
      const auto model = bulge_model(cell, bulge, nullptr, distortion);
      for (int k = 0; k < 20; ++k) {
        const auto v = random_bulges(dice, 1);
        EXPECT_GT(curvature(model, v, v), 0);
      }
    }
  }
}

TEST(BulgeModel, HasTheCurvatureOfTheEnergyWhereOneEdgeOfAGoodCellMoves) {
  test::Dice dice(4);
  for (int i = 0; i < 40; ++i) {
    const auto cell = prepare(random_cell(dice));
    const auto bulge = random_bulges(dice, 0.02);
    CellBulges direction;
    direction[dice.below(6)] = random_vector(dice, 1);
    for (const auto& distortion : distortions) {
      if (distortion.delta > 0.1) continue;  // curvature along the determinant is added there
      const auto slope_at = [&](double length) {
        return slope(bulge_model(cell, moved(bulge, length, direction), nullptr, distortion), direction);
      };
      const double h = 1e-5, difference = (slope_at(h) - slope_at(-h)) / (2 * h);

      const auto model = bulge_model(cell, bulge, nullptr, distortion);

      EXPECT_NEAR(curvature(model, direction, direction), difference, 1e-6 * std::abs(difference));
    }
  }
}

TEST(BulgeModel, ModelsOfSomeEdgesAreTheEntriesOfAll) {
  test::Dice dice(11);
  for (int round = 0; round < 20; ++round) {
    const RandomCase given(dice, 0.1);
    const Distortion distortion{0.01, 1 + round % 3};
    const auto whole = bulge_model(given.cell, given.bulge, &given.residual, distortion);
    for (unsigned is_free = 0; is_free < 64; ++is_free) {
      const auto model = bulge_model(given.cell, given.bulge, &given.residual, distortion, is_free);
      EXPECT_EQ(model.energy, whole.energy);
      std::vector<std::size_t> components;
      for (std::size_t e = 0; e < 6; ++e) {
        const bool is_here = (is_free >> e & 1U) != 0;
        EXPECT_EQ(model.gradient[e], is_here ? whole.gradient[e] : Vec3{});
        for (std::size_t k = 0; k < 3 && is_here; ++k) components.push_back(3 * e + k);
      }
      const auto n = components.size();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i; j < n; ++j)
          EXPECT_EQ(model.hessian[triangle_entry(n, i, j)],
                    whole.hessian[triangle_entry(18, components[i], components[j])]);
    }
  }
}

TEST(BulgeModel, EveryProcessorGivesTheSameBits) {
  test::Dice dice(12);
  for (unsigned is_free = 0; is_free < 64; ++is_free) {
    const RandomCase given(dice, 0.3);
    const auto here = bulge_model(given.cell, given.bulge, &given.residual, {1e-3, 3}, is_free);
    const auto anywhere = bulge_model_anywhere(given.cell, given.bulge, &given.residual, {1e-3, 3}, is_free);
    EXPECT_EQ(here.energy, anywhere.energy);
    EXPECT_EQ(here.gradient, anywhere.gradient);
    EXPECT_EQ(here.hessian, anywhere.hessian);
  }
}

}  // namespace bulge_energy_test
}  // namespace pamr::curved
