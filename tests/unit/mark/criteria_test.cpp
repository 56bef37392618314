// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/mark/field_criteria.hpp"
#include "pamr/mark/geometric_criteria.hpp"

namespace pamr::mark {
namespace criteria_test {

using geometry::Vec3;

/// Fields of the test meshes as functions of the position, so that every distribution has the same values.
double density(Vec3 p) { return 1.0 + p.x + 0.25 * p.y * p.z; }
double mean_free_path(Vec3 p) { return 0.05 + 0.1 * p.x; }

/// The Kuhn cube with its cells scattered over the ranks without any order, nodal field `density`, cell field `length`.
mesh::DistMesh scattered_cube(const par::Comm& comm, int n) {
  auto block = assemble::kuhn_cube(comm, n);
  mesh::Field nodal, cellwise;
  nodal.name = "density";
  for (const auto p : block.node_position) nodal.real().push_back(density(p));
  block.node_fields.push_back(nodal);
  std::vector<Rank> destination;
  for (std::size_t i = 0; i < block.cell_to_node.size(); ++i) {
    const auto id = static_cast<std::uint64_t>(block.first_cell) + i;
    destination.push_back(static_cast<Rank>(mix(id) % static_cast<std::uint64_t>(comm.size())));
  }
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  cellwise.name = "length";
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) cellwise.real().push_back(mean_free_path(centroid(mesh, cell)));
  mesh.cell_fields.push_back(cellwise);
  return mesh;
}

/// Mark of every cell of the mesh in global order, on every rank.
std::vector<std::int64_t> gathered(const par::Comm& comm, const mesh::DistMesh& mesh,
                                   const std::vector<std::uint8_t>& marks) {
  std::vector<std::int64_t> all(static_cast<std::size_t>(mesh.info.n_global_cells), 0);
  for (std::size_t i = 0; i < marks.size(); ++i) all[static_cast<std::size_t>(mesh.cell_global[i])] = marks[i];
  comm.sum_in_place(all);
  return all;
}

using Criterion = std::function<Indicator(const par::Comm&, const mesh::DistMesh&)>;

/// Marks on the scattered mesh of all ranks equal those on the mesh of one rank; returns how many there are.
std::int64_t expect_same_on_one_rank(const Criterion& criterion, int n = 4) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = scattered_cube(world, n), whole = scattered_cube(self, n);
  const auto marks = gathered(world, shared, marks_of(criterion(world, shared)));
  const auto twin = gathered(self, whole, marks_of(criterion(self, whole)));
  EXPECT_EQ(marks, twin);
  return std::count(marks.begin(), marks.end(), 1);
}

TEST(RoundTo20Bits, KeepsWhatFitsAndRoundsTheRest) {
  EXPECT_EQ(round_to_20_bits(0.0), 0.0);
  EXPECT_EQ(round_to_20_bits(-1048575.0), -1048575.0);
  EXPECT_EQ(round_to_20_bits(1.0 + 0x1p-30), 1.0);
  EXPECT_EQ(round_to_20_bits(2097153.0), 2097152.0);
  EXPECT_EQ(round_to_20_bits(0.1), round_to_20_bits(std::nextafter(0.1, 1.0)));
  EXPECT_EQ(round_to_20_bits(0x1.00001p0), 1.0) << "half to even";
  EXPECT_EQ(round_to_20_bits(-0x1.00003p0), -0x1.00004p0) << "half to even";
  EXPECT_EQ(round_to_20_bits(0x1.fffffp-3), 0x1p-2) << "into the exponent";
  EXPECT_EQ(round_to_20_bits(std::numeric_limits<double>::max()), std::numeric_limits<double>::infinity());
  EXPECT_EQ(round_to_20_bits(1e-310), round_to_20_bits(1e-310 * (1 + 1e-10)));
}

TEST(AllCells, MarksEveryCell) {
  EXPECT_EQ(expect_same_on_one_rank([](const auto&, const auto& mesh) { return all_cells(mesh); }), 6 * 64);
}

TEST(CrossingSphere, MarksCellsWithCornersOnBothSides) {
  // The sphere around the origin through no node: only the six cells at the corner have a node nearer than 0.2.
  const auto count = expect_same_on_one_rank([](const auto&, const auto& mesh) {
    return crossing_sphere(mesh, {{0, 0, 0}, 0.2});
  });

  EXPECT_EQ(count, 6);
}

