// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/mesh_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "support/meshes.hpp"

namespace pamr::check {
namespace mesh_view_test {

/// The Kuhn cube with its cells scattered over the ranks, and a field on cells and one on nodes.
mesh::DistMesh scattered_cube(const par::Comm& comm, int n) {
  auto block = assemble::kuhn_cube(comm, n);
  std::vector<Rank> destination;
  for (std::size_t i = 0; i < block.cell_to_node.size(); ++i) {
    const auto id = static_cast<std::uint64_t>(block.first_cell) + i;
    destination.push_back(static_cast<Rank>(mix(id) % static_cast<std::uint64_t>(comm.size())));
  }
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  mesh::CellField number{.name = "number", .unit = "", .storage = mesh::StorageType::int64, .value = mesh.cell_global};
  mesh::NodeField place{.name = "place", .unit = "m", .n_components = 3, .value = std::vector<double>{}};
  for (const auto& p : mesh.node_position) place.real().insert(place.real().end(), {p.x, p.y, p.z});
  mesh.cell_fields.push_back(std::move(number));
  mesh.node_fields.push_back(std::move(place));
  return mesh;
}

const ViewColumn& column(const std::vector<ViewColumn>& columns, const std::string& name) {
  return *std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.name == name; });
}

TEST(MeshView, ShowsTheWholeOfASmallMesh) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = scattered_cube(comm, 4);

  const auto view = view_mesh(comm, mesh, 1e-12);

  EXPECT_TRUE(view.has_all_cells);
  EXPECT_FALSE(view.nodes_are_merged);
  EXPECT_EQ(view.worst.size(), 20U);
  EXPECT_TRUE(view.off_surface.empty());
  if (!comm.is_first()) return;
  ASSERT_EQ(view.cells.number.size(), 384U);
  ASSERT_EQ(view.faces.cell.size(), 6U * 32U);
  ASSERT_EQ(view.nodes.number.size(), 125U);
  for (std::size_t c = 0; c < view.cells.number.size(); ++c) {
    EXPECT_EQ(view.cells.number[c], static_cast<GlobalId>(c));
    EXPECT_EQ(column(view.cells.columns, "number").value[c], static_cast<double>(c));
  }
  for (std::size_t n = 0; n < view.nodes.number.size(); ++n) {
    EXPECT_EQ(view.nodes.number[n], static_cast<GlobalId>(n));
    EXPECT_EQ(column(view.nodes.columns, "|place|").value[n], norm(view.nodes.position[n]));
  }
  for (std::size_t f = 0; f < view.faces.cell.size(); ++f) {
    EXPECT_EQ(column(view.faces.columns, "number").value[f], static_cast<double>(view.faces.cell[f]));
    const auto& name = view.patches[at(view.faces.patch[f])].name;  // xmin ... zmax
    for (const auto node : view.faces.node[f]) {
      const auto p = view.nodes.position[at(node)];
      EXPECT_EQ(name[0] == 'x' ? p.x : name[0] == 'y' ? p.y : p.z, name.substr(1) == "min" ? 0 : 1) << name;
    }
  }
}

TEST(MeshView, IsTheSameOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const ViewLimits limits{.faces = 150, .all_cells = 100, .cut_cells = 300, .worst_cells = 3, .off_surface_nodes = 4};

  const auto view = view_mesh(comm, scattered_cube(comm, 5), 1e-12, limits);

  if (!comm.is_first()) return;
  const auto twin = view_mesh(alone, scattered_cube(alone, 5), 1e-12, limits);
  EXPECT_EQ(view.nodes.number, twin.nodes.number);
  EXPECT_EQ(view.nodes.position, twin.nodes.position);
  EXPECT_EQ(view.cells.number, twin.cells.number);
  EXPECT_EQ(view.cells.node, twin.cells.node);
  EXPECT_EQ(view.faces.cell, twin.faces.cell);
  EXPECT_EQ(view.faces.node, twin.faces.node);
  EXPECT_EQ(view.faces.patch, twin.faces.patch);
  ASSERT_EQ(view.faces.columns.size(), twin.faces.columns.size());
  for (std::size_t i = 0; i < view.faces.columns.size(); ++i)
    EXPECT_EQ(view.faces.columns[i].value, twin.faces.columns[i].value) << view.faces.columns[i].name;
  for (std::size_t i = 0; i < view.worst.size(); ++i) EXPECT_EQ(view.worst[i].cell, twin.worst[i].cell);
}

TEST(MeshView, OfALargeMeshIsReducedToItsLimits) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = scattered_cube(comm, 8);

  const auto view = view_mesh(comm, mesh, 1e-12, {.faces = 400, .all_cells = 1000, .worst_cells = 2});

  EXPECT_FALSE(view.has_all_cells);
  EXPECT_EQ(view.window, 1);
  EXPECT_TRUE(view.nodes_are_merged);
  if (!comm.is_first()) return;
  EXPECT_LE(view.faces.cell.size(), 400U);
  EXPECT_GE(view.faces.cell.size(), 100U);
  for (const auto& [a, b, c] : view.faces.node) EXPECT_TRUE(a != b && b != c && c != a);
  std::set<GlobalId> shown(view.cells.number.begin(), view.cells.number.end());
  for (const auto& worst : view.worst) EXPECT_TRUE(shown.contains(worst.cell));
  // The planes x, y, z = 1/2 run along faces: cells on both of their sides touch them.
  EXPECT_GE(shown.size(), 3U * 2 * 64 * 6 - 3 * 4 * 8 * 6);
  EXPECT_LT(shown.size(), 3072U);
}

TEST(MeshView, CoversTheMiddleWhereTheSectionsAreTooLarge) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = scattered_cube(comm, 8);

  const auto view = view_mesh(comm, mesh, 1e-12, {.all_cells = 1000, .cut_cells = 700, .worst_cells = 1});

  EXPECT_LT(view.window, 1);
  if (!comm.is_first()) return;
  EXPECT_LE(view.cells.number.size(), 700U);
  EXPECT_GE(view.cells.number.size(), 24U);
}

TEST(MeshView, ListsTheNodesOffTheirSurface) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::kuhn_cube(comm, 2);
  block.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"slope\"\nkind = \"plane\"\npoint = [0, 0, 0]\nnormal = [1, 0, 0.25]\n");
  const auto& first = block.info.patches.front();
  ASSERT_EQ(first.name, "xmin");
  block.info.patches.front().surface = 0;

  const auto view = view_mesh(comm, assemble::assemble(comm, std::move(block)), 1e-12, {.off_surface_nodes = 4});

  // z = 0 is on the plane; the three nodes at z = 1 are farthest off, then one at z = 1/2.
  const double distance = 0.25 / std::sqrt(1 + 0.0625);
  ASSERT_EQ(view.off_surface.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(view.off_surface[i].distance, i < 3 ? distance : distance / 2, 1e-15);
    EXPECT_EQ(view.off_surface[i].position.z, i < 3 ? 1 : 0.5);
    EXPECT_EQ(view.off_surface[i].patch, 0);
    if (i == 1 || i == 2) {
      EXPECT_LT(view.off_surface[i - 1].node, view.off_surface[i].node);
    }
  }
}

}  // namespace mesh_view_test
}  // namespace pamr::check
