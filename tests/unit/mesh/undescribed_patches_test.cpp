// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/undescribed_patches.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace undescribed_patches_test {

using geometry::Vec3;

/// Rotates by 0.7 about (1, 2, 2).
Vec3 turned(Vec3 p) {
  const Vec3 axis{1.0 / 3, 2.0 / 3, 2.0 / 3};
  const double c = std::cos(0.7), s = std::sin(0.7);
  return c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis;
}

/// A cube of 3 x 3 x 3 whose nodes are moved by `move`, with the cells on random ranks.
mesh::DistMesh moved_cube(const par::Comm& comm, const std::function<Vec3(Vec3)>& move) {
  auto block = test::kuhn_cube(comm, 3);
  for (auto& p : block.node_position) p = move(p);
  return assemble::assemble(comm, block, test::random_destinations(comm, block, 3));
}

std::vector<mesh::PlaneFit> fit_all(const par::Comm& comm, const mesh::DistMesh& mesh) {
  return mesh::fit_planes(comm, mesh, std::vector<bool>(mesh.info.patches.size(), true));
}

TEST(PlaneFit, IsExactAcrossAnAxis) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = moved_cube(comm, [](Vec3 p) { return p; });

  const auto planes = fit_all(comm, mesh);

  const std::vector<std::string> name{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const auto place = std::find(name.begin(), name.end(), mesh.info.patches[p].name) - name.begin();
    const std::size_t axis = static_cast<std::size_t>(place) / 2;
    EXPECT_TRUE(planes[p].is_flat);
    EXPECT_EQ(planes[p].distance, 0);
    EXPECT_EQ(planes[p].normal[axis], 1);
    EXPECT_EQ(geometry::norm(planes[p].normal), 1);
    EXPECT_EQ(planes[p].point[axis], place % 2);
    EXPECT_DOUBLE_EQ(planes[p].size, std::sqrt(2.0));
  }
}

TEST(PlaneFit, FindsPlanesOfAnyDirectionFarFromTheOriginAndOfAnySize) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const double size : {1e-9, 1.0, 1e9})
    for (const double offset : {0.0, 1.0, 1e6}) {
      const Vec3 away = (offset * size) * Vec3{0.3, -0.7, 0.9};
      const auto planes = fit_all(comm, moved_cube(comm, [&](Vec3 p) { return size * turned(p) + away; }));
      for (const auto& plane : planes) {
        EXPECT_TRUE(plane.is_flat) << size << " " << offset << ": " << plane.distance;
        EXPECT_NEAR(geometry::norm(plane.normal), 1, 1e-15);
        EXPECT_LE(plane.distance, 1e-15 * size * (1 + offset));
      }
    }
}

TEST(PlaneFit, TellsRoundingFromShape) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto dented = [](double depth) {
    return [depth](Vec3 p) {
      const bool is_inside_a_face = p.z == 0 && p.x > 0.5 && p.x < 1 && p.y > 0.5 && p.y < 1;
      return turned(is_inside_a_face ? Vec3{p.x, p.y, depth} : p);
    };
  };
  for (const auto& [depth, is_flat] : {std::pair{1.2e-10, true}, {2.5e-10, false}, {1e-3, false}}) {
    const auto mesh = moved_cube(comm, dented(depth));
    const auto planes = fit_all(comm, mesh);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const bool is_dented = mesh.info.patches[p].name == "zmin";
      EXPECT_EQ(planes[p].is_flat, is_flat || !is_dented) << depth;
      EXPECT_NEAR(planes[p].distance, is_dented ? depth : 0, 1e-15);
    }
  }
}

TEST(PlaneFit, HasTheSameBitsForAnyDistribution) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shape = [](Vec3 p) { return turned({p.x, p.y, p.z + 0.1 * p.x * p.y * (1 - p.z)}); };

  const auto spread = fit_all(comm, moved_cube(comm, shape)), serial = fit_all(self, moved_cube(self, shape));

  ASSERT_EQ(spread.size(), serial.size());
  for (std::size_t p = 0; p < spread.size(); ++p) {
    EXPECT_TRUE(spread[p].point == serial[p].point && spread[p].normal == serial[p].normal);
    EXPECT_EQ(spread[p].distance, serial[p].distance);
    EXPECT_EQ(spread[p].is_flat, serial[p].is_flat);
  }
}

