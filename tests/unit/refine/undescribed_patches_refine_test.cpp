// SPDX-License-Identifier: GPL-3.0-or-later
// Patches without a surface beside a patch with one: refinements must not bend them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "pamr/adapt/adapt.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace undescribed_patches_refine_test {

using geometry::Vec3;

/// Rotates by 0.7 about (1, 2, 2).
Vec3 turned(Vec3 p, double angle = 0.7) {
  const Vec3 axis{1.0 / 3, 2.0 / 3, 2.0 / 3};
  const double c = std::cos(angle), s = std::sin(angle);
  return c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis;
}

constexpr double bulge = 0.03;
constexpr double radius = (0.5 + bulge * bulge) / (2 * bulge);
constexpr Vec3 center{0.5, 0.5, bulge - radius};

/// A random cube, turned, whose patch zmin is to go onto a sphere through its corners; no other patch has a surface.
mesh::BlockMesh domed_cube(const par::Comm& comm, std::uint64_t seed) {
  auto block = test::random_mesh(comm, seed, 3);
  for (auto& p : block.node_position) p = turned(p);
  block.info.surfaces = test::surfaces_of(
      "[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = " + geometry::decimal(turned(center)) +
      "\nradius = " + geometry::decimal(radius) + "\n");
  for (auto& patch : block.info.patches)
    if (patch.name == "zmin") patch.surface = 0;
  return block;
}

/// The same with one patch `walls` for all sides but zmin.
mesh::BlockMesh with_one_wall(mesh::BlockMesh block) {
  std::map<GlobalId, GlobalId> slot;
  for (std::size_t p = 0; p < block.info.patches.size(); ++p)
    slot[-static_cast<GlobalId>(p) - 1] = block.info.patches[p].name == "zmin" ? -1 : -2;
  for (auto& neighbors : block.cell_to_cell)
    for (auto& next : neighbors)
      if (next < 0) next = slot.at(next);
  block.info.patches = {{"zmin", "", 0}, {"walls", "", -1}};
  return block;
}

std::vector<std::uint8_t> near_dome(const mesh::DistMesh& mesh) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    flags.push_back(turned(0.25 * (p[0] + p[1] + p[2] + p[3]), -0.7).z < 0.25 ? 1 : 0);
  }
  return flags;
}

/// Positions of the nodes of each patch, in the place of the cube before it was turned.
std::map<std::string, std::vector<Vec3>> nodes_by_patch(const mesh::BlockMesh& whole) {
  std::map<std::string, std::vector<Vec3>> nodes;
  for (std::size_t c = 0; c < whole.cell_to_cell.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto next = whole.cell_to_cell[c][f];
      if (next >= 0) continue;
      for (const auto corner : mesh::tet::face_to_corner[f])
        nodes[whole.info.patches[static_cast<std::size_t>(-next - 1)].name].push_back(turned(
            whole.node_position[static_cast<std::size_t>(whole.cell_to_node[c][static_cast<std::size_t>(corner)])],
            -0.7));
    }
  return nodes;
}

/// Smallest distance of a point from a side of the cube but z = 0.
double distance_from_sides(Vec3 p) {
  return std::min({std::abs(p.x), std::abs(p.x - 1), std::abs(p.y), std::abs(p.y - 1), std::abs(p.z - 1)});
}

/// The same from the side of that patch; 0 for zmin.
double distance_from_side(const std::string& patch, Vec3 p) {
  if (patch == "walls") return distance_from_sides(p);
  if (patch == "zmin") return 0;
  const double x = patch[0] == 'x' ? p.x : patch[0] == 'y' ? p.y : p.z;
  return std::abs(patch.ends_with("min") ? x : x - 1);
}

TEST(FlatPatches, StayFlatBesideACurvedOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const bool is_one_patch : {false, true}) {
    auto block = domed_cube(comm, 5);
    if (is_one_patch) block = with_one_wall(std::move(block));
    auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 5));
    for (int level = 0; level < 3; ++level) {
      auto result = adapt::refine(comm, mesh, near_dome(mesh), {.marks_field = ""});
      EXPECT_EQ(result.report.certificate.n_off_surface, 0);
      mesh = std::move(result.mesh);
    }

    const auto nodes = nodes_by_patch(test::gather(comm, mesh));

    std::set<std::array<double, 3>> on_rim;
    for (const auto& [name, points] : nodes)
      for (const auto& p : points) {
        EXPECT_LE(distance_from_side(name, p), 2e-15) << name;
        if (name != "zmin" || distance_from_sides(p) > 1e-12 || std::abs(p.z) < 1e-12) continue;
        EXPECT_NEAR(geometry::norm(p - center), radius, 1e-14);
        on_rim.insert({p.x, p.y, p.z});
      }
    EXPECT_EQ(on_rim.size(), 4U * (24 - 3)) << "new nodes of 12 edges after three refinements";
    EXPECT_EQ(mesh.find_node_field(mesh::off_facets_field), nullptr);
    EXPECT_EQ(mesh.info.surfaces->size(), is_one_patch ? 1 : 5);
  }
}

