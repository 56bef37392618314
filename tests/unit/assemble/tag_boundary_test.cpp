// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/tag_boundary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"

namespace pamr::assemble {
namespace tag_boundary_test {

using testing::HasSubstr;
using Triangle = std::array<GlobalId, 3>;

/// The boundary of a mesh as a solver might hold it: every face on a rank drawn for it, some on two, corners and order
/// mixed. Neighbors are taken away.
mesh::BlockMesh with_triangles(const par::Comm& comm, mesh::BlockMesh block, std::uint64_t seed) {
  const auto whole = test::gather(comm, block);
  test::Dice dice(seed);
  std::vector<std::pair<Triangle, int>> here;
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto neighbor = whole.cell_to_cell[c][f];
      if (neighbor >= 0) continue;
      std::vector<GlobalId> corner;
      for (const auto i : mesh::tet::face_to_corner[f]) corner.push_back(whole.cell_to_node[c][std::size_t(i)]);
      dice.shuffle(corner);
      const std::pair<Triangle, int> tagged{{corner[0], corner[1], corner[2]}, static_cast<int>(-neighbor - 1)};
      for (auto copies = 1 + dice.below(2); copies > 0; --copies)
        if (static_cast<Rank>(dice.below(std::size_t(comm.size()))) == comm.rank()) here.push_back(tagged);
    }
  dice.shuffle(here);
  block.cell_to_cell.clear();
  for (const auto& [nodes, patch] : here) {
    block.boundary.node.push_back(nodes);
    block.boundary.patch.push_back(patch);
  }
  return block;
}

/// Faces of each patch over all ranks.
std::vector<std::int64_t> faces_of_patches(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<std::int64_t> n(mesh.info.patches.size(), 0);
  for (const auto& neighbors : mesh.cell_to_cell)
    for (const auto slot : neighbors)
      if (slot < 0) ++n[std::size_t(mesh::slot_to_patch(slot))];
  comm.sum_in_place(n);
  return n;
}

/// The message, the same on every rank.
std::string error_of(const par::Comm& comm, const mesh::BlockMesh& block) {
  std::string error = "no error";
  try {
    (void)assemble(comm, block);
  } catch (const Error& thrown) {
    error = thrown.what();
  }
  EXPECT_EQ(error, comm.broadcast(error));
  return error;
}

/// A Kuhn cube of 6 cells without neighbors, whose triangles are all on the last rank.
mesh::BlockMesh cube_with(const par::Comm& comm, const std::vector<std::pair<Triangle, int>>& triangles) {
  auto block = test::kuhn_cube(comm, 1);
  block.cell_to_cell.clear();
  if (comm.rank() == comm.size() - 1)
    for (const auto& [nodes, patch] : triangles) {
      block.boundary.node.push_back(nodes);
      block.boundary.patch.push_back(patch);
    }
  return block;
}

TEST(TagBoundary, GivesThePatchesOfTrianglesInAnyOrderOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto block = test::random_mesh(comm, seed, 3);
    const auto expected = test::gather(comm, assemble(comm, block));

    const auto mesh = assemble(comm, with_triangles(comm, block, seed));

    EXPECT_EQ(mesh.info.patches, expected.info.patches);
    EXPECT_EQ(test::gather(comm, mesh).cell_to_cell, expected.cell_to_cell);
  }
}

TEST(TagBoundary, IsCarriedAlongTheCurveAndWithOtherFirstNumbers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 7, 3);
  const auto expected = mesh::fingerprint(comm, assemble(comm, block));
  auto numbered = test::numbered_from(1000, with_triangles(comm, block, 7));
  for (auto& corners : numbered.boundary.node)
    for (auto& node : corners) node += 1000;

  const auto ordered = order::order_along_curve(comm, numbered);

  EXPECT_EQ(mesh::fingerprint(comm, assemble(comm, ordered.block)), expected);
}

