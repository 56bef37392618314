// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/mesh3.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "meshing/faces_between_regions.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace mesh3_test {

using geometry::Vec3;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Radius 1, edges of 0.8; `n_pieces` 2: halves above and below the center's height, without a curve between them.
Domain ball(Vec3 center, int n_pieces) {
  Domain domain;
  domain.label = [=](Vec3 p) {
    if (norm(p - center) < 1) return Domain::inside;
    return n_pieces == 2 && p.z > center.z ? 1 : 0;
  };
  domain.size = [](Vec3) { return 0.8; };
  const auto on_ball = [=](Vec3 p) { return center + (1 / norm(p - center)) * (p - center); };
  domain.pieces.resize(static_cast<std::size_t>(n_pieces), {0, on_ball});
  for (const double s : {-1.0, 1.0})
    for (const Vec3 axis : {Vec3{s, 0, 0}, Vec3{0, s, 0}, Vec3{0, 0, s}})
      domain.pieces[0].start.push_back(center + axis);
  domain.patches.push_back({"ball", "patch", -1});
  domain.center = center;
  domain.radius = 1.1;
  return domain;
}

/// A can of radius 1 from z = 0 to 2; the points of its two rims lie on lines along the axis, but for rounding.
Domain can() {
  Domain domain;
  domain.label = [](Vec3 p) {
    const double side = std::hypot(p.x, p.y) - 1, above = p.z - 2, below = -p.z;
    if (side < 0 && above < 0 && below < 0) return Domain::inside;
    return above >= std::max(side, below) ? 1 : below >= side ? 2 : 0;
  };
  domain.size = [](Vec3) { return 0.5; };
  for (int piece = 0; piece < 3; ++piece) {
    domain.pieces.push_back({piece, [](Vec3 p) { return p; }});
    domain.patches.push_back({"face", "patch", -1});
  }
  for (const double z : {0.0, 2.0}) {
    std::vector<Vec3> rim;
    constexpr int n = 200;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      rim.push_back(z == 0 ? Vec3{std::cos(angle), std::sin(angle), z}
                           : Vec3{std::sin(angle + std::numbers::pi / 2), -std::cos(angle + std::numbers::pi / 2), z});
    }
    rim.push_back(rim.front());
    domain.curves.push_back({rim, [](Vec3 p) { return p; }});
  }
  domain.center = {0, 0, 1};
  domain.radius = 1.05 * std::sqrt(2.0);
  return domain;
}

/// The ball of radius 1 with one of radius 0.5 about the same middle as a region of its own.
Domain ball_in_ball() {
  auto domain = ball({0, 0, 0}, 1);
  domain.label = [](Vec3 p) { return norm(p) < 0.5 ? Domain::in_region(1) : norm(p) < 1 ? Domain::in_region(0) : 0; };
  domain.size = [](Vec3) { return 0.35; };
  domain.regions = {{"shell", 0}, {"core", 0}};
  domain.pieces.push_back({1, [](Vec3 p) { return (0.5 / norm(p)) * p; }});
  domain.pieces.back().region = {0, 1};
  for (const Vec3 p : domain.pieces[0].start) domain.pieces.back().start.push_back(0.5 * p);
  domain.patches.push_back({"shell_core", "patch", -1});
  return domain;
}

TEST(RunMesh3, MeshesRegionsThatMeetInFacesOfTheirPiece) {
  const auto mesh = run_mesh3(ball_in_ball(), 1);

  ASSERT_EQ(mesh.region.size(), mesh.cell.size());
  std::array<double, 2> volume{};
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    volume[static_cast<std::size_t>(mesh.region[c])] += geometry::volume(mesh.points(c));
  const double core = std::numbers::pi / 6;
  EXPECT_NEAR(volume[1] / core, 0.85, 0.12);
  EXPECT_NEAR(volume[0] / (8 * core - core), 0.95, 0.05);
  EXPECT_GT(mesh.between.size(), 20U);
  std::map<std::pair<std::int32_t, std::int32_t>, int> n_faces;
  for (const auto& face : mesh.between) {
    EXPECT_EQ(face.piece, 1);
    EXPECT_EQ(mesh.region[static_cast<std::size_t>(face.cell)], 0);
    const auto corner = corners_of(mesh, face);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(norm(mesh.position(corner[i])), 0.5, 1e-5);
      ++n_faces[std::minmax(corner[i], corner[(i + 1) % 3])];
    }
  }
  for (const auto& [edge, n] : n_faces) EXPECT_EQ(n, 2);  // closed
  for (const auto& face : mesh.face) EXPECT_EQ(face.piece, 0);
}

