// SPDX-License-Identifier: GPL-3.0-or-later
// Patches of inner faces: children of a face inherit its patch, and coarsening restores it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "coarsen_case.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/validate/validate.hpp"
#include "support/dice.hpp"
#include "support/round_bodies.hpp"

namespace pamr {
namespace inner_faces_test {

using geometry::Vec3;
using Corners = std::array<Vec3, 3>;

struct Sheets {
  mesh::DistMesh mesh;
  std::vector<std::vector<Corners>> face;  ///< of each patch, as they were given; on every rank
};

/// A mesh of random cells in which every sixth face inside has one of two patches. The triangles are given on random
/// ranks, some twice.
Sheets random_sheets(const par::Comm& comm, std::uint64_t seed) {
  auto block = test::random_mesh(comm, seed, 3);
  const auto whole = test::gather(comm, block);
  const auto n_patches = block.info.patches.size();
  block.info.patches.push_back({"sheet", ""});
  block.info.patches.push_back({"port", ""});
  Sheets sheets;
  sheets.face.resize(n_patches + 2);
  test::Dice dice(seed);
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (whole.cell_to_cell[c][slot] < static_cast<GlobalId>(c) || dice.below(6) != 0) continue;
      std::vector<GlobalId> node;
      for (const auto k : mesh::tet::face_to_corner[slot]) node.push_back(whole.cell_to_node[c][at(k)]);
      dice.shuffle(node);
      const auto patch = n_patches + dice.below(2);
      sheets.face[patch].push_back(
          {whole.node_position[at(node[0])], whole.node_position[at(node[1])], whole.node_position[at(node[2])]});
      for (auto copies = 1 + dice.below(2); copies > 0; --copies) {
        if (static_cast<Rank>(dice.below(at(comm.size()))) != comm.rank()) continue;
        block.boundary.node.push_back({node[0], node[1], node[2]});
        block.boundary.patch.push_back(static_cast<int>(patch));
      }
    }
  const auto destination = test::random_destinations(comm, block, seed);
  sheets.mesh = assemble::assemble(comm, std::move(block), destination);
  return sheets;
}

Vec3 area_of(const Corners& p) { return 0.5 * cross(p[1] - p[0], p[2] - p[0]); }

bool contains(const Corners& p, Vec3 x) {
  const double all = norm(area_of(p));
  const double parts = norm(area_of({p[0], p[1], x})) + norm(area_of({p[1], p[2], x})) + norm(area_of({p[2], p[0], x}));
  return parts <= all * (1 + 1e-9);
}

/// Both sides of each face say the same, the faces of a patch have its whole area, and each is part of one that was given.
void expect_same_sheets(const par::Comm& comm, const Sheets& given, const mesh::DistMesh& mesh) {
  ASSERT_TRUE(validate::validate(comm, mesh).empty());
  const mesh::InnerPatches patches(mesh);
  std::vector<double> area(given.face.size(), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const int patch = patches.of({c, slot});
      if (patch < 0) continue;
      const auto p = mesh.points(c);
      const auto& corner = mesh::tet::face_to_corner[at(slot)];
      const Corners face{p[at(corner[0])], p[at(corner[1])], p[at(corner[2])]};
      if (patches.is_first_side({c, slot})) area[at(patch)] += norm(area_of(face));
      const auto middle = (1.0 / 3) * (face[0] + face[1] + face[2]);
      ASSERT_TRUE(std::any_of(given.face[at(patch)].begin(), given.face[at(patch)].end(),
                              [&](const Corners& whole) { return contains(whole, middle); }));
    }
  for (std::size_t patch = 0; patch < area.size(); ++patch) {
    double expected = 0;
    for (const auto& face : given.face[patch]) expected += norm(area_of(face));
    EXPECT_NEAR(par::reproducible_sum(comm, std::vector{area[patch]}), expected, 1e-10);
  }
}

std::vector<std::int8_t> random_flags(const mesh::DistMesh& mesh, std::uint64_t seed) {
  std::vector<std::int8_t> flags;
  for (const auto number : mesh.cell_global) {
    const auto draw = combine(seed, static_cast<std::uint64_t>(number)) % 10;
    flags.push_back(draw < 3 ? std::int8_t{1} : draw < 6 ? test::go : std::int8_t{0});
  }
  return flags;
}

/// Coarsens the mesh once wherever it can be coarsened. Collective.
mesh::DistMesh without_last_splits(const par::Comm& comm, mesh::DistMesh mesh) {
  const auto flags = test::all_may_go(mesh);
  return adapt::adapt(comm, std::move(mesh), flags, {{.parent_field = false}, {}}).mesh;
}

TEST(InnerFaces, KeepTheirPatchesWhateverIsSplitAndTakenBack) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto given = random_sheets(comm, seed);
    expect_same_sheets(comm, given, given.mesh);
    auto mesh = given.mesh;
    for (int pass = 0; pass < 3; ++pass) {
      const auto flags = random_flags(mesh, seed + at(pass));
      mesh = adapt::adapt(comm, std::move(mesh), flags, {{.parent_field = false}, {}}).mesh;
      expect_same_sheets(comm, given, mesh);
    }
    for (int pass = 0; pass < 5 && mesh.info.n_global_cells > given.mesh.info.n_global_cells; ++pass)
      mesh = without_last_splits(comm, std::move(mesh));
    EXPECT_EQ(mesh::fingerprint(comm, mesh), mesh::fingerprint(comm, given.mesh));
    EXPECT_EQ(mesh::count_inner_faces(comm, mesh), mesh::count_inner_faces(comm, given.mesh));
  }
}

