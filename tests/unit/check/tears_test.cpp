// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/tears.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "meshing/repair/weld.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace {

using geometry::Vec3;

/// Nodes and cells, whole on every rank.
struct Parts {
  std::vector<Vec3> node;
  std::vector<std::array<GlobalId, 4>> cell;
};

/// A cube of n^3 Kuhn cubes with its lowest corner there and that side.
Parts cube(int n, Vec3 corner = {}, double side = 1) {
  const par::Comm self(MPI_COMM_SELF);
  const auto whole = test::kuhn_cube(self, n);
  Parts parts{{}, whole.cell_to_node};
  for (const auto p : whole.node_position) parts.node.push_back(corner + side * p);
  return parts;
}

Parts both(Parts a, const Parts& b) {
  const auto n = static_cast<GlobalId>(a.node.size());
  a.node.insert(a.node.end(), b.node.begin(), b.node.end());
  for (const auto& cell : b.cell) a.cell.push_back({cell[0] + n, cell[1] + n, cell[2] + n, cell[3] + n});
  return a;
}

mesh::DistMesh mesh_of(const par::Comm& comm, const Parts& parts, std::uint64_t seed = 1) {
  auto block = test::small_mesh(comm, parts.node, parts.cell);
  const auto destinations = test::random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destinations);
}

check::Tears tears_of(const Parts& parts) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto mesh = mesh_of(comm, parts);
  EXPECT_TRUE(validate::validate(comm, mesh).empty());
  const auto tears = check::find_tears(comm, mesh);
  EXPECT_EQ(tears, check::find_tears(self, mesh_of(self, parts))) << "on one rank";
  return tears;
}

double volume(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto whole = test::gather(comm, mesh);
  double sum = 0;
  for (const auto& c : whole.cell_to_node)
    sum += geometry::volume({whole.node_position[at(c[0])], whole.node_position[at(c[1])],
                             whole.node_position[at(c[2])], whole.node_position[at(c[3])]});
  return sum;
}

TEST(Tears, AWholeMeshHasNone) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const auto block = test::random_mesh(comm, seed, 4);
    const auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, seed));
    const auto tears = check::find_tears(comm, mesh);
    EXPECT_TRUE(tears.is_whole());
    EXPECT_EQ(tears, check::Tears{});
    EXPECT_TRUE(check::remarks_of(tears).empty());
    const auto welded = meshing::weld(comm, mesh);
    EXPECT_EQ(welded.info.n_global_nodes, mesh.info.n_global_nodes);
    EXPECT_EQ(test::gather(comm, welded).cell_to_cell, test::gather(comm, mesh).cell_to_cell);
  }
}

TEST(Tears, CubesThatTouchWithoutCommonNodesAreTwoPiecesUntilTheyAreWelded) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const double gap : {0.0, 1e-13, -1e-13}) {
    const auto parts = both(cube(3), cube(3, {1 + gap, 0, 0}));
    const auto tears = tears_of(parts);
    EXPECT_EQ(tears.n_pieces, 2);
    EXPECT_EQ(tears.coincident_nodes.count, 16);
    EXPECT_EQ(tears.coincident_faces.count, 2 * 18);
    EXPECT_EQ(tears.overlaps.count, 0);
    EXPECT_NEAR(tears.coincident_faces.where.x, 1, 1e-12);
    EXPECT_EQ(check::remarks_of(tears).size(), 2U);

    const auto welded = meshing::weld(comm, mesh_of(comm, parts));
    EXPECT_TRUE(validate::validate(comm, welded).empty());
    EXPECT_TRUE(check::find_tears(comm, welded).is_whole());
    EXPECT_EQ(welded.info.n_global_nodes, 2 * 64 - 16);
    EXPECT_NEAR(volume(comm, welded), 2, 1e-12);
  }
}

TEST(Tears, CellsWithNodesOfTheirOwnAreAllPieces) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = cube(2);
  Parts torn;
  for (const auto& cell : whole.cell) {
    const auto n = static_cast<GlobalId>(torn.node.size());
    for (const auto node : cell) torn.node.push_back(whole.node[at(node)]);
    torn.cell.push_back({n, n + 1, n + 2, n + 3});
  }
  const auto tears = tears_of(torn);
  EXPECT_EQ(tears.n_pieces, 48);
  EXPECT_EQ(tears.coincident_nodes.count, 4 * 48 - 27);
  EXPECT_EQ(tears.coincident_faces.count, 4 * 48 - 48);
  EXPECT_EQ(tears.overlaps.count, 0);

  const auto welded = meshing::weld(comm, mesh_of(comm, torn));
  EXPECT_TRUE(check::find_tears(comm, welded).is_whole());
  EXPECT_EQ(welded.info.n_global_nodes, 27);
  EXPECT_NEAR(volume(comm, welded), 1, 1e-14);
}

TEST(Tears, CubesThatOverlapAreFoundWhereverTheyDo) {
  for (const auto corner : {Vec3{0.5, 0, 0}, Vec3{0.37, 0.21, 0.13}, Vec3{0, 0, 0}, Vec3{-0.3, 0.2, -0.6}})
    EXPECT_GT(tears_of(both(cube(4), cube(4, corner))).overlaps.count, 0) << corner.x;
  // either of them first, and one so small that it lies within a cell of the other
  for (const bool is_first : {false, true}) {
    const auto small = cube(1, {0.71, 0.31, 0.62}, 1e-3), large = cube(2);
    const auto tears = tears_of(is_first ? both(small, large) : both(large, small));
    EXPECT_EQ(tears.n_pieces, 2);
    EXPECT_EQ(tears.overlaps.count, 12);
    EXPECT_EQ(tears.coincident_nodes.count, 0);
  }
}

TEST(Tears, BodiesApartAreJustPieces) {
  const auto tears = tears_of(both(cube(2), cube(3, {1.001, 0, 0})));
  EXPECT_EQ(tears.n_pieces, 2);
  EXPECT_EQ(tears.coincident_nodes.count + tears.coincident_faces.count + tears.overlaps.count, 0);
  EXPECT_EQ(check::remarks_of(tears).size(), 1U);
}

TEST(Tears, CubesThatTouchInOneNodeOrEdgeShareNoFace) {
  const auto at_edge = tears_of(both(cube(2), cube(2, {1, 1, 0})));
  EXPECT_EQ(at_edge.coincident_nodes.count, 3);
  EXPECT_EQ(at_edge.coincident_faces.count, 0);
  EXPECT_EQ(at_edge.n_pieces, 2);
  EXPECT_EQ(at_edge.overlaps.count, 0);
}

}  // namespace
}  // namespace pamr
