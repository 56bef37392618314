// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/policy.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pamr/refine/cell_shape.hpp"

namespace pamr::refine {
namespace policy_test {

/// One closure cell of each kind, from a parent with random corners.
mesh::DistMesh one_child(int state, int child, std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  std::array<geometry::Vec3, 10> p{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int i = 0; i < 4; ++i) p[at(i)] = p[at(i)] + geometry::Vec3{jitter(random), jitter(random), jitter(random)};
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
    p[at(4 + e)] = geometry::midpoint(p[at(a)], p[at(b)]);
  }
  mesh::DistMesh mesh;
  const auto& pattern = split_pattern[at(state)];
  for (const auto code : pattern.child_to_node[at(child)]) mesh.node_position.push_back(p[at(code)]);
  mesh.cell_to_node = {{0, 1, 2, 3}};
  mesh.cell_to_cell = {{-1, -1, -1, -1}};
  const auto base = mesh::Lineage::regular(0);
  mesh.lineage = {state == 0 ? base : base.closed(state, child)};
  return mesh;
}

template <class Check>
void for_every_closure_cell(Check&& check) {
  std::mt19937 random(7);
  for (int state = 1; state <= 10; ++state)
    for (int child = 0; child < split_pattern[at(state)].n_children; ++child)
      for (int sample = 0; sample < 5; ++sample) check(one_child(state, child, random));
}

TEST(RequiredMarks, AreLegalAndMonotoneForEveryPolicyMaskAndClosureCell) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    for (const auto policy : {QualityControl::none, QualityControl::isotropic, QualityControl::short_edge}) {
      std::array<EdgeMask, 64> result{};
      for (int m = 0; m < 64; ++m)
        result[at(m)] = required_marks(mesh, mesh::Level0View(mesh), 0, static_cast<EdgeMask>(m),
                                       {.quality_control = policy, .marks_field = {}});
      for (int a = 0; a < 64; ++a) {
        EXPECT_EQ(result[at(a)] & a, a);
        EXPECT_GE(state_of_template[result[at(a)]], 0);
        EXPECT_EQ(result[result[at(a)]], result[at(a)]);
        for (int b = 0; b < 64; ++b)
          if ((a & b) == a) {
            EXPECT_EQ(result[at(a)] & result[at(b)], result[at(a)]);
          }
      }
    }
  });
}

TEST(RequiredMarks, OfRegularCellsUnderRemovableFollowTheShapeFloor) {
  std::mt19937 random(11);
  for (int sample = 0; sample < 20; ++sample) {
    const auto mesh = one_child(0, 0, random);
    for (const double floor : {0.0, 0.35, 0.5})
      for (int m = 0; m < 64; ++m) {
        const auto marks = static_cast<EdgeMask>(m);
        EXPECT_EQ(required_marks(mesh, mesh::Level0View(mesh), 0, marks, {.shape_floor = floor, .marks_field = {}}),
                  CellShape(mesh.points(0)).closed_marks(marks, floor));
      }
  }
}

TEST(RequiredMarks, OfClosureCellsWithoutFamilyUnderRemovableAreTheMarksAlone) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    for (int m = 0; m < 64; ++m)
      EXPECT_EQ(required_marks(mesh, mesh::Level0View(mesh), 0, static_cast<EdgeMask>(m),
                               {.shape_floor = 0.5, .marks_field = {}}),
                m);
  });
}

TEST(RequiredMarks, SplitAMarkedClosureCellIntoEightWhenIsotropic) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    for (int m = 1; m < 64; ++m)
      EXPECT_EQ(required_marks(mesh, mesh::Level0View(mesh), 0, static_cast<EdgeMask>(m),
                               {.quality_control = QualityControl::isotropic, .marks_field = {}}),
                all_edges);
    EXPECT_EQ(required_marks(mesh, mesh::Level0View(mesh), 0, 0,
                             {.quality_control = QualityControl::isotropic, .marks_field = {}}),
              0);
  });
}

TEST(RequiredMarks, TakeAFaceWithAMarkOnAShortEdge) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    int n_short = 0;
    for (int e = 0; e < 6; ++e) {
      const auto face = face_implied_by_short_edge(mesh, 0, e);
      const auto marks = required_marks(mesh, mesh::Level0View(mesh), 0, static_cast<EdgeMask>(1 << e),
                                        {.quality_control = QualityControl::short_edge, .marks_field = {}});
      if (face == 0) {
        EXPECT_EQ(marks, 1 << e);
        continue;
      }
      ++n_short;
      EXPECT_NE(face & (1 << e), 0);
      EXPECT_EQ(marks & face, face);
    }
    const auto lineage = mesh.lineage[0];
    EXPECT_EQ(n_short, lineage.kind() == mesh::FamilyKind::edge ? 1 : lineage.child() == 3 ? 0 : 2);
  });
}

}  // namespace policy_test
}  // namespace pamr::refine
