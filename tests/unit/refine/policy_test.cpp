// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/policy.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pamr::refine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
  mesh.lineage = {mesh::Lineage(pattern.kind, pattern.index, child, 0)};
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
      for (int m = 0; m < 64; ++m) result[at(m)] = required_marks(mesh, 0, static_cast<EdgeMask>(m), policy);
      for (int a = 0; a < 64; ++a) {
        EXPECT_EQ(result[at(a)] & a, a);
        EXPECT_GE(state_of_mask[result[at(a)]], 0);
        EXPECT_EQ(result[result[at(a)]], result[at(a)]);
        for (int b = 0; b < 64; ++b)
          if ((a & b) == a) {
            EXPECT_EQ(result[at(a)] & result[at(b)], result[at(a)]);
          }
      }
    }
  });
}

TEST(ClosesBadly, IsMonotoneAndTurnsPoorClosuresOnly) {
  std::mt19937 random(11);
  int n_bad = 0;
  for (int sample = 0; sample < 500; ++sample) {
    auto mesh = one_child(0, 0, random);
    mesh.node_position[0] = mesh.node_position[0] + geometry::Vec3{0.004 * (sample % 100), 0, 0};
    if (geometry::volume(mesh.points(0)) <= 0) continue;
    std::array<EdgeMask, 64> result{};
    for (int m = 0; m < 64; ++m)
      result[at(m)] = required_marks(mesh, 0, static_cast<EdgeMask>(m), QualityControl::removable);
    for (int a = 0; a < 64; ++a) {
      const bool turned = result[at(a)] != legal_mask[at(a)];
      n_bad += turned ? 1 : 0;
      EXPECT_TRUE(!turned || result[at(a)] == all_edges);
      EXPECT_TRUE(!turned || geometry::mean_ratio(mesh.points(0)) < 0.78);
      for (int b = 0; b < 64; ++b) {
        if ((a & b) == a) {
          EXPECT_EQ(result[at(a)] & result[at(b)], result[at(a)]);
        }
      }
    }
  }
  EXPECT_GT(n_bad, 100);
}

TEST(RequiredMarks, SplitAHitClosureCellIntoEightWhenIsotropic) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    for (int m = 1; m < 64; ++m)
      EXPECT_EQ(required_marks(mesh, 0, static_cast<EdgeMask>(m), QualityControl::isotropic), all_edges);
    EXPECT_EQ(required_marks(mesh, 0, 0, QualityControl::isotropic), 0);
  });
}

TEST(RequiredMarks, TakeAFaceWithAMarkOnAShortEdge) {
  for_every_closure_cell([](const mesh::DistMesh& mesh) {
    int n_short = 0;
    for (int e = 0; e < 6; ++e) {
      const auto face = face_implied_by_short_edge(mesh, 0, e);
      const auto marks = required_marks(mesh, 0, static_cast<EdgeMask>(1 << e), QualityControl::short_edge);
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

}  // namespace
}  // namespace pamr::refine
