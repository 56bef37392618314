// SPDX-License-Identifier: GPL-3.0-or-later
/// The faces of data/spool.step: a cylinder of radius 2 and height 3 about the z axis, its foot rounded by a torus of
/// radius 0.5, a cone of height 1.5 on its top, one side cut off by a ruled spline surface. Face 1 is the cylinder, 2
/// the torus, 3 the ledge below the spline face 4, 5 the top, 6 the foot, 7 the cone.
#include "pamr/geometry/cad/cad_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {
namespace cad_surface_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr int cylinder = 0, torus = 1, ledge = 2, spline = 3, top = 4, foot = 5, cone = 6;

CadSource spool() { return read_cad_source(std::string(PAMR_TEST_DATA) + "/spool.step"); }

std::shared_ptr<const CadModel> model() {
  static const auto made = make_cad_model(spool(), "mm");
  return made;
}

std::unique_ptr<const CadSurface> faces(std::vector<int> numbers) {
  return std::make_unique<const CadSurface>(model(), std::move(numbers));
}

/// Points on the triangles that sample a face, moved by up to `off` along each axis.
std::vector<Vec3> points_near(int face, int n, double off) {
  const auto& f = model()->faces()[static_cast<std::size_t>(face)];
  std::mt19937 random(static_cast<unsigned>(face + 1));
  std::uniform_real_distribution<double> part(0, 1), away(-off, off);
  std::uniform_int_distribution<std::size_t> which(0, f.data().triangle.size() - 1);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const auto& t = f.data().triangle[which(random)];
    double a = part(random), b = part(random);
    if (a + b > 1) std::tie(a, b) = std::pair(1 - a, 1 - b);
    const auto corner = [&](std::size_t k) { return f.points()[static_cast<std::size_t>(t[k])]; };
    const Vec3 on = (1 - a - b) * corner(0) + a * corner(1) + b * corner(2);
    points.push_back(on + Vec3{away(random), away(random), away(random)});
  }
  return points;
}

double from_axis(Vec3 p) { return std::hypot(p.x, p.y); }

TEST(CadSurface, PointsLieOnTheShapesThatTheFileStates) {
  for (const auto p : points_near(cylinder, 1000, 0.1)) {
    const auto q = faces({cylinder})->project(p);
    if (q.x > 1.2) continue;  // it may be a point of a border that is a spline
    EXPECT_NEAR(from_axis(q), 2, 1e-14);
  }
  for (const auto p : points_near(torus, 1000, 0.1)) {
    const auto q = faces({torus})->project(p);
    EXPECT_NEAR(std::hypot(from_axis(q) - 1.5, q.z - 0.5), 0.5, 1e-14);
  }
  for (const auto p : points_near(cone, 1000, 0.1)) {
    const auto q = faces({cone})->project(p);
    EXPECT_NEAR(from_axis(q), (4.5 - q.z) / 1.5, 1e-12);
  }
  for (const auto p : points_near(top, 1000, 0.1)) EXPECT_EQ(faces({top})->project(p).z, 3);
}

TEST(CadSurface, FacesEndAtTheirBorders) {
  const auto top_of_torus = faces({torus})->project({0, 2.1, 0.9});
  EXPECT_NEAR(top_of_torus.y, 2, 1e-12);
  EXPECT_NEAR(top_of_torus.z, 0.5, 1e-12);
  const auto rim = faces({foot})->project({-3, 0, 0.2});
  EXPECT_NEAR(rim.x, -1.5, 1e-12);
  const auto ring = faces({top})->project({0, 0.2, 3.1});  // the cone stands there
  EXPECT_NEAR(ring.y, 1, 1e-12);
  EXPECT_NEAR(ring.z, 3, 1e-12);
  EXPECT_NEAR(faces({top})->project({0, 1.2, 3.1}).y, 1.2, 1e-15);
}

TEST(CadSurface, TheApexIsTheNearestPointAboveAndBesideIt) {
  for (const auto p : {Vec3{0, 0, 5}, Vec3{0.1, -0.1, 4.8}, Vec3{0, 0, 4.5}})
    EXPECT_LT(norm(faces({cone})->project(p) - Vec3{0, 0, 4.5}), 1e-12);
  const auto normal = faces({cone})->normal({0, 0, 5});
  EXPECT_NEAR(norm(normal), 1, 1e-12);
  EXPECT_GT(normal.z, 0.5);
}

