// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/ghost_values.hpp"

#include <gmock/gmock.h>

#include <cstddef>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/face_geometry.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::mesh {
namespace ghost_values_test {

using geometry::Vec3;

TEST(GhostValues, AreThoseOfTheCellsBehindTheRankBorder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 4));
  std::vector<Vec3> centroid;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) centroid.push_back(geometry::centroid(mesh.points(c)));

  EXPECT_EQ(ghost_values(comm, mesh, mesh.cell_global), mesh.ghost_global);
  const auto behind = ghost_values(comm, mesh, centroid);
  ASSERT_EQ(behind.size(), mesh.border_face.size());
  for (std::size_t k = 0; k < behind.size(); ++k) {  // every cell is on its own side of the face between
    const auto [cell, slot] = mesh.border_face[k];
    const auto p = mesh.points(cell);
    const auto area = area_vector(p, slot), middle = face_centroid(p, slot);
    EXPECT_GT(dot(behind[k] - middle, area), 0);
    EXPECT_LT(dot(centroid[at(cell)] - middle, area), 0);
  }
}

TEST(FaceGeometry, GivesClosedCellsAndTheirVolumes) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 3));
  std::vector<double> volume;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    Vec3 sum;
    double flux = 0;  // of the field x, whose divergence is 3
    for (int f = 0; f < 4; ++f) {
      sum = sum + area_vector(p, f);
      flux += dot(face_centroid(p, f), area_vector(p, f));
      EXPECT_LT(dot(geometry::centroid(p) - face_centroid(p, f), area_vector(p, f)), 0);
      for (const auto corner : face_points(p, f)) EXPECT_NE(corner, p[at(f)]);
    }
    EXPECT_LT(norm(sum), 1e-15);
    EXPECT_NEAR(flux / 3, geometry::volume(p), 1e-15);
    volume.push_back(flux / 3);
  }
  EXPECT_NEAR(par::reproducible_sum(comm, volume), 1, 1e-14);
}

}  // namespace ghost_values_test
}  // namespace pamr::mesh