TEST(PlaneFit, IsNotFlatWhereANodeIsNotFinite) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = moved_cube(comm, [](Vec3 p) { return p; });
  for (auto& p : mesh.node_position)
    if (p == Vec3{}) p.x = std::nan("");

  const auto planes = fit_all(comm, mesh);

  for (std::size_t p = 0; p < planes.size(); ++p)
    EXPECT_EQ(planes[p].is_flat, mesh.info.patches[p].name.ends_with("max")) << mesh.info.patches[p].name;
}

/// The turned cube; zmin lies on a ball through its corners, in which it bulges a little.
mesh::DistMesh cube_on_a_ball(const par::Comm& comm) {
  auto mesh = moved_cube(comm, turned);
  const auto center = turned({0.5, 0.5, -2});
  mesh.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [" + std::to_string(center.x) +
                        ", " + std::to_string(center.y) + ", " + std::to_string(center.z) + "]\nradius = 2.12\n");
  for (auto& patch : mesh.info.patches)
    if (patch.name == "zmin") patch.surface = 0;
  return mesh;
}

TEST(UndescribedPatches, AreThoseThatMeetOthersAndGetTheirPlanes) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube_on_a_ball(comm);

  const auto undescribed = mesh::find_undescribed_patches(comm, mesh);
  const auto info = mesh::with_planes(mesh.info, undescribed);

  EXPECT_EQ(undescribed.size(), 4U);
  EXPECT_TRUE(mesh::warnings_of(mesh.info, undescribed).empty());
  for (std::size_t p = 0; p < info.patches.size(); ++p) {
    const auto& patch = info.patches[p];
    const bool is_far = patch.name == "zmax";
    EXPECT_EQ(info.surface_name(patch), is_far ? "" : patch.name == "zmin" ? "ball" : "plane of " + patch.name);
    if (is_far || patch.name == "zmin") continue;
    EXPECT_TRUE(info.surface_of(static_cast<int>(p))->is_flat());
  }
  const auto again = geometry::surfaces_from_toml(info.surfaces->toml, "again");
  ASSERT_EQ(again.size(), 5);
  for (int i = 0; i < again.size(); ++i)
    EXPECT_EQ(again.get(i)->project({0.3, 0.5, 0.7}), info.surfaces->get(i)->project({0.3, 0.5, 0.7}));
}

TEST(UndescribedPatches, AreNotLookedForWhereAllOrNoneAreDescribed) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = cube_on_a_ball(comm);
  for (auto& patch : mesh.info.patches) patch.surface = 0;
  EXPECT_TRUE(mesh::find_undescribed_patches(comm, mesh).empty());
  for (auto& patch : mesh.info.patches) patch.surface = -1;
  EXPECT_TRUE(mesh::find_undescribed_patches(comm, mesh).empty());
}

TEST(UndescribedPatches, HaveNamesThatNoSurfaceHas) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = cube_on_a_ball(comm);
  auto set = *mesh.info.surfaces;
  set.append(geometry::set_of(std::array{geometry::described_plane("plane of xmin", 2, 9)}, "test"));
  mesh.info.surfaces = std::make_shared<const geometry::SurfaceSet>(set);
  mesh.info.patches[0].name = "a \"b\\c";

  const auto info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh));

  EXPECT_EQ(geometry::surfaces_from_toml(info.surfaces->toml, "again").name, info.surfaces->name);
  EXPECT_GE(info.surfaces->size(), 6);
}

TEST(UndescribedPatches, SayWhatToWriteForAPlaneWithFewDigits) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = cube_on_a_ball(comm);
  for (auto& p : mesh.node_position)
    p = {std::round(p.x * 1e7) * 1e-7, std::round(p.y * 1e7) * 1e-7, std::round(p.z * 1e7) * 1e-7};

  const auto undescribed = mesh::find_undescribed_patches(comm, mesh);
  const auto lines = mesh::warnings_of(mesh.info, undescribed);

  ASSERT_EQ(lines.size(), 4U);
  for (const auto& u : undescribed) EXPECT_FALSE(u.plane.is_flat);
  EXPECT_NE(lines[0].find("kind = \"plane\", point = ["), std::string::npos) << lines[0];
  EXPECT_EQ(mesh::with_planes(mesh.info, undescribed).surfaces, mesh.info.surfaces);
}

}  // namespace undescribed_patches_test
}  // namespace pamr
