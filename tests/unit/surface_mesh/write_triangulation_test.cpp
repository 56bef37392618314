// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/write_triangulation.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "support/triangulations.hpp"

namespace pamr::geometry {
namespace write_triangulation_test {

Triangulation odd_ball() {
  auto ball = testing::icosphere(2);
  for (auto& p : ball.points) p = (1.0 / 3) * p + Vec3{0.1, -1e6, 1e-7};
  return ball;
}

TEST(WriteTriangulation, KeepsEveryBit) {
  const auto ball = odd_ball();

  for (const std::string file : {"a.obj", "a.ply", "a.off"})
    EXPECT_EQ(parse_triangulation(to_bytes(ball, surface_format_of(file)), file), ball) << file;
  const auto stl = parse_triangulation(to_bytes(ball, SurfaceFormat::stl), "a.stl");
  ASSERT_EQ(stl.triangles.size(), ball.triangles.size());
  for (std::size_t t = 0; t < ball.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(stl.points[static_cast<std::size_t>(stl.triangles[t][k])],
                ball.points[static_cast<std::size_t>(ball.triangles[t][k])]);
}

TEST(WriteTriangulation, RoundsBytesOfStlOnly) {
  const auto ball = testing::icosphere(1);

  const auto bytes = to_bytes(ball, SurfaceFormat::stl_single);

  EXPECT_EQ(bytes.size(), 84 + 50 * ball.triangles.size());
  const auto read = parse_triangulation(bytes, "a.stl");
  for (const auto p : read.points) EXPECT_NEAR(norm(p), 1, 1e-7);
}

TEST(WriteTriangulation, KnowsItsEndings) {
  EXPECT_EQ(surface_format_of("b.STL"), SurfaceFormat::stl);
  EXPECT_THROW(surface_format_of("b.step"), Error);
}

TEST(ReadSoup, TakesWhatIsNoSurface) {
  const auto soup = parse_soup("OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n5 5 5\n3 0 1 2\n3 0 0 1\n", "a.off");

  EXPECT_EQ(soup.points.size(), 4U);
  EXPECT_EQ(soup.triangles.size(), 2U);
  EXPECT_THROW(parse_soup("OFF\n1 0 0\n1e101 0 0\n", "a.off"), Error);
  EXPECT_THROW(parse_soup("OFF\n1 1 0\n0 0 0\n3 0 1 2\n", "a.off"), Error);
}

}  // namespace write_triangulation_test
}  // namespace pamr::geometry
