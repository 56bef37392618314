// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/migrate.hpp"

#include <gtest/gtest.h>

#include "pamr/base/error.hpp"
#include "pamr/validate/validate.hpp"
#include "refined_mesh.hpp"

namespace pamr {
namespace migrate_test {

void expect_equal_fields(const std::vector<mesh::Field>& a, const std::vector<mesh::Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].unit, b[i].unit);
    EXPECT_EQ(a[i].n_components, b[i].n_components);
    EXPECT_EQ(a[i].storage, b[i].storage);
    EXPECT_TRUE(a[i].value == b[i].value) << a[i].name;
  }
}

/// Every array, local numbers and order included.
void expect_identical(const mesh::DistMesh& a, const mesh::DistMesh& b) {
  EXPECT_EQ(a.info.n_global_cells, b.info.n_global_cells);
  EXPECT_EQ(a.info.patches, b.info.patches);
  EXPECT_TRUE(a.node_position == b.node_position);
  EXPECT_EQ(a.node_global, b.node_global);
  EXPECT_EQ(a.cell_to_node, b.cell_to_node);
  EXPECT_EQ(a.cell_to_cell, b.cell_to_cell);
  EXPECT_EQ(a.cell_global, b.cell_global);
  EXPECT_TRUE(a.lineage == b.lineage);
  EXPECT_EQ(a.border_rank, b.border_rank);
  EXPECT_EQ(a.border_offset, b.border_offset);
  EXPECT_TRUE(a.border_face == b.border_face);
  EXPECT_EQ(a.ghost_global, b.ghost_global);
  expect_equal_fields(a.cell_fields, b.cell_fields);
  expect_equal_fields(a.node_fields, b.node_fields);
}

TEST(Migrate, GivesTheMeshThatAssemblyGivesForTheSameDestinations) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {1U, 2U, 3U})
    for (const Rank n_used : {comm.size(), std::max(1, comm.size() - 1), 1}) {
      auto mesh = test::refined_mesh(comm, seed);
      const auto whole = test::gather(comm, mesh);
      const auto block = test::cut(comm, whole);

      // from hand to hand twice: the second time from a scattered mesh
      const auto scattered = test::random_ranks(mesh, seed, comm.size());
      mesh = balance::migrate(comm, std::move(mesh), scattered);
      const auto destination = test::random_ranks(mesh, seed + 7, n_used);
      mesh = balance::migrate(comm, std::move(mesh), destination);

      std::vector<Rank> of_block;
      for (std::size_t c = 0; c < block.cell_to_node.size(); ++c) {
        const auto global = static_cast<std::size_t>(block.first_cell) + c;
        const auto lineage = whole.lineage[global];
        const auto first = global - (lineage.is_removable() ? static_cast<std::size_t>(lineage.child()) : 0);
        of_block.push_back(static_cast<Rank>(combine(seed + 7, first) % static_cast<std::uint64_t>(n_used)));
      }
      if (comm.size() > 1) expect_identical(mesh, assemble::assemble(comm, block, of_block));
      for (const auto& violation : validate::validate(comm, mesh))
        ADD_FAILURE() << violation.invariant << " " << violation.count << " at " << violation.where;
    }
}

TEST(Migrate, CarriesAByteWithEachCell) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 5);
  std::vector<std::uint8_t> bytes;
  for (const auto id : mesh.cell_global) bytes.push_back(static_cast<std::uint8_t>(id * 7));

  const auto destination = test::random_ranks(mesh, 3, comm.size());
  mesh = balance::migrate(comm, std::move(mesh), destination, &bytes);

  ASSERT_EQ(bytes.size(), mesh.cell_global.size());
  for (std::size_t c = 0; c < bytes.size(); ++c)
    ASSERT_EQ(bytes[c], static_cast<std::uint8_t>(mesh.cell_global[c] * 7));
}

TEST(Migrate, LeavesAMeshAloneWhenNothingMoves) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = test::refined_mesh(comm, 5);
  const std::vector<Rank> stay(before.cell_global.size(), comm.rank());
  const auto messages = comm.traffic().messages;

  const auto after = balance::migrate(comm, before, stay);

  expect_identical(before, after);
  EXPECT_EQ(comm.traffic().messages, messages);
}

TEST(Migrate, SendsOnlyTheCellsThatMove) {
  const par::Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) return;
  auto mesh = test::refined_mesh(comm, 5);
  auto destination = std::vector<Rank>(mesh.cell_global.size(), comm.rank());
  // one family or cell goes from rank 0 to rank 1
  if (comm.is_first())
    for (LocalId c = 0; c < (mesh.lineage[0].is_removable() ? mesh.lineage[0].family_size() : 1); ++c)
      destination[static_cast<std::size_t>(c)] = 1;
  const auto n_border = static_cast<std::int64_t>(mesh.border_face.size());
  const auto before = comm.traffic().bytes;

  mesh = balance::migrate(comm, std::move(mesh), destination);

  const auto sent = comm.traffic().bytes - before - 4 * n_border;
  EXPECT_EQ(sent > 0, comm.is_first());
  EXPECT_LT(sent, 4096);
  EXPECT_TRUE(validate::validate(comm, mesh).empty());
}

TEST(Migrate, LeavesCellsAndNodesOfARankAloneThatNoCellLeavesOrComesTo) {
  const par::Comm comm(MPI_COMM_WORLD);
  if (comm.size() < 3) return;
  const auto before = test::refined_mesh(comm, 5);
  auto destination = std::vector<Rank>(before.cell_global.size(), comm.rank());
  if (comm.is_first())
    for (LocalId c = 0; c < (before.lineage[0].is_removable() ? before.lineage[0].family_size() : 1); ++c)
      destination[static_cast<std::size_t>(c)] = 1;

  const auto after = balance::migrate(comm, before, destination);

  if (comm.rank() > 1) {
    EXPECT_EQ(after.node_global, before.node_global);
    EXPECT_EQ(after.cell_to_node, before.cell_to_node);
    expect_equal_fields(after.cell_fields, before.cell_fields);
    expect_equal_fields(after.node_fields, before.node_fields);
  }
  EXPECT_TRUE(validate::validate(comm, after).empty());
  const auto refine = [&comm](const mesh::DistMesh& mesh) {
    return test::gather(comm, adapt::refine(comm, mesh, std::vector<std::uint8_t>(mesh.cell_global.size(), 1)).mesh);
  };
  const auto a = refine(before), b = refine(after);
  EXPECT_EQ(a.cell_to_node, b.cell_to_node);
  EXPECT_EQ(a.cell_to_cell, b.cell_to_cell);
}

TEST(Migrate, RefusesBadDestinationsOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 5);
  const auto n = mesh.cell_global.size();
  auto no_rank = std::vector<Rank>(n, comm.rank());
  if (comm.is_first()) no_rank[0] = comm.size();
  auto short_list = std::vector<Rank>(n, comm.rank());
  if (comm.is_first()) short_list.pop_back();
  auto torn = std::vector<Rank>(n, comm.rank());
  for (std::size_t c = 0; c < n; ++c)
    if (mesh.lineage[c].is_removable() && mesh.lineage[c].child() == 1) torn[c] = (comm.rank() + 1) % comm.size();

  EXPECT_THROW(balance::migrate(comm, mesh, no_rank), Error);
  EXPECT_THROW(balance::migrate(comm, mesh, short_list), Error);
  if (comm.size() > 1) {
    EXPECT_THROW(balance::migrate(comm, mesh, torn), Error);
  }
}

}  // namespace migrate_test
}  // namespace pamr
