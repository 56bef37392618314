// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/kuhn_cube.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/base/error.hpp"
#include "pamr/geometry/orientation.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::assemble {
namespace kuhn_cube_test {

TEST(KuhnCube, FillsTheUnitCubeExactly) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const int n : {1, 2, 4}) {
    const auto whole = test::gather(comm, kuhn_cube(comm, n));

    EXPECT_EQ(whole.cell_to_node.size(), static_cast<std::size_t>(6 * n * n * n));
    EXPECT_DOUBLE_EQ(test::reference_volume(whole), 1.0);
    for (const auto area : test::reference_patch_areas(whole)) EXPECT_DOUBLE_EQ(area, 1.0);
  }
}

TEST(KuhnCube, HasPositiveCellsOnly) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, kuhn_cube(comm, 3));

  for (const auto& n : whole.cell_to_node) {
    const auto at = [&](std::size_t i) { return whole.node_position[static_cast<std::size_t>(n[i])]; };
    EXPECT_TRUE(geometry::is_positive(at(0), at(1), at(2), at(3)));
  }
}

TEST(KuhnCube, GivesTheNeighborsOfTheSerialTwin) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, kuhn_cube(comm, 3));
  auto found = whole.cell_to_cell;
  for (auto& cell : found)
    for (auto& neighbor : cell) neighbor = std::max(neighbor, GlobalId{-1});

  EXPECT_EQ(found, test::reference_neighbors(whole.cell_to_node));
}

TEST(KuhnCube, PutsEachPatchOnItsPlane) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, kuhn_cube(comm, 2));
  const std::array<const char*, 6> name{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(whole.info.patches[p].name, name[p]);
    EXPECT_EQ(whole.info.surface_name(whole.info.patches[p]), name[p]);
    EXPECT_THAT(whole.info.surfaces->toml, testing::HasSubstr("name = \"" + std::string(name[p]) + "\""));
  }
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      if (whole.cell_to_cell[c][f] >= 0) continue;
      const auto patch = static_cast<std::size_t>(-whole.cell_to_cell[c][f] - 1);
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == f) continue;
        const auto p = whole.node_position[static_cast<std::size_t>(whole.cell_to_node[c][i])];
        const std::array<double, 3> x{p.x, p.y, p.z};
        EXPECT_EQ(x[patch / 2], patch % 2 == 0 ? 0.0 : 1.0);
      }
    }
}

TEST(KuhnCube, IsTheSameOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const par::Comm alone(MPI_COMM_SELF);

  const auto whole = test::gather(comm, kuhn_cube(comm, 3));

  const auto serial = kuhn_cube(alone, 3);
  EXPECT_EQ(whole.cell_to_node, serial.cell_to_node);
  EXPECT_EQ(whole.cell_to_cell, serial.cell_to_cell);
  EXPECT_EQ(whole.node_position, serial.node_position);
}

TEST(KuhnCube, RefusesSizesOutOfRange) {
  const par::Comm comm(MPI_COMM_WORLD);

  EXPECT_THROW(kuhn_cube(comm, 0), Error);
  EXPECT_THROW(kuhn_cube(comm, -3), Error);
  EXPECT_THROW(kuhn_cube(comm, 100001), Error);
}

}  // namespace kuhn_cube_test
}  // namespace pamr::assemble