TEST(FlatPatches, KeepThePlaneOfTheFirstRefinementAtEveryLevel) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, domed_cube(comm, 6));
  const auto once = adapt::refine(comm, mesh, near_dome(mesh), {.marks_field = ""}).mesh;
  const auto twice = adapt::refine(comm, once, near_dome(once), {.marks_field = ""}).mesh;

  EXPECT_EQ(once.info.surfaces->size(), 5);
  EXPECT_EQ(twice.info.surfaces->toml, once.info.surfaces->toml);
  EXPECT_TRUE(twice.info.patches == once.info.patches);
  EXPECT_EQ(adapt::refine(comm, mesh, near_dome(mesh), {.project = false, .marks_field = ""}).mesh.info.surfaces,
            mesh.info.surfaces);
}

TEST(FlatPatches, HaveTheSameBitsForAnyDistribution) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const bool is_one_patch : {false, true}) {
    auto block = domed_cube(comm, 7);
    if (is_one_patch) block = with_one_wall(std::move(block));
    auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, 7));
    auto serial = assemble::assemble(self, test::cut(self, test::gather(comm, block)));
    for (int level = 0; level < 2; ++level) {
      spread = adapt::refine(comm, spread, near_dome(spread), {.marks_field = ""}).mesh;
      serial = adapt::refine(self, serial, near_dome(serial), {.marks_field = ""}).mesh;
    }
    const auto a = test::gather(comm, spread), b = test::gather(self, serial);
    EXPECT_TRUE(a.node_position == b.node_position);
    EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
    EXPECT_EQ(a.info.surfaces->toml, b.info.surfaces->toml);
  }
}

/// A cube whose side zmin is part of a ball: the half x < 1/2 is the patch `ball` on it, the rest is without surface.
mesh::BlockMesh half_described_ball(const par::Comm& comm) {
  auto block = test::kuhn_cube(comm, 4);
  const auto height = [](double x, double y) {
    return center.z + std::sqrt(radius * radius - (x - 0.5) * (x - 0.5) - (y - 0.5) * (y - 0.5));
  };
  const auto whole = test::gather(comm, block);
  const auto zmin = std::find_if(block.info.patches.begin(), block.info.patches.end(),
                                 [](const auto& patch) { return patch.name == "zmin"; }) -
                    block.info.patches.begin();
  for (std::size_t c = 0; c < block.cell_to_cell.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      if (block.cell_to_cell[c][f] != -zmin - 1) continue;
      double x = 0;
      for (const auto corner : mesh::tet::face_to_corner[f])
        x += whole.node_position[static_cast<std::size_t>(block.cell_to_node[c][static_cast<std::size_t>(corner)])].x /
             3;
      if (x < 0.5) block.cell_to_cell[c][f] = -7;
    }
  for (auto& p : block.node_position) p.z += (1 - p.z) * height(p.x, p.y);
  block.info.patches.push_back({"ball", "", 0});
  block.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = " + geometry::decimal(center) +
                        "\nradius = " + geometry::decimal(radius) + "\n");
  return block;
}

TEST(UndescribedPatches, ThatContinueACurvedOneAreBentToldAndRecorded) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = half_described_ball(comm);
  auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 2));

  const auto lines = mesh::warnings_of(mesh.info, mesh::find_undescribed_patches(comm, mesh));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("patch 'zmin' has no surface: 4 faces of it continue patch 'ball' smoothly"),
            std::string::npos)
      << lines[0];

  std::int64_t n_recorded = 0;
  double worst = 0;
  for (int level = 0; level < 2; ++level) {
    const std::vector<std::uint8_t> all(static_cast<std::size_t>(mesh.n_cells()), 1);
    auto result = adapt::refine(comm, mesh, all, {.marks_field = ""});
    EXPECT_EQ(result.report.certificate.n_off_facets, level == 0 ? 4 : 8);
    n_recorded += result.report.certificate.n_off_facets;
    mesh = std::move(result.mesh);

    const auto whole = test::gather(comm, mesh);
    ASSERT_EQ(whole.node_fields.size(), 1U);
    EXPECT_EQ(whole.node_fields[0].name, mesh::off_facets_field);
    std::int64_t n = 0;
    for (std::size_t i = 0; i < whole.node_position.size(); ++i) {
      const double off = whole.node_fields[0].real()[i];
      n += off > 0 ? 1 : 0;
      worst = std::max(worst, off);
      EXPECT_TRUE(off == 0 || std::abs(whole.node_position[i].x - 0.5) < 1e-3);
    }
    EXPECT_EQ(n, n_recorded);
  }
  // a chord of the ball 1/4 long is 1/4^2 / 8 radius away from it
  EXPECT_NEAR(worst, 1.0 / 128 / radius, 5e-6);
}

}  // namespace undescribed_patches_refine_test
}  // namespace pamr