TEST(CadSurface, SeamsAreNoBorders) {
  for (int i = 0; i < 360; ++i) {  // somewhere is the seam of the cylinder
    const double turn = i * std::acos(-1.0) / 180;
    const Vec3 p{2.1 * std::cos(turn), 2.1 * std::sin(turn), 0.75};
    EXPECT_NEAR(norm(p - faces({cylinder})->project(p)), 0.1, 1e-13) << i;
  }
}

TEST(CadSurface, ProjectingTwiceChangesNothing) {
  for (int f = 0; f < 7; ++f)
    for (const auto p : points_near(f, 500, 0.2)) {
      const auto once = faces({f})->project(p);
      EXPECT_LT(norm(faces({f})->project(once) - once), 2e-15 * 8) << f;
      EXPECT_LT(faces({f})->distance(once), 2e-15 * 8) << f;
    }
}

TEST(CadSurface, NoSampleIsNearerThanTheNearestPoint) {
  std::vector<int> all;
  for (int f = 0; f < 7; ++f) all.push_back(f);
  const auto whole = faces(all);
  for (int f = 0; f < 7; ++f) {
    const auto alone = faces({f});
    for (const auto p : points_near(f, 100, 0.5)) {
      const double distance = alone->distance(p), of_whole = whole->distance(p);
      EXPECT_LE(of_whole, distance + 1e-14);
      for (const auto sample : model()->faces()[static_cast<std::size_t>(f)].points())
        ASSERT_GE(norm(sample - p), distance - 1e-9) << f;
    }
  }
}

TEST(CadSurface, TheOrderOfQuestionsDoesNotMatter) {
  const auto surface = faces({spline});
  const auto points = points_near(spline, 100000, 0.1);
  std::vector<Vec3> forth(points.size()), back(points.size());

  for (std::size_t i = 0; i < points.size(); ++i) forth[i] = surface->project(points[i]);
  for (std::size_t i = points.size(); i-- > 0;) back[i] = surface->project(points[i]);

  EXPECT_EQ(forth, back);  // bits: none of these numbers is -0 or no number
}

TEST(CadSurface, ReadingAnewGivesTheSameBits) {
  const auto again = make_cad_model(spool(), "mm");
  for (int f = 0; f < 7; ++f) {
    const CadSurface other(again, {f});
    for (const auto p : points_near(f, 200, 0.2)) EXPECT_EQ(other.project(p), faces({f})->project(p));
  }
}

TEST(CadSurface, NormalsPointOutOfTheBody) {
  double volume = 0, area = 0;  // of the sampling triangles, by the normals of the faces
  for (int f = 0; f < 7; ++f) {
    const auto& face = model()->faces()[static_cast<std::size_t>(f)];
    for (const auto& t : face.data().triangle) {
      const auto corner = [&](std::size_t k) { return face.points()[static_cast<std::size_t>(t[k])]; };
      const Vec3 middle = (1.0 / 3) * (corner(0) + corner(1) + corner(2));
      const double of_triangle = 0.5 * norm(cross(corner(1) - corner(0), corner(2) - corner(0)));
      area += of_triangle;
      volume += of_triangle * dot(middle, faces({f})->normal(middle)) / 3;
    }
  }
  const auto exact = measure_cad_source(spool(), "mm");
  double exact_area = 0;
  for (const double of_face : exact.area) exact_area += of_face;
  EXPECT_NEAR(volume, exact.volume, 0.01 * exact.volume);
  EXPECT_NEAR(area, exact_area, 0.01 * exact_area);
  EXPECT_NEAR(exact.area[cone], std::acos(-1.0) * std::sqrt(1 + 1.5 * 1.5), 1e-7);
}