TEST(CrossingSphere, LeavesCellsThatOnlyTouchTheSphere) {
  const auto count = expect_same_on_one_rank([](const auto&, const auto& mesh) {
    return crossing_sphere(mesh, {{0, 0, 0}, 0.25});
  });
  par::Comm self(MPI_COMM_SELF);
  const auto mesh = scattered_cube(self, 4);
  std::int64_t twin = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    bool inside = false, outside = false;
    for (const auto p : mesh.points(cell)) {
      inside |= geometry::norm(p) < 0.25;
      outside |= geometry::norm(p) > 0.25;
    }
    twin += inside && outside ? 1 : 0;
  }

  EXPECT_EQ(count, twin);
  EXPECT_EQ(count, 6);  // the nodes at 1/4 on the axes lie on the sphere, not outside; farther corners do
}

TEST(CentroidInShell, MarksByTheDistanceOfTheCentroid) {
  const auto count = expect_same_on_one_rank([](const auto&, const auto& mesh) {
    return centroid_in_shell(mesh, {{0.5, 0.5, 0.5}, 0.0}, 0.2);
  });

  EXPECT_GT(count, 0);
  EXPECT_EQ(count % 6, 0);  // the Kuhn cube is symmetric under the permutations of the axes
  EXPECT_LT(count, 6 * 64);
}

TEST(CentroidInBox, TakesInItsFaces) {
  // Centroids of the cells of a cube of side 1/4 lie at 1/4, 1/2 and 3/4 of it along the axes.
  const auto closed = expect_same_on_one_rank([](const auto&, const auto& mesh) {
    return centroid_in_box(mesh, {0, 0, 0}, {0.1875, 0.25, 0.25});
  });
  const auto smaller = expect_same_on_one_rank([](const auto&, const auto& mesh) {
    return centroid_in_box(mesh, {0, 0, 0}, {0.1874, 0.25, 0.25});
  });

  EXPECT_EQ(closed, 6);
  EXPECT_EQ(smaller, 4);
}

TEST(NearPatch, FirstLayerAreTheCellsWithAFaceOnThePatch) {
  const auto count =
      expect_same_on_one_rank([](const auto& comm, const auto& mesh) { return near_patch(comm, mesh, "xmin"); });

  EXPECT_EQ(count, 2 * 16);
}

TEST(NearPatch, APatternStandsForSeveralPatches) {
  const auto count = [](const char* patch) {
    return expect_same_on_one_rank([=](const auto& comm, const auto& mesh) { return near_patch(comm, mesh, patch); });
  };
  EXPECT_EQ(count("x*"), 2 * 2 * 16);
  EXPECT_EQ(count("?min"), count("[xyz]min"));
  EXPECT_GT(count("?min"), count("xmin"));
}

TEST(NearPatch, FurtherLayersGoByNodesAcrossRanks) {
  const auto two =
      expect_same_on_one_rank([](const auto& comm, const auto& mesh) { return near_patch(comm, mesh, "xmin", 2); });
  const auto five =
      expect_same_on_one_rank([](const auto& comm, const auto& mesh) { return near_patch(comm, mesh, "xmin", 5); });
  const auto many =
      expect_same_on_one_rank([](const auto& comm, const auto& mesh) { return near_patch(comm, mesh, "xmin", 9); });

  EXPECT_GE(two, 6 * 16);  // all cells of the first slab of cubes touch a node of the patch
  EXPECT_GT(five, two);
  EXPECT_EQ(many, 6 * 64);
}

TEST(NearPatch, RefusesAnUnknownPatchByName) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = scattered_cube(comm, 2);
  try {
    near_patch(comm, mesh, "wing");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("wing"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("xmin"), std::string::npos);
  }
  EXPECT_THROW(near_patch(comm, mesh, "xmin", 0), Error);
  EXPECT_THROW(near_patch(comm, mesh, "w*"), Error);
}

