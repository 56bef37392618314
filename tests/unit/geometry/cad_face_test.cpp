// SPDX-License-Identifier: GPL-3.0-or-later
/// Faces of splines with poles, where a whole side of the parameters is one point. data/egg.step is the ellipsoid with
/// half axes 1, 0.9 and 0.8, whose poles are on the z axis; data/elliptic_cone.step is the solid cone over the ellipse with
/// half axes 1 and 0.8 in z = 0, its apex at z = 1.5.
#include "pamr/geometry/cad/cad_face.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/quadric.hpp"

namespace pamr::geometry {
namespace cad_face_test {

constexpr double off = 1e-10;  // the files have twelve digits
constexpr int directions = 37;

std::shared_ptr<const CadModel> model(const std::string& name) {
  return make_cad_model(read_cad_source(std::string(PAMR_TEST_DATA) + "/" + name), "mm");
}

Vec3 ray(int i) {
  const double turn = 2 * std::acos(-1.0) * i / directions;
  return {std::cos(turn), std::sin(turn), 0};
}

TEST(CadFace, GivesTheNearestPointsAroundThePolesOfAClosedSpline) {
  const auto shape = model("egg.step");
  const auto& face = shape->faces()[0];
  const Quadric egg({1, 1 / 0.81, 1 / 0.64, 0, 0, 0, 0, 0, 0, -1});
  for (const double z : {0.8, -0.8})
    for (double r = 0.3; r > 1e-9; r /= 3)
      for (int i = 0; i < directions; ++i) {
        const Vec3 on = egg.project(Vec3{0, 0, z} + r * ray(i));
        for (const double height : {0.0, r * r, -r * r, 0.1 * r, 0.3, -0.3}) {
          if (std::abs(height) > 1e4 * r) continue;  // rounding decides on the direction
          const auto foot = face.project(on + height * egg.normal(on));
          EXPECT_LT(norm(foot.point - on), off) << "r " << r << ", direction " << i << ", height " << height;
          EXPECT_NEAR(foot.distance, std::abs(height), off);
        }
      }
  for (const double z : {0.8, -0.8}) EXPECT_LT(norm(face.project({0, 0, 1.1 * z}).point - Vec3{0, 0, z}), off);
}

TEST(CadFace, GivesTheNearestPointsAroundTheApexOfASplineCone) {
  const auto shape = model("elliptic_cone.step");
  const Vec3 apex{0, 0, 1.5};
  const CadFace* side = nullptr;
  for (const auto& face : shape->faces())
    if (!face.data().pole.empty()) side = &face;
  ASSERT_NE(side, nullptr);
  for (double r = 0.5; r > 1e-7; r /= 3)
    for (int i = 0; i < directions; ++i) {
      const Vec3 ahead = ray(i), on = apex + r * Vec3{ahead.x, 0.8 * ahead.y, -1.5};
      const Vec3 gradient{ahead.x, ahead.y / 0.8, 1 / 1.5};
      const Vec3 normal = (1 / norm(gradient)) * gradient;
      for (const double height : {0.0, r * r, 0.1 * r, -0.1 * r, r, 10 * r}) {
        const auto foot = side->project(on + height * normal);
        EXPECT_LT(norm(foot.point - on), off) << "r " << r << ", direction " << i << ", height " << height;
        EXPECT_NEAR(foot.distance, std::abs(height), off);
      }
    }
  for (int i = 0; i < directions; ++i) {
    EXPECT_LT(norm(side->project(apex + 0.1 * ray(i) + Vec3{0, 0, 0.3}).point - apex), off);
    EXPECT_LT(norm(side->project(apex + 1e-6 * ray(i) + Vec3{0, 0, 3e-6}).point - apex), off);
  }
}

TEST(CadFace, SamplesOfAFaceWithPolesLieNearIt) {
  const auto shape = model("egg.step");
  const auto& face = shape->faces()[0];
  EXPECT_LT(face.deflection(), 0.05) << "of triangles that turn by at most 0.2";
  const Quadric egg({1, 1 / 0.81, 1 / 0.64, 0, 0, 0, 0, 0, 0, -1});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(-1.2, 1.2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p{part(random), part(random), part(random)};
    if (norm(p) < 0.4) continue;  // there is more than one nearest point about
    EXPECT_LT(norm(face.project(p).point - egg.project(p)), off) << p.x << " " << p.y << " " << p.z;
  }
}

}  // namespace cad_face_test
}  // namespace pamr::geometry