TEST(CadSurface, ANodeOnTwoFacesGoesOntoTheirEdge) {
  const auto of_top = faces({top}), of_cone = faces({cone}), of_cylinder = faces({cylinder}), of_torus = faces({torus});
  const std::array<const Surface*, 2> rim{of_top.get(), of_cone.get()}, tangent{of_cylinder.get(), of_torus.get()};
  const double turn = 0.3, half = 0.2;
  const auto chord_middle = [&](double radius, double z) {
    return std::cos(half) * radius * Vec3{-std::cos(turn), std::sin(turn), 0} + Vec3{0, 0, z};
  };
  const auto on_rim = project_onto_all(rim, chord_middle(1, 3));
  const auto on_tangent = project_onto_all(tangent, chord_middle(2, 0.5));  // the faces have one tangent plane there

  EXPECT_TRUE(on_rim.converged && on_tangent.converged);
  EXPECT_LT(norm(on_rim.point - Vec3{-std::cos(turn), std::sin(turn), 3}), 1e-12);
  EXPECT_LT(norm(on_tangent.point - Vec3{-2 * std::cos(turn), 2 * std::sin(turn), 0.5}), 1e-12);
  EXPECT_LT(distance_from_all(rim, on_rim.point), 1e-14);
}

TEST(CadSurface, ANodeOnThreeFacesGoesIntoTheirCorner) {
  const auto of_top = faces({top}), of_spline = faces({spline}), of_cylinder = faces({cylinder});
  const std::array<const Surface*, 3> all{of_top.get(), of_spline.get(), of_cylinder.get()};
  const Vec3 start{1.5, 1.3, 2.9};
  const auto corner = project_onto_all(all, start);
  EXPECT_TRUE(corner.converged);
  EXPECT_NEAR(from_axis(corner.point), 2, 1e-7);
  EXPECT_NEAR(corner.point.z, 3, 1e-7);
  EXPECT_LT(of_spline->distance(corner.point), 1e-7);
}

TEST(CadSurface, EdgesBetweenItsFacesAreCreases) {
  const auto both = faces({cylinder, top});
  ASSERT_NE(both->creases(), nullptr);
  EXPECT_EQ(faces({cylinder})->creases(), nullptr);
  const auto at = [](double turn, double radius, double z) {
    return Vec3{-radius * std::cos(turn), radius * std::sin(turn), z};
  };
  const Vec3 a = at(-0.2, 2, 3), b = at(0.2, 2, 3), on_side = at(0, 2, 2.5), on_top = at(0, 1.5, 3);

  const auto middle = both->creases()->crease_between(a, b, on_side, on_top);
  ASSERT_TRUE(middle);
  EXPECT_LT(norm(*middle - at(0, 2, 3)), 1e-12);
  EXPECT_EQ(*both->creases()->crease_between(b, a, on_top, on_side), *middle);
  EXPECT_FALSE(both->creases()->crease_between(a, b, on_top, at(0.05, 1.6, 3)));  // it runs across the top
  EXPECT_FALSE(both->creases()->crease_between(a, on_side, b, at(-0.3, 2, 2.5)));
}

TEST(CadSurface, OnlyAPlaneAloneIsFlat) {
  EXPECT_TRUE(faces({top})->is_flat());
  EXPECT_FALSE(faces({cylinder})->is_flat());
  EXPECT_FALSE((faces({top, foot})->is_flat()));
}

TEST(CadSurface, FindsTheFacesAtAPoint) {
  EXPECT_THAT(model()->faces_near({0, 0, 4.5}, 1e-9), ElementsAre(cone));
  EXPECT_THAT(model()->faces_near({-2, 0, 3}, 1e-6), ElementsAre(cylinder, top));
  EXPECT_THAT(model()->faces_near({0, 0, 1}, 1e-6), IsEmpty());
  EXPECT_EQ(model()->n_open_edges(), 0);
}

TEST(CadSurface, RefusesFacesThatAreNone) {
  EXPECT_THAT([] { faces({}); }, ThrowsMessage<Error>(HasSubstr("faces: expected one or more, found none")));
  EXPECT_THAT([] { faces({7}); }, ThrowsMessage<Error>(HasSubstr("faces: expected numbers from 1 to 7, found 8")));
  EXPECT_THAT([] { faces({1, 1}); }, ThrowsMessage<Error>(HasSubstr("found 2 twice")));
}

}  // namespace cad_surface_test
}  // namespace pamr::geometry