TEST(BeyondThreshold, TakesNodalFieldsByTheMeanOfTheCorners) {
  const auto above = expect_same_on_one_rank([](const auto& comm, const auto& mesh) {
    return beyond_threshold(comm, mesh, {"density", Side::above, 1.5});
  });
  const auto below = expect_same_on_one_rank([](const auto& comm, const auto& mesh) {
    return beyond_threshold(comm, mesh, {"density", Side::below, 1.5});
  });

  EXPECT_GT(above, 0);
  EXPECT_GT(below, 0);
  EXPECT_LE(above + below, 6 * 64);
}

TEST(BeyondThreshold, DoesNotTakeTheThresholdItselfNorItsLastBits) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = scattered_cube(comm, 2);
  mesh::Field field;
  field.name = "f";
  for (std::size_t i = 0; i < mesh.cell_to_node.size(); ++i)
    field.real().push_back(i % 2 == 0 ? 0.1 : std::nextafter(0.1, 1.0));
  mesh.cell_fields.push_back(field);

  EXPECT_EQ(count_marked(comm, marks_of(beyond_threshold(comm, mesh, {"f", Side::above, 0.1}))), 0);
  EXPECT_EQ(count_marked(comm, marks_of(beyond_threshold(comm, mesh, {"f", Side::below, 0.1}))), 0);
  EXPECT_EQ(count_marked(comm, marks_of(beyond_threshold(comm, mesh, {"f", Side::above, 0.09999}))), 6 * 8);
}

TEST(BeyondThreshold, RefusesUnknownVectorAndNotFiniteFields) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = scattered_cube(comm, 2);
  mesh::Field vector, holes;
  vector.name = "v";
  vector.n_components = 3;
  vector.real().resize(3 * mesh.cell_to_node.size());
  holes.name = "holes";
  for (const auto id : mesh.cell_global)
    holes.real().push_back(id == 7 ? std::numeric_limits<double>::quiet_NaN() : 1.0);
  mesh.cell_fields.push_back(vector);
  mesh.cell_fields.push_back(holes);

  EXPECT_THROW(beyond_threshold(comm, mesh, {"nothing", Side::above, 0}), Error);
  EXPECT_THROW(beyond_threshold(comm, mesh, {"v", Side::above, 0}), Error);
  try {
    beyond_threshold(comm, mesh, {"holes", Side::above, 0});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cell 7"), std::string::npos) << error.what();
  }
}

TEST(LargerThanLength, ComparesTheCellSizeWithTheField) {
  // All cells have volume 1/384, cube root 0.1376; the longest edge is the diagonal sqrt(3)/4 = 0.433.
  const auto by_volume = expect_same_on_one_rank(
      [](const auto& comm, const auto& mesh) { return larger_than_length(comm, mesh, "length", 1.4); });
  const auto by_edge = expect_same_on_one_rank([](const auto& comm, const auto& mesh) {
    return larger_than_length(comm, mesh, "length", 1.4, CellSize::longest_edge);
  });

  par::Comm self(MPI_COMM_SELF);
  const auto mesh = scattered_cube(self, 4);
  std::int64_t twin = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    twin += std::cbrt(1.0 / 384) / mean_free_path(centroid(mesh, cell)) > 1.4 ? 1 : 0;
  EXPECT_EQ(by_volume, twin);
  EXPECT_GT(by_volume, 0);
  EXPECT_EQ(by_edge, 6 * 64);
}

TEST(LargerThanLength, RefusesLengthsThatAreNotPositive) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = scattered_cube(comm, 2);
  mesh.find_cell_field("length")->real().assign(mesh.cell_to_node.size(), 0.0);

  EXPECT_THROW(larger_than_length(comm, mesh, "length", 1), Error);
  EXPECT_THROW(larger_than_length(comm, mesh, "density", 0), Error);
}

TEST(KeepOnlyWhere, LimitsByAField) {
  const auto count = expect_same_on_one_rank([](const auto& comm, const auto& mesh) {
    auto indicator = near_patch(comm, mesh, "xmin");
    keep_only_where(comm, mesh, {{"density", Side::above, 1.2}}, indicator);
    return indicator;
  });

  EXPECT_GT(count, 0);
  EXPECT_LT(count, 2 * 16);
}