TEST(InnerFaces, KeepTheirPatchesUnderEveryPolicy) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto given = random_sheets(comm, 9);
  using refine::QualityControl;
  for (const auto control : {QualityControl::isotropic, QualityControl::short_edge, QualityControl::none}) {
    auto mesh = given.mesh;
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<std::uint8_t> flags;
      for (const auto flag : random_flags(mesh, at(pass))) flags.push_back(flag > 0 ? 1 : 0);
      mesh = adapt::refine(comm, std::move(mesh), flags, {.quality_control = control}).mesh;
      expect_same_sheets(comm, given, mesh);
    }
  }
}

/// A ball of radius 1 by 20 cells about its center in one of radius 2: region 1 in region 2. The corners of the sphere
/// between them are those of an icosahedron, so its edges are 1.05 radii long.
mesh::DistMesh ball_in_ball(const par::Comm& comm) {
  const auto inner = test::gather(comm, test::ball(comm));
  auto nodes = inner.node_position;
  auto cells = inner.cell_to_node;
  const auto n_inner = std::ssize(nodes);
  const auto n_inside = cells.size();
  for (std::int64_t i = 0; i < n_inner; ++i) nodes.push_back(2.0 * nodes[at(i)]);
  mesh::BoundaryTriangles sphere;
  for (std::size_t c = 0; c < n_inside; ++c) {  // a prism on each face, cut from the lowest number up
    std::array<GlobalId, 3> face{};
    std::copy_if(cells[c].begin(), cells[c].end(), face.begin(), [](GlobalId node) { return node != 0; });
    std::sort(face.begin(), face.end());
    const auto [a, b, d] = face;
    cells.push_back({a, b, d, d + n_inner});
    cells.push_back({a, b, b + n_inner, d + n_inner});
    cells.push_back({a, a + n_inner, b + n_inner, d + n_inner});
    sphere.node.push_back(face);
    sphere.patch.push_back(1);
  }
  for (auto& n : cells)
    if (geometry::volume({nodes[at(n[0])], nodes[at(n[1])], nodes[at(n[2])], nodes[at(n[3])]}) < 0)
      std::swap(n[2], n[3]);
  std::map<GlobalId, GlobalId> number;  // the center of the outer ball is no node
  std::vector<Vec3> used;
  for (auto& n : cells)
    for (auto& node : n) {
      const auto [entry, is_new] = number.try_emplace(node, std::ssize(used));
      if (is_new) used.push_back(nodes[at(node)]);
      node = entry->second;
    }
  for (auto& face : sphere.node)
    for (auto& node : face) node = number.at(node);
  std::vector<std::int64_t> region(cells.size(), 2);
  std::fill_n(region.begin(), n_inside, 1);
  auto block = test::small_mesh(comm, used, cells);
  block.info.patches = {{"outside", ""}, {"interface", "", 0}};
  block.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");
  const auto own = par::block_range(std::ssize(cells), comm.rank(), comm.size());
  block.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int32,
                               std::vector<std::int64_t>(region.begin() + own.begin, region.begin() + own.end)});
  if (comm.is_first()) block.boundary = sphere;
  return assemble::assemble(comm, std::move(block));
}

double volume_of_region(const par::Comm& comm, const mesh::DistMesh& mesh, std::int64_t region) {
  double sum = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (mesh.find_cell_field(mesh::region_field)->integer()[at(c)] == region) sum += geometry::volume(mesh.points(c));
  return par::reproducible_sum(comm, std::vector{sum});
}

/// The nodes of faces inside that have a patch. Local.
std::vector<Vec3> nodes_inside(const mesh::DistMesh& mesh) {
  const mesh::InnerPatches patches(mesh);
  std::vector<Vec3> nodes;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      for (std::size_t k = 0; k < (patches.of({c, slot}) >= 0 ? 3U : 0U); ++k)
        nodes.push_back(mesh.point(mesh.cell_to_node[at(c)][at(mesh::tet::face_to_corner[at(slot)][k])]));
  return nodes;
}

