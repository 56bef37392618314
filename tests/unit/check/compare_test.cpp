// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/check/match_nodes.hpp"
#include "support/meshes.hpp"

namespace pamr::check {
namespace compare_test {

using geometry::Vec3;

/// A random mesh with a nodal field, a vector on cells and an integer field, scattered over the ranks.
mesh::BlockMesh blocks_with_fields(const par::Comm& comm, std::uint64_t seed) {
  auto block = test::random_mesh(comm, seed, 3);
  mesh::Field nodal, vector, integer;
  nodal.name = "psi";
  for (const auto p : block.node_position) nodal.real().push_back(p.x + 2 * p.y);
  vector.name = "velocity";
  vector.n_components = 3;
  integer.name = "region";
  integer.storage = mesh::StorageType::int32;
  integer.value = std::vector<std::int64_t>{};
  for (std::size_t i = 0; i < block.cell_to_node.size(); ++i) {
    const auto id = block.first_cell + static_cast<GlobalId>(i);
    for (int k = 0; k < 3; ++k) vector.real().push_back(static_cast<double>(id) + 0.1 * k);
    integer.integer().push_back(id % 4);
  }
  block.node_fields = {nodal};
  block.cell_fields = {vector, integer};
  return block;
}

mesh::DistMesh scattered(const par::Comm& comm, mesh::BlockMesh block, std::uint64_t seed) {
  const auto destination = test::random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destination);
}

TEST(CompareMeshes, FindsAMeshEqualToItself) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto block = blocks_with_fields(comm, 1);

  const auto comparison = compare_meshes(comm, scattered(comm, block, 2), scattered(comm, block, 3), 0);

  EXPECT_TRUE(comparison.differences.empty());
  EXPECT_EQ(comparison.fields.size(), 3U);
}

TEST(CompareMeshes, DoesNotCareAboutNumbersNorTheOrderOfCorners) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto block = blocks_with_fields(comm, 4);
  const auto other = test::permute(comm, block, 5);

  const auto comparison = compare_meshes(comm, scattered(comm, block, 6), scattered(comm, other, 7), 0);

  for (const auto& difference : comparison.differences) ADD_FAILURE() << difference.text;
}

TEST(CompareMeshes, SeesOneMovedNodeAndTheCellsThatHoldIt) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto block = blocks_with_fields(comm, 8);
  auto other = block;
  for (auto& p : other.node_position)
    if (p == Vec3{0, 0, 0}) p.x = -1e-9;
  const auto a = scattered(comm, block, 9), b = scattered(comm, other, 10);

  const auto exact = compare_meshes(comm, a, b, 0);
  const auto tolerant = compare_meshes(comm, a, b, 1e-8);
  const auto too_tight = compare_meshes(comm, a, b, 1e-10);

  ASSERT_GE(exact.differences.size(), 3U);
  EXPECT_EQ(exact.differences[0].what, "nodes");
  EXPECT_EQ(exact.differences[0].count, 1);
  EXPECT_EQ(exact.differences[2].what, "cells");
  EXPECT_GT(exact.differences[2].count, 0);
  EXPECT_EQ(too_tight.differences.size(), exact.differences.size());
  for (const auto& difference : tolerant.differences) ADD_FAILURE() << difference.text;
}

TEST(CompareMeshes, MatchesShakenNodesWithinTheTolerance) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto block = blocks_with_fields(comm, 11);
  auto other = test::permute(comm, block, 12);
  for (auto& p : other.node_position) {
    const auto shift = [&](std::uint64_t seed) {
      const auto bits = combine(combine(seed, bits_of(p.x)), combine(bits_of(p.y), bits_of(p.z)));
      return 1e-7 * (std::ldexp(static_cast<double>(bits >> 11U), -52) - 1.0);
    };
    p = {p.x + shift(1), p.y + shift(2), p.z + shift(3)};
  }
  const auto a = scattered(comm, block, 13), b = scattered(comm, other, 14);

  EXPECT_TRUE(compare_meshes(comm, a, b, 1e-6).differences.empty());
  EXPECT_FALSE(compare_meshes(comm, a, b, 1e-9).differences.empty());
}

TEST(CompareMeshes, NamesTheFieldAndCountsItsValues) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto a = scattered(comm, blocks_with_fields(comm, 15), 16);
  auto b = a;
  for (std::size_t i = 0; i < b.cell_global.size(); ++i)
    if (b.cell_global[i] == 5 || b.cell_global[i] == 9) b.cell_fields[0].real()[3 * i + 1] += 0.5;

  const auto comparison = compare_meshes(comm, a, b, 1e-9);

  ASSERT_EQ(comparison.differences.size(), 1U);
  EXPECT_EQ(comparison.differences[0].what, "field velocity");
  EXPECT_EQ(comparison.differences[0].count, 2);
  EXPECT_EQ(comparison.differences[0].first, 5);
  EXPECT_DOUBLE_EQ(comparison.differences[0].largest, 0.5);
}