/// A cube whose cells hold the density 1.2 and, by turns, no error and one of 0.1.
mesh::DistMesh noisy_cube(const par::Comm& comm) {
  auto mesh = scattered_cube(comm, 1);
  std::vector<double> error;
  for (const auto id : mesh.cell_global) error.push_back(id % 2 == 0 ? 0.0 : 0.1);
  auto& densities = mesh.node_fields.front().real();
  densities.assign(densities.size(), 1.2);
  mesh.find_cell_field("length")->real() = error;
  return mesh;
}

TEST(KeepOnlyWhere, LeavesOutValuesThatAreBeyondByLessThanTheirError) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = noisy_cube(comm);
  const auto kept = [&](Side side, double threshold, const Certainty& certainty) {
    auto indicator = all_cells(mesh);
    keep_only_where(comm, mesh, {{"density", side, threshold}, certainty}, indicator);
    return count_marked(comm, marks_of(indicator));
  };

  EXPECT_EQ(kept(Side::above, 1.05, {}), 6);
  EXPECT_EQ(kept(Side::above, 1.05, {"length", 1}), 6);
  EXPECT_EQ(kept(Side::above, 1.05, {"length", 2}), 3);
  EXPECT_EQ(kept(Side::below, 1.35, {"length", 1}), 6);
  EXPECT_EQ(kept(Side::below, 1.35, {"length", 2}), 3);
}

TEST(KeepOnlyWhere, RefusesNegativeErrors) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = noisy_cube(comm);
  mesh.find_cell_field("length")->real().assign(mesh.cell_to_node.size(), -0.1);
  auto indicator = all_cells(mesh);

  EXPECT_THROW(keep_only_where(comm, mesh, {{"density", Side::above, 1}, {"length", 1}}, indicator), Error);
}

TEST(KeepBelowLevel, TakesTheLevelOfTheBaseCell) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = scattered_cube(comm, 1);
  for (std::size_t i = 0; i < mesh.lineage.size(); ++i)
    mesh.lineage[i] = mesh::Lineage(mesh::FamilyKind::regular, 0, 0, static_cast<int>(mesh.cell_global[i]) % 3);

  auto indicator = all_cells(mesh);
  keep_below_level(mesh, 2, indicator);

  EXPECT_EQ(count_marked(comm, marks_of(indicator)), 4);
}

TEST(Unite, IsTheLargerWish) {
  Indicator indicator{0, 1, 2, 0};

  unite(indicator, Indicator{0, 3, 1, 4});

  EXPECT_EQ(indicator, (Indicator{0, 3, 2, 4}));
  EXPECT_EQ(marks_of(indicator), (std::vector<std::uint8_t>{0, 1, 1, 1}));
}

TEST(Strongest, TakesTheMostWantedWhateverTheRanks) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = scattered_cube(world, 3), whole = scattered_cube(self, 3);
  const auto wish = [](const par::Comm& comm, const mesh::DistMesh& mesh) {
    return beyond_threshold(comm, mesh, {"density", Side::above, 1.3});
  };
  const auto n_wanted = count_marked(self, marks_of(wish(self, whole)));
  ASSERT_GT(n_wanted, 20);

  for (const std::int64_t count : {std::int64_t{0}, std::int64_t{1}, std::int64_t{20}, n_wanted, n_wanted + 5}) {
    const auto marks = gathered(world, shared, strongest(world, shared, wish(world, shared), count));
    EXPECT_EQ(marks, gathered(self, whole, strongest(self, whole, wish(self, whole), count)));
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), std::min(count, n_wanted));
  }
}

TEST(SetMarks, ReplacesTheFieldOfThatName) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = scattered_cube(comm, 1);
  mesh::Field old;
  old.name = "refine";
  old.real().resize(mesh.cell_to_node.size(), 0.5);
  mesh.cell_fields.push_back(old);
  const auto n_fields = mesh.cell_fields.size();

  set_marks(mesh, std::vector<std::uint8_t>(mesh.cell_to_node.size(), 1));

  EXPECT_EQ(mesh.cell_fields.size(), n_fields);
  EXPECT_EQ(mesh.find_cell_field("refine")->integer(), std::vector<std::int64_t>(mesh.cell_to_node.size(), 1));
  EXPECT_EQ(mesh.find_cell_field("refine")->storage, mesh::StorageType::int32);
}

}  // namespace criteria_test
}  // namespace pamr::mark
