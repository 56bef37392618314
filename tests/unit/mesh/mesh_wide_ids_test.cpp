// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that do not fit 32 bits in a mesh at rest: ranges, invariants, limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/local_size.hpp"
#include "pamr/validate/validate.hpp"
#include "support/error_of.hpp"
#include "support/meshes.hpp"

namespace pamr::mesh {
namespace mesh_wide_ids_test {

using test::error_of;

constexpr GlobalId wide = GlobalId{1} << 33U;

TEST(WideNumbers, AreThoseOfTheMeshAndNoOthers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto good = test::numbered_from(wide, test::random_mesh(comm, 3, 2));
  const auto error_with = [&](const std::function<void(BlockMesh&)>& spoil) {
    auto bad = good;
    if (comm.rank() == comm.size() - 1) spoil(bad);
    return error_of([&] { assemble::assemble(comm, bad); });
  };

  EXPECT_EQ(error_with([](BlockMesh&) {}), "no error");
  EXPECT_THAT(error_with([](BlockMesh& b) { b.cell_to_node.back()[1] -= wide; }),
              testing::HasSubstr("expected node numbers from 8589934592 to 8589934618"));
  EXPECT_THAT(error_with([](BlockMesh& b) { b.cell_to_node.back()[1] = wide + b.info.n_global_nodes; }),
              testing::HasSubstr("expected node numbers from 8589934592 to 8589934618, found 8589934619"));
  EXPECT_THAT(error_with([](BlockMesh& b) {
                b.cell_to_cell.back() = {wide - 1, wide, wide, wide};
              }),
              testing::HasSubstr("expected neighbors from 8589934592 on, found 8589934591"));
  EXPECT_THAT(error_with([](BlockMesh& b) { b.cell_to_cell.back()[2] = wide + 48; }),
              testing::HasSubstr("expected neighbors below 8589934640, found 8589934640"));
  EXPECT_THAT(error_with([](BlockMesh& b) { b.first_cell -= wide; }),
              testing::HasSubstr("to begin at cell " + std::to_string(wide + 48 - 48 / comm.size())));
}

TEST(WideNumbers, MayBeginAnywhereUpToALimitTheSameOnAllRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 3, 2);
  const auto error_from = [&](GlobalId first) {
    return error_of([&] { assemble::assemble(comm, test::numbered_from(first, block)); });
  };

  EXPECT_EQ(error_from(max_first_id), "no error");
  EXPECT_THAT(error_from(max_first_id + 1), testing::HasSubstr("expected a first id from 0 to 9007199254740992"));
  EXPECT_THAT(error_from(-1), testing::HasSubstr("expected a first id"));
  if (comm.size() > 1) {
    EXPECT_THAT(error_from(comm.rank()), testing::HasSubstr("on every rank, found different ones"));
  }
}

TEST(WideNumbers, AreSeenByValidationWhenTheyDoNotFollowTheFirst) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::numbered_from(wide, test::random_mesh(comm, 3, 2)));

  EXPECT_TRUE(validate::validate(comm, mesh).empty());
  mesh.info.first_id = 0;

  const auto violations = validate::validate(comm, mesh);
  ASSERT_FALSE(violations.empty());
  EXPECT_EQ(violations.front().invariant, "ids_in_range");
  EXPECT_GE(violations.front().count, mesh.info.n_global_cells);
}

TEST(WideNumbers, ChangeNeitherTheFingerprintNorThePartOfARank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 11, 3);
  const auto destination = test::random_destinations(comm, block, 2);

  const auto plain = assemble::assemble(comm, block, destination);
  const auto moved = assemble::assemble(comm, test::numbered_from(wide, block), destination);

  EXPECT_EQ(fingerprint(comm, moved), fingerprint(comm, plain));
  EXPECT_EQ(moved.cell_to_node, plain.cell_to_node);
  EXPECT_EQ(moved.cell_to_cell, plain.cell_to_cell);
  EXPECT_EQ(moved.border_face, plain.border_face);
  for (std::size_t c = 0; c < moved.cell_global.size(); ++c)
    EXPECT_EQ(moved.cell_global[c], wide + plain.cell_global[c]);
}

TEST(LocalSize, OfTooManyCellsIsRefusedOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto error_of_last = [&](std::int64_t n) {
    return error_of([&] { require_local_size(comm, comm.rank() == comm.size() - 1 ? n : 1, "refined mesh"); });
  };

  EXPECT_EQ(error_of_last(max_local_cells), "no error");
  for (const std::int64_t n : {max_local_cells + 1, std::int64_t{1} << 31U, std::int64_t{1} << 33U}) {
    EXPECT_THAT(error_of_last(n), testing::HasSubstr("refined mesh: expected at most 429496729 cells on a rank"));
    EXPECT_THAT(error_of_last(n), testing::HasSubstr("found " + std::to_string(n) + ": use more than"));
  }
  EXPECT_LE(5 * max_local_cells, std::int64_t{std::numeric_limits<LocalId>::max()});
}

}  // namespace mesh_wide_ids_test
}  // namespace pamr::mesh
