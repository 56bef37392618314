// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_edge.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace pamr::geometry {
namespace cad_edge_test {

/// The x axis, with its coordinate as parameter.
class Axis : public ParametricCurve {
 public:
  CurveJet at(double t) const override { return {{t, 0, 0}, {1, 0, 0}, {}}; }
};

// Files state where edges end to a tolerance only: here the other edges at the last vertex end 3e-8 beside this one.
TEST(CadEdge, EndsWhereTheOtherEdgesOfItsVertexDo) {
  CadEdge edge({std::make_shared<const Axis>(), 0, 1, 1e-7, {0, 1}}, 1e-3, 1);
  const Vec3 corner{1, 3e-8, 0};
  EXPECT_GT(edge.nearest(corner).squared_distance, 0);

  edge.join(1, corner);

  const auto foot = edge.nearest(corner);
  EXPECT_EQ(foot.squared_distance, 0);
  EXPECT_EQ(foot.t, 1);
  EXPECT_EQ(foot.point, corner);
  EXPECT_EQ(edge.point(1), corner);
  EXPECT_EQ(edge.points().back(), corner);
  EXPECT_LE(edge.distance_at_least(corner), 0);
  EXPECT_EQ(edge.nearest({1.5, 0, 0}).point, corner);
  EXPECT_EQ(edge.nearest({0.5, 1, 0}).point, (Vec3{0.5, 0, 0}));
  EXPECT_EQ(edge.nearest({-1, 0, 0}).point, (Vec3{0, 0, 0}));
}

}  // namespace cad_edge_test
}  // namespace pamr::geometry
