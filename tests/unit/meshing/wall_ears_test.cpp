// SPDX-License-Identifier: GPL-3.0-or-later
// Balls known by five and six nodes: all edges on the sphere but the one inside.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "meshing/repair/find_wall_ears.hpp"
#include "meshing/repair/open_wall_ears.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr::meshing {
namespace wall_ears_test {

const std::string sphere = "[[surface]]\nname = \"wall\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1.0\n";
const std::string two_cones =
    "[[surface]]\nname = \"wall\"\nkind = \"revolution\"\norigin = [0, 0, 0]\naxis = [0, 0, 1]\nprofile = [\n"
    "  { from = [-1, 0], to = [0, 1] }, { from = [0, 1], to = [1, 0] } ]\n";

mesh::BlockMesh tied(mesh::BlockMesh block, const std::string& surfaces) {
  block.info.surfaces = test::surfaces_of(surfaces);
  block.info.patches = {{"wall", "wall", 0}};
  return block;
}

/// Four cells around the axis between nodes 4 and 5.
mesh::BlockMesh octahedron(const par::Comm& comm) {
  return test::small_mesh(comm, {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                          {{0, 1, 5, 4}, {1, 2, 5, 4}, {2, 3, 5, 4}, {3, 0, 5, 4}});
}

/// Two cells with one face in common.
mesh::BlockMesh double_cell(const par::Comm& comm) {
  return test::small_mesh(comm, {{0.6, 0, 0.8}, {-0.6, 0, 0.8}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                          {{0, 1, 2, 4}, {1, 3, 2, 4}});
}

double volume(const par::Comm& comm, const mesh::DistMesh& mesh) {
  double sum = 0;
  const auto whole = test::gather(comm, mesh);
  const auto p = [&](GlobalId n) { return whole.node_position[static_cast<std::size_t>(n)]; };
  for (const auto& n : whole.cell_to_node) sum += geometry::volume({p(n[0]), p(n[1]), p(n[2]), p(n[3])});
  return sum;
}

double worst_mean_ratio(const par::Comm& comm, const mesh::DistMesh& mesh) {
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
  return comm.min(worst);
}

TEST(WallEars, TheEdgeThatFourEarsShareIsSplitAndTheyAreGone) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = tied(octahedron(comm), sphere);
  block.cell_fields = {
      {"region", "", 1, mesh::StorageType::int32, std::vector<std::int64_t>(block.cell_to_node.size(), 7)}};
  auto mesh = assemble::assemble(comm, std::move(block));

  const auto ears = find_wall_ears(comm, mesh);
  const auto opened = open_wall_ears(comm, std::move(mesh), ears);

  EXPECT_EQ(ears.count(), 4);
  ASSERT_EQ(ears.edge.size(), 1U);
  EXPECT_EQ(ears.edge[0], (std::array<GlobalId, 2>{4, 5}));
  EXPECT_TRUE(ears.face.empty());
  EXPECT_EQ(opened.info.n_global_cells, 8);
  EXPECT_EQ(opened.info.n_global_nodes, 7);
  EXPECT_TRUE(validate::validate(comm, opened).empty());
  EXPECT_NEAR(volume(comm, opened), 4.0 / 3, 1e-15);
  EXPECT_EQ(find_wall_ears(comm, opened).count(), 0);
  EXPECT_EQ(opened.find_cell_field("region")->integer(),
            std::vector<std::int64_t>(static_cast<std::size_t>(opened.n_cells()), 7));
}

/// The octahedron with a cell on each of its faces, which are a patch inside, on a sphere.
mesh::DistMesh octahedron_inside(const par::Comm& comm) {
  std::vector<geometry::Vec3> point{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<GlobalId, 4>> cell{{0, 1, 5, 4}, {1, 2, 5, 4}, {2, 3, 5, 4}, {3, 0, 5, 4}};
  for (const GlobalId pole : {4, 5})
    for (GlobalId k = 0; k < 4; ++k) {
      const GlobalId next = (k + 1) % 4, top = std::ssize(point);
      point.push_back(point[at(k)] + point[at(next)] + point[at(pole)]);
      cell.push_back({pole == 4 ? k : next, pole == 4 ? next : k, pole, top});
    }
  auto block = test::small_mesh(comm, point, cell);
  block.info.surfaces = test::surfaces_of(sphere);
  block.info.patches = {{"wall", "patch", -1}, {"ball", "patch", 0}};
  auto mesh = assemble::assemble(comm, std::move(block));
  auto& word = mesh::make_inner_patches(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      int n_poles = 0, n_on_sphere = 0;
      for (const auto corner : mesh::tet::face_to_corner[at(slot)]) {
        const auto p = mesh.points(c)[at(corner)];
        n_on_sphere += norm(p) == 1 ? 1 : 0;
        n_poles += std::abs(p.z) == 1 && p.x == 0 ? 1 : 0;
      }
      if (n_on_sphere == 3 && n_poles == 1) word[at(c)] = mesh::with_inner_patch(word[at(c)], slot, 1);
    }
  return mesh;
}

TEST(WallEars, ACurvedPatchInsideHasThemToo) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = octahedron_inside(comm);
  ASSERT_TRUE(validate::validate(comm, mesh).empty());

  const auto ears = find_wall_ears(comm, mesh);
  const auto opened = open_wall_ears(comm, std::move(mesh), ears);

  EXPECT_EQ(ears.n_inside, 4);
  EXPECT_EQ(ears.n_at_rims, 0);
  EXPECT_EQ(ears.edge, (std::vector<std::array<GlobalId, 2>>{{4, 5}}));
  EXPECT_EQ(opened.info.n_global_cells, 16);
  EXPECT_TRUE(validate::validate(comm, opened).empty());
  EXPECT_EQ(find_wall_ears(comm, opened).count(), 0);
  EXPECT_EQ(mesh::count_inner_faces(comm, opened), (std::vector<std::int64_t>{0, 8}));
}

TEST(WallEars, AFaceWithAllItsEdgesOnTheWallIsSplitItself) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, tied(double_cell(comm), sphere));
  const double before = volume(comm, mesh);

