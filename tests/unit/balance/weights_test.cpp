// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/weights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"

namespace pamr {
namespace weights_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

mesh::DistMesh cube(const par::Comm& comm) { return assemble::assemble(comm, assemble::kuhn_cube(comm, 2)); }

std::string trouble(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Weights, KeepsPositiveIntegersAsTheyAre) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  std::vector<double> weight;
  for (const auto id : mesh.cell_global) weight.push_back(static_cast<double>(1 + id % 5));

  const auto integers = balance::integer_weights(comm, mesh, weight);

  for (std::size_t c = 0; c < weight.size(); ++c) EXPECT_EQ(static_cast<double>(integers[c]), weight[c]);
}

TEST(Weights, KeepsTheProportionsOfTinyAndOfHugeNumbers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  for (const double unit : {1e-300, 0.1, 1e300}) {
    std::vector<double> weight;
    for (const auto id : mesh.cell_global) weight.push_back(unit * static_cast<double>(1 + id % 5));

    const auto integers = balance::integer_weights(comm, mesh, weight);

    std::int64_t here = 0;
    for (std::size_t c = 0; c < weight.size(); ++c) {
      here += integers[c];
      const auto expected = static_cast<double>(1 + mesh.cell_global[c] % 5);
      EXPECT_NEAR(static_cast<double>(integers[c]) / static_cast<double>(integers[0]),
                  expected / static_cast<double>(1 + mesh.cell_global[0] % 5), 1e-6);
    }
    EXPECT_LE(comm.sum(here), balance::max_total_weight);
    EXPECT_GT(comm.sum(here), balance::max_total_weight / 4);
  }
}

TEST(Weights, AreScaledOnAllRanksWhereOneNeedsIt) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  std::vector<double> weight;
  for (const auto id : mesh.cell_global) weight.push_back(id < 24 ? 4 : 0.5);

  const auto integers = balance::integer_weights(comm, mesh, weight);

  std::int64_t heavy = 0, light = 0;
  for (std::size_t c = 0; c < integers.size(); ++c) (mesh.cell_global[c] < 24 ? heavy : light) += integers[c];
  EXPECT_EQ(comm.sum(heavy), 8 * comm.sum(light));
}

TEST(Weights, CountsCellsWithoutWeightALittle) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  std::vector<double> weight;
  for (const auto id : mesh.cell_global) weight.push_back(id == 3 ? 2.0 : 0.0);

  const auto integers = balance::integer_weights(comm, mesh, weight);

  for (std::size_t c = 0; c < weight.size(); ++c)
    EXPECT_EQ(integers[c] > (std::int64_t{1} << 40U), mesh.cell_global[c] == 3) << integers[c];
  for (std::size_t c = 0; c < weight.size(); ++c) EXPECT_EQ(integers[c] == 1, mesh.cell_global[c] != 3);
}

TEST(Weights, NamesTheFirstBadValueOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const auto& [bad, text] : {std::pair{-1.0, "-1"}, std::pair{nan, "nan"}, std::pair{infinity, "inf"}}) {
    std::vector<double> weight(mesh.cell_global.size(), 1);
    for (std::size_t c = 0; c < weight.size(); ++c)
      if (mesh.cell_global[c] == 47) weight[c] = bad;

    EXPECT_THAT(
        trouble([&] { balance::integer_weights(comm, mesh, weight, "particles"); }),
        AllOf(HasSubstr("particles: expected finite numbers of at least 0"), HasSubstr(text), HasSubstr("at cell 47")));
  }
}

TEST(Weights, RefusesWeightsThatAreZeroEverywhereAndListsOfTheWrongLength) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube(comm);
  const auto n = mesh.cell_global.size();

  EXPECT_THAT(trouble([&] { balance::integer_weights(comm, mesh, std::vector<double>(n, 0.0)); }),
              HasSubstr("found 0 in all the 48 cells"));
  EXPECT_THAT(
      trouble([&] { balance::integer_weights(comm, mesh, std::vector<double>(n + (comm.is_first() ? 1 : 0), 1.0)); }),
      HasSubstr("expected one for each of the"));
}

TEST(Weights, ComeFromACellFieldOfEitherType) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = cube(comm);
  std::vector<std::int64_t> particles;
  for (const auto id : mesh.cell_global) particles.push_back(10 + id);
  mesh.cell_fields.push_back({"particles", "", 1, mesh::StorageType::int64, particles});
  mesh.cell_fields.push_back({"cost", "s", 1, mesh::StorageType::float64, std::vector<double>(particles.size(), 0.25)});
  mesh.cell_fields.push_back(
      {"velocity", "m/s", 3, mesh::StorageType::float64, std::vector<double>(3 * particles.size(), 1.0)});

  EXPECT_EQ(balance::weights_from_field(comm, mesh, "particles"), particles);
  const auto cost = balance::weights_from_field(comm, mesh, "cost");
  for (const auto w : cost) EXPECT_EQ(w, cost[0]);
  EXPECT_THAT(trouble([&] { balance::weights_from_field(comm, mesh, "load"); }),
              HasSubstr("expected a cell field 'load', found none"));
  EXPECT_THAT(trouble([&] { balance::weights_from_field(comm, mesh, "velocity"); }), HasSubstr("of one component"));
}

}  // namespace weights_test
}  // namespace pamr