TEST(CompareMeshes, SeesNodalAndIntegerValuesMissingFieldsAndOtherShapes) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto a = scattered(comm, blocks_with_fields(comm, 17), 18);
  auto nodal = a, integer = a, missing = a, shape = a, not_a_number = a;
  for (std::size_t i = 0; i < a.node_global.size(); ++i)
    if (a.node_global[i] == 3) nodal.node_fields[0].real()[i] += 1;
  for (std::size_t i = 0; i < a.cell_global.size(); ++i)
    if (a.cell_global[i] == 3) integer.cell_fields[1].integer()[i] += 1;
  missing.cell_fields.pop_back();
  shape.cell_fields[0].n_components = 1;
  shape.cell_fields[0].real().resize(a.cell_global.size());
  not_a_number.node_fields[0].real().assign(a.node_global.size(), std::numeric_limits<double>::quiet_NaN());

  for (const auto* other : {&nodal, &integer, &missing, &shape}) {
    const auto comparison = compare_meshes(comm, a, *other, 0);
    ASSERT_EQ(comparison.differences.size(), 1U);
    EXPECT_EQ(comparison.differences[0].count, 1) << comparison.differences[0].text;
    EXPECT_EQ(compare_meshes(comm, *other, a, 0).differences.size(), 1U);
  }
  EXPECT_EQ(compare_meshes(comm, a, not_a_number, 1).differences.size(), 1U);
  EXPECT_TRUE(compare_meshes(comm, not_a_number, not_a_number, 0).differences.empty());
}

TEST(CompareMeshes, SeesPatchesByNameAndLineage) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto a = scattered(comm, blocks_with_fields(comm, 19), 20);
  ASSERT_GE(a.info.patches.size(), 2U);
  auto renamed = a, swapped = a, finer = a;
  renamed.info.patches[1].name = "another";
  std::swap(swapped.info.patches[0], swapped.info.patches[1]);
  for (auto& neighbors : swapped.cell_to_cell)
    for (auto& slot : neighbors)
      if (slot == -1 || slot == -2) slot = -3 - slot;
  for (std::size_t i = 0; i < finer.lineage.size(); ++i)
    if (finer.cell_global[i] == 4) finer.lineage[i] = mesh::Lineage(mesh::FamilyKind::regular, 0, 0, 1);

  const auto by_name = compare_meshes(comm, a, renamed, 0);
  ASSERT_EQ(by_name.differences.size(), 1U);
  EXPECT_EQ(by_name.differences[0].what, "patches");
  EXPECT_TRUE(compare_meshes(comm, a, swapped, 0).differences.empty());
  const auto by_level = compare_meshes(comm, a, finer, 0);
  ASSERT_EQ(by_level.differences.size(), 1U);
  EXPECT_EQ(by_level.differences[0].what, "lineage");
  EXPECT_EQ(by_level.differences[0].first, 4);
}

TEST(CompareMeshes, SeesOtherNumbersOfCells) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto a = assemble::assemble(comm, test::kuhn_cube(comm, 2)),
             b = assemble::assemble(comm, test::kuhn_cube(comm, 3));

  const auto comparison = compare_meshes(comm, a, b, 0);

  ASSERT_GE(comparison.differences.size(), 2U);
  EXPECT_EQ(comparison.differences[0].what, "cells");
  EXPECT_EQ(comparison.differences[0].count, 6 * 27 - 6 * 8);
}

TEST(MatchNodes, TakesTheNearestWithinTheToleranceAlsoAcrossBins) {
  par::Comm comm(MPI_COMM_WORLD);
  std::vector<Vec3> reference, nodes;
  std::vector<GlobalId> number(100);
  std::iota(number.begin(), number.end(), GlobalId{0});
  if (comm.is_first())
    for (int i = 0; i < 100; ++i) reference.push_back({0.01 * i, -0.01 * i, 0});
  if (comm.rank() == comm.size() - 1)
    for (int i = 0; i < 100; ++i) nodes.push_back({0.01 * i + 0.004, -0.01 * i, -0.004});

  const auto match = match_nodes(comm, {number, reference}, {number, nodes}, 0.0045);
  const auto nothing = match_nodes(comm, {number, reference}, {number, nodes}, 0.0035);

  for (std::size_t i = 0; i < match.size(); ++i) {
    EXPECT_EQ(match[i], static_cast<GlobalId>(i));
    EXPECT_EQ(nothing[i], unmatched);
  }
}

}  // namespace compare_test
}  // namespace pamr::check