  const auto ears = find_wall_ears(comm, mesh);
  const auto opened = open_wall_ears(comm, std::move(mesh), ears);

  EXPECT_EQ(ears.count(), 1);
  EXPECT_TRUE(ears.edge.empty());
  ASSERT_EQ(ears.face.size(), 1U);
  EXPECT_EQ(ears.face[0], (std::array<GlobalId, 3>{1, 2, 4}));
  EXPECT_EQ(opened.info.n_global_cells, 6);
  EXPECT_TRUE(validate::validate(comm, opened).empty());
  EXPECT_NEAR(volume(comm, opened), before, 1e-15);
  EXPECT_EQ(find_wall_ears(comm, opened).count(), 0);
}

/// A cube of six cells with its upright edges on a cylinder.
mesh::BlockMesh square_prism(const par::Comm& comm, const std::string& kind_of_lids) {
  auto block = test::without_neighbors(test::kuhn_cube(comm, 1));
  block.info.surfaces = test::surfaces_of(
      "[[surface]]\nname = \"wall\"\nkind = \"cylinder\"\npoint = [0.5, 0.5, 0]\naxis = [0, 0, 1]\n"
      "radius = 0.7071067811865476\n");
  block.info.patches = {{"side", "wall", 0}, {"lid", kind_of_lids, -1}};
  return block;
}

mesh::DistMesh with_lids(const par::Comm& comm, const std::string& kind_of_lids) {
  auto mesh = assemble::assemble(comm, square_prism(comm, kind_of_lids));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      auto& next = mesh.cell_to_cell[static_cast<std::size_t>(c)][k];
      if (next >= 0) continue;
      const auto p = mesh.points(c);
      bool is_flat = true;
      for (std::size_t i = 1; i < 4; ++i) is_flat = is_flat && p[(k + i) % 4].z == p[(k + 1) % 4].z;
      next = mesh::patch_to_slot(is_flat ? 1 : 0);
    }
  return mesh;
}

TEST(WallEars, AChordOfARoundLidIsSplitUnlessItsSideIsPeriodic) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = with_lids(comm, "");
  const double before = volume(comm, mesh);

  const auto ears = find_wall_ears(comm, mesh);
  const auto opened = open_wall_ears(comm, std::move(mesh), ears);

  EXPECT_EQ(ears.n_at_rims, 4) << "two on each of two lids";
  EXPECT_EQ(ears.n_left, 0);
  EXPECT_TRUE(validate::validate(comm, opened).empty());
  EXPECT_NEAR(volume(comm, opened), before, 1e-15);
  EXPECT_EQ(find_wall_ears(comm, opened).count(), 0);
  const auto kept = find_wall_ears(comm, with_lids(comm, "periodic"));
  EXPECT_EQ(kept.n_at_rims, 4);
  EXPECT_EQ(kept.n_left, 4);
}

TEST(WallEars, FlatWallsSharpEdgesAndPatchesWithoutSurfaceHaveNone) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto loose = octahedron(comm);

  EXPECT_EQ(find_wall_ears(comm, assemble::assemble(comm, tied(octahedron(comm), two_cones))).count(), 0);
  EXPECT_EQ(find_wall_ears(comm, assemble::assemble(comm, std::move(loose))).count(), 0);
  EXPECT_EQ(find_wall_ears(comm, assemble::assemble(comm, test::kuhn_cube(comm, 2))).count(), 0);
}

TEST(WallEars, TheRepairedMeshIsTheSameOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto repaired = [](const par::Comm& on) {
    auto mesh = assemble::assemble(on, tied(test::without_neighbors(test::kuhn_cube(on, 1)),
                                            "[[surface]]\nname = \"wall\"\nkind = \"sphere\"\n"
                                            "center = [0.5, 0.5, 0.5]\nradius = 0.8660254037844386\n"));
    const auto ears = find_wall_ears(on, mesh);
    return open_wall_ears(on, std::move(mesh), ears);
  };

  const auto here = repaired(comm);
  const auto alone = test::gather(self, repaired(self)), together = test::gather(comm, here);

  EXPECT_GT(alone.cell_to_node.size(), 6U);
  EXPECT_EQ(together.cell_to_node, alone.cell_to_node);
  EXPECT_EQ(together.cell_to_cell, alone.cell_to_cell);
  EXPECT_EQ(together.node_position, alone.node_position);
  EXPECT_TRUE(validate::validate(comm, here).empty());
  EXPECT_EQ(find_wall_ears(comm, here).count(), 0);
  EXPECT_GT(worst_mean_ratio(comm, here), 0.2);
}

}  // namespace wall_ears_test
}  // namespace pamr::meshing