TEST(TagBoundary, PutsFacesWithoutTriangleIntoAPatchOfTheirOwn) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = cube_with(comm, {{{0, 3, 1}, 4}, {{2, 0, 3}, 4}});

  const auto added = assemble(comm, block);
  auto named = block;
  named.info.patches[4].name = "boundary";
  const auto beside = assemble(comm, named);
  named.info.patches[2].kind = mesh::untagged_kind;
  const auto found = assemble(comm, named);

  ASSERT_EQ(added.info.patches.size(), 7U);
  EXPECT_EQ(added.info.patches[6], mesh::untagged_patch({}));
  EXPECT_THAT(faces_of_patches(comm, added), testing::ElementsAre(0, 0, 0, 0, 2, 0, 10));
  ASSERT_EQ(beside.info.patches.size(), 7U);
  EXPECT_EQ(beside.info.patches[6], mesh::untagged_patch(named.info.patches));
  EXPECT_EQ(faces_of_patches(comm, beside), faces_of_patches(comm, added));
  EXPECT_THAT(faces_of_patches(comm, found), testing::ElementsAre(0, 0, 10, 0, 2, 0));
}

TEST(TagBoundary, AcceptsTrianglesBesideNeighborsThatAgree) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::random_mesh(comm, 3, 2);
  const auto expected = test::gather(comm, assemble(comm, block)).cell_to_cell;
  block.boundary = with_triangles(comm, block, 3).boundary;

  EXPECT_EQ(test::gather(comm, assemble(comm, block)).cell_to_cell, expected);

  if (comm.is_first() && !block.boundary.patch.empty()) block.boundary.patch[0] = (block.boundary.patch[0] + 1) % 6;
  EXPECT_THAT(error_of(comm, block), HasSubstr("expected one patch for each face, found '"));
}

TEST(TagBoundary, GivesFacesInsideTheirPatchesOnBothSides) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble(comm, cube_with(comm, {{{0, 3, 1}, 4}, {{0, 1, 7}, 2}, {{7, 0, 1}, 2}}));

  const mesh::InnerPatches patches(mesh);
  std::int64_t n_sides = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      if (patches.of({c, slot}) < 0) continue;
      ++n_sides;
      EXPECT_EQ(patches.of({c, slot}), 2);
      EXPECT_EQ(mesh::face_key(mesh, {c, slot}), (par::SharedKey{0, 1, 7}));
    }
  EXPECT_EQ(comm.sum(n_sides), 2);
  EXPECT_THAT(mesh::count_inner_faces(comm, mesh), testing::ElementsAre(0, 0, 1, 0, 0, 0, 0));
}

TEST(TagBoundary, SaysWhichTriangleIsWrongOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto last = std::to_string(comm.size() - 1);
  const std::pair<Triangle, int> good{{0, 3, 1}, 4};

  EXPECT_EQ(error_of(comm, cube_with(comm, {good, {{1, 2, 4}, 2}})),
            "triangle 1 of rank " + last + ", nodes 1 2 4: expected a face of a cell, found no cell with these nodes");
  EXPECT_EQ(
      error_of(comm, cube_with(comm, {good, good, {{1, 0, 3}, 5}})),
      "triangle 2 of rank " + last + ", nodes 1 0 3: expected one patch for each face, found 'zmax' beside 'zmin'");
  EXPECT_EQ(error_of(comm, cube_with(comm, {good, {{0, 1, 7}, 2}, {{1, 7, 0}, 5}})),
            "triangles: expected one patch for each face, found 1 faces inside in 'ymin' and in 'zmax'");
  EXPECT_THAT(error_of(comm, cube_with(comm, {good, {{1, 8, 3}, 5}})),
              HasSubstr("boundary triangle 1 of rank " + last + ": expected node numbers from 0 to 7, found 8"));
  EXPECT_THAT(error_of(comm, cube_with(comm, {good, {{1, 3, 3}, 5}})), HasSubstr("three different nodes, found 1 3 3"));
  EXPECT_THAT(error_of(comm, cube_with(comm, {good, {{0, 3, 1}, 6}})), HasSubstr("expected one of 6 patches"));
  EXPECT_THAT(error_of(comm, cube_with(comm, {good, {{0, 3, 1}, -1}})), HasSubstr("from 0 on, found -1"));
  auto block = cube_with(comm, {good});
  if (comm.is_first()) block.boundary.patch.push_back(0);
  EXPECT_THAT(error_of(comm, block), HasSubstr("patches of the boundary triangles: expected"));
}

}  // namespace tag_boundary_test
}  // namespace pamr::assemble