TEST(InnerFaces, OfACurvedInterfaceFollowItsSurfaceOnBothSides) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto start = ball_in_ball(comm);
  auto mesh = start;
  double error = 4 * std::numbers::pi / 3 - volume_of_region(comm, mesh, 1);
  for (int level = 1; level <= 3; ++level) {
    const std::vector<std::uint8_t> flags(at(mesh.n_cells()), 1);
    auto result = adapt::refine(comm, std::move(mesh), flags, {.parent_field = false});
    mesh = std::move(result.mesh);
    EXPECT_EQ(result.report.certificate.n_off_surface, 0);
    ASSERT_TRUE(validate::validate(comm, mesh).empty());
    for (const auto p : nodes_inside(mesh)) ASSERT_NEAR(norm(p), 1, 1e-14);
    const double now = 4 * std::numbers::pi / 3 - volume_of_region(comm, mesh, 1);
    if (level > 1) {
      EXPECT_NEAR(error / now, 4, 0.3);
    }
    error = now;
    double worst = 1;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
    EXPECT_GT(comm.min(worst), 0.2);
  }
  for (int level = 0; level < 3; ++level) mesh = without_last_splits(comm, std::move(mesh));
  EXPECT_EQ(mesh::fingerprint(comm, mesh), mesh::fingerprint(comm, start));
}

TEST(InnerFaces, OfACurvedSheetMeetTheBoundaryInACurveOfBoth) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr double radius = 1.5;
  auto block = test::kuhn_cube(comm, 4);
  const auto whole = test::gather(comm, block);
  mesh::BoundaryTriangles sheet;
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      std::array<GlobalId, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) face[k] = whole.cell_to_node[c][at(mesh::tet::face_to_corner[slot][k])];
      if (std::any_of(face.begin(), face.end(), [&](GlobalId n) { return whole.node_position[at(n)].x != 0.5; }))
        continue;
      sheet.node.push_back(face);
      sheet.patch.push_back(6);
    }
  for (auto& p : block.node_position)
    p.x += (1 - std::abs(2 * p.x - 1)) * (std::sqrt(radius * radius - (p.y - 0.5) * (p.y - 0.5)) - radius);
  block.info.surfaces = test::surfaces_of(fmt::format(
      "[[surface]]\nname = \"sheet\"\nkind = \"cylinder\"\npoint = [{}, 0.5, 0]\naxis = [0, 0, 1]\nradius = {}\n",
      0.5 - radius, radius));
  block.info.patches.push_back({"sheet", "", 0});
  block.cell_to_cell.clear();
  block.boundary = {};
  if (comm.is_first()) block.boundary = sheet;
  auto mesh = assemble::assemble(comm, std::move(block));
  for (int level = 0; level < 2; ++level) {
    const std::vector<std::uint8_t> flags(at(mesh.n_cells()), 1);
    mesh = adapt::refine(comm, std::move(mesh), flags).mesh;
    ASSERT_TRUE(validate::validate(comm, mesh).empty());
  }
  double least = 1, most = 0;
  for (const auto p : nodes_inside(mesh)) {
    ASSERT_NEAR(std::hypot(p.x - 0.5 + radius, p.y - 0.5), radius, 1e-13);
    least = std::min({least, p.y, p.z});
    most = std::max({most, p.y, p.z});
  }
  EXPECT_EQ(comm.min(least), 0);
  EXPECT_EQ(comm.max(most), 1);
  EXPECT_EQ(comm.sum(mesh::count_inner_faces(comm, mesh)[6] * (comm.is_first() ? 1 : 0)), 32 * 16);
}

TEST(InnerFaces, AreSeenByTheFingerprintAndByValidate) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto given = random_sheets(comm, 5);
  auto mesh = given.mesh;
  auto& word = mesh::make_inner_patches(mesh);
  for (auto& one : word) one = 0;
  EXPECT_NE(mesh::fingerprint(comm, mesh), mesh::fingerprint(comm, given.mesh));

  const auto first_violation = [&] {
    const auto violations = validate::validate(comm, mesh);
    return violations.empty() ? std::string("none") : violations.front().invariant;
  };
  if (comm.is_first()) word[0] = mesh::with_inner_patch(0, mesh.cell_to_cell[0][0] < 0 ? 1 : 0, 6);
  EXPECT_EQ(first_violation(), "inner_patches_agree");  // one side alone
  if (comm.is_first()) word[0] = mesh::with_inner_patch(0, mesh.cell_to_cell[0][0] < 0 ? 1 : 0, 8);
  EXPECT_EQ(first_violation(), "patches_in_range");
}

TEST(InnerFaces, HaveNoPatchOfFacesWithoutATag) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = random_sheets(comm, 5).mesh;
  ASSERT_TRUE(validate::validate(comm, mesh).empty());
  const auto n_inside = mesh::count_inner_faces(comm, mesh);
  const auto message = [&] {
    try {
      validate::require_valid(comm, mesh, "a.hdf");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };

  mesh.info.patches[6].kind = mesh::untagged_kind;
  EXPECT_THAT(message(),
              testing::HasSubstr(fmt::format(
                  "a.hdf: expected faces of the boundary alone in a patch of kind 'untagged', found {} inside "
                  "in '{}'",
                  n_inside[6], mesh.info.patches[6].name)));
  mesh.info.patches[0].kind = mesh::untagged_kind;
  EXPECT_THAT(message(),
              testing::StartsWith(fmt::format(
                  "a.hdf: expected at most one patch of kind 'untagged', found '{}' and '{}', first at cell ",
                  mesh.info.patches[0].name, mesh.info.patches[6].name)));
  mesh.info.patches[6].kind.clear();
  EXPECT_EQ(message(), "none");
}

}  // namespace inner_faces_test
}  // namespace pamr