// CGAL asks at 1e16 and beyond, where sides of surfaces are matters of rounding. One "inside" there, and its bisection
// went on for ever between two neighboring numbers.
TEST(RunMesh3, NothingBeyondTheBallOfTheDomainIsInside) {
  auto domain = can();
  double farthest = 0;
  domain.label = [&farthest, label = domain.label, center = domain.center, radius = domain.radius](Vec3 p) {
    farthest = std::max(farthest, norm(p - center));
    return norm(p - center) > 2 * radius ? Domain::inside : label(p);
  };

  const auto mesh = run_mesh3(domain, 1);

  EXPECT_GT(mesh.cell.size(), 200U);
  EXPECT_LE(farthest, domain.radius);
}

TEST(RunMesh3, RefusesWhatHasMoreNodesThanTheSizesExplain) {
  const auto domain = ball({0, 0, 0}, 2);
  std::vector<std::int64_t> reported;
  Mesh3Watch watch;
  watch.spare_nodes = 500;
  watch.progress = [&](std::int64_t nodes, std::int64_t expected) {
    reported.push_back(nodes);
    EXPECT_NEAR(static_cast<double>(expected), 4 * std::numbers::pi / (0.866 * 0.8 * 0.8), 1);  // inside there are 16
  };

  EXPECT_THAT([&] { run_mesh3(domain, 1, watch); }, ThrowsMessage<Error>(HasSubstr("found no end: 2")));

  EXPECT_THAT(reported, ::testing::ElementsAre(1000, 1250, 1562, 1952, 2440));
}

TEST(RunMesh3, ExpectsTheNodesOfABodyThatItsGridDoesNotMeet) {
  auto domain = ball({0, 0, 0}, 2);
  domain.boundary_nodes = 1234;
  std::int64_t announced = 0;
  Mesh3Watch watch;
  watch.progress = [&](std::int64_t, std::int64_t expected) {
    announced = expected;
    throw Error("enough");
  };

  EXPECT_THAT([&] { run_mesh3(domain, 1, watch); }, ThrowsMessage<Error>(HasSubstr("enough")));

  EXPECT_EQ(announced, 1234);
}

TEST(RunMesh3, SaysWhatTakesLongOnceAndMakesTheSameMesh) {
  const auto domain = can();
  std::vector<std::string> said;
  Mesh3Watch watch;
  watch.slow = [&](const std::string& why) { said.push_back(why); };

  const auto mesh = run_mesh3(domain, 1, watch);
  EXPECT_THAT(said, ::testing::IsEmpty());  // it takes a fraction of a second

  watch.slow_after = 0;
  const auto slow = run_mesh3(domain, 1, watch);
  EXPECT_THAT(said, ::testing::ElementsAre(::testing::AllOf(HasSubstr("s of a processor"), HasSubstr("CGAL asked"))));
  EXPECT_EQ(slow.cell, mesh.cell);
}

// At 1e12 neighboring numbers are farther from each other than the mesher wants to know where the ball begins.
TEST(RunMesh3, RefusesWhatBringsNoNewNode) {
  EXPECT_GT(run_mesh3(ball({1e3, 0, 0}, 1), 1).cell.size(), 20U);
  EXPECT_THAT([] { run_mesh3(ball({1e12, 0, 0}, 1), 1); }, ThrowsMessage<Error>(HasSubstr("far from the origin")));
}

}  // namespace mesh3_test
}  // namespace pamr::meshing
