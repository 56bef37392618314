// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/revolution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"

namespace pamr::geometry {
namespace revolution_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double pi = std::numbers::pi;
constexpr Vec3 origin{0, 0, 0}, x_axis{1, 0, 0};

ProfilePiece line(Meridian from, Meridian to) { return {from, to, {}}; }
ProfilePiece arc(Meridian from, Meridian to, Meridian center, std::optional<bool> clockwise = {}) {
  return {from, to, ProfileArc{center, clockwise}};
}

/// Area and volume of a profile by Gauss' rule on many short frustums, as an independent value.
struct Measure {
  double area = 0, volume = 0;
};
template <class Curve>  // parameter in [0, 1] -> Meridian
Measure measure(Curve curve, int n) {
  Measure sum;
  for (int i = 0; i < n; ++i) {
    const Meridian a = curve(double(i) / n), b = curve(double(i + 1) / n);
    sum.area += pi * (a.r + b.r) * norm(b - a);
    sum.volume += pi / 3 * (b.x - a.x) * (a.r * a.r + a.r * b.r + b.r * b.r);
  }
  return sum;
}

TEST(Revolution, KeepsNodesOnTheCornersOfItsProfile) {
  const Revolution can(origin, x_axis, {line({-1, 0}, {-1, 2}), line({-1, 2}, {1, 2}), line({1, 2}, {1, 0})});
  const Vec3 a{1, 2, 0}, b{1, 2 * std::cos(0.3), 2 * std::sin(0.3)}, on_side{0.5, 2, 0.3}, on_end{1, 1.4, 0.2};

  const auto middle = can.crease_between(a, b, on_side, on_end);

  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(norm(*middle - Vec3{1, 2 * std::cos(0.15), 2 * std::sin(0.15)}), 0, 1e-15);
  EXPECT_EQ(middle, can.crease_between(b, a, on_end, on_side));
  EXPECT_FALSE(can.crease_between(a, b, {0.4, 2, 0.4}, on_side).has_value()) << "both triangles on the side";
  EXPECT_FALSE(can.crease_between(a, {0.9, 2, 0}, on_side, on_end).has_value()) << "an end beside the corner";
  const Revolution smooth(origin, x_axis, {line({-1, 1}, {0, 1}), arc({0, 1}, {1, 0}, {0, 0})});
  EXPECT_EQ(smooth.creases(), nullptr);
  EXPECT_EQ(can.creases(), &can);
  const Revolution ring(origin, x_axis,
                        {line({0, 1}, {0, 2}), line({0, 2}, {1, 2}), line({1, 2}, {1, 1}), line({1, 1}, {0, 1})});
  EXPECT_TRUE(
      ring.crease_between({0, 1, 0}, {0, std::cos(0.2), std::sin(0.2)}, {0, 1.2, 0.1}, {0.2, 1, 0.1}).has_value());
}

TEST(Revolution, MeasuresASphereAConeACylinderAndATorus) {
  const Revolution sphere({3, 4, 5}, {1, 2, 2}, {arc({-2, 0}, {2, 0}, {0, 0}, true)});
  EXPECT_NEAR(sphere.area(), 4 * pi * 4, 1e-13);
  EXPECT_NEAR(sphere.volume(), 4.0 / 3.0 * pi * 8, 1e-13);

  const Revolution cone(origin, x_axis, {line({0, 0}, {4, 3}), line({4, 3}, {4, 0})});
  EXPECT_NEAR(cone.area(), pi * 3 * 5 + pi * 9, 1e-13);
  EXPECT_NEAR(cone.volume(), pi * 9 * 4 / 3, 1e-13);

  const Revolution can(origin, x_axis, {line({-1, 0}, {-1, 2}), line({-1, 2}, {5, 2}), line({5, 2}, {5, 0})});
  EXPECT_NEAR(can.area(), 2 * pi * 4 + 2 * pi * 2 * 6, 1e-13);
  EXPECT_NEAR(can.volume(), pi * 4 * 6, 1e-13);

  const Revolution torus(origin, x_axis, {arc({-1, 3}, {1, 3}, {0, 3}, true), arc({1, 3}, {-1, 3}, {0, 3}, true)});
  EXPECT_NEAR(torus.area(), 4 * pi * pi * 3, 1e-12);
  EXPECT_NEAR(torus.volume(), 2 * pi * pi * 3, 1e-12);
}

TEST(Revolution, MeasuresAnyArcAsTheLimitOfFrustums) {
  for (const bool clockwise : {true, false}) {
    const Meridian center{0.4, 2.0};
    const double radius = 0.7, start = 2.4, end = clockwise ? -0.3 : -0.3 + 2 * pi;
    const auto curve = [&](double t) {
      const double angle = start + t * (end - start);
      return center + radius * Meridian{std::cos(angle), std::sin(angle)};
    };
    const Revolution surface(origin, x_axis, {arc(curve(0), curve(1), center, clockwise)});

    // The error of the chords falls with the square of their number: 2000 and 4000 give the limit by extrapolation.
    const Measure coarse = measure(curve, 2000), fine = measure(curve, 4000);
    EXPECT_NEAR(surface.area(), fine.area + (fine.area - coarse.area) / 3, 1e-10);
    EXPECT_NEAR(surface.volume(), fine.volume + (fine.volume - coarse.volume) / 3, 1e-10);
  }
}

TEST(Revolution, MeasuresBothWaysWithOppositeVolumes) {
  const Revolution there(origin, x_axis, {line({0, 1}, {1, 2}), arc({1, 2}, {2, 1}, {1, 1})});
  const Revolution back(origin, x_axis, {arc({2, 1}, {1, 2}, {1, 1}), line({1, 2}, {0, 1})});

  EXPECT_NEAR(there.area(), back.area(), 1e-13);
  EXPECT_NEAR(there.volume(), -back.volume(), 1e-13);
  EXPECT_GT(there.volume(), 0);
}

TEST(Revolution, PointsItsNormalToTheLeftOfTheProfile) {
  const Revolution out(origin, x_axis, {arc({-1, 0}, {1, 0}, {0, 0}, true)});
  const Revolution in(origin, x_axis, {arc({1, 0}, {-1, 0}, {0, 0}, false)});
  const Revolution tube(origin, x_axis, {line({0, 1}, {2, 1})});

  EXPECT_LT(norm(out.normal({0, 3, 0}) - Vec3{0, 1, 0}), 1e-15);
  EXPECT_LT(norm(in.normal({0, 3, 0}) - Vec3{0, -1, 0}), 1e-15);
  EXPECT_LT(norm(tube.normal({1, 0, 5}) - Vec3{0, 0, 1}), 1e-15);
}

TEST(Revolution, ClipsEachPieceToItsEnds) {
  const Revolution surface(origin, x_axis, {line({0, 1}, {2, 1}), arc({2, 1}, {3, 2}, {2, 2})});

  EXPECT_EQ(surface.project({-1, 3, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(surface.project({1, 3, 0}), (Vec3{1, 1, 0}));
  EXPECT_LT(
      norm(surface.project({2.6, 0.8, 0}) - Vec3{2 + 0.6 / std::hypot(0.6, 1.2), 2 - 1.2 / std::hypot(0.6, 1.2), 0}),
      1e-15);
  EXPECT_EQ(surface.project({2.9, 4, 0}), (Vec3{3, 2, 0}));
}

TEST(Revolution, TakesTheLongWayRoundWhenTold) {
  const double s = std::sqrt(0.5);
  const Meridian a{-s, 3 - s}, b{s, 3 - s}, center{0, 3};
  const Revolution below(origin, x_axis, {arc(a, b, center)});
  const Revolution above(origin, x_axis, {arc(a, b, center, true)});

  EXPECT_LT(norm(below.project({0, 2.5, 0}) - Vec3{0, 2, 0}), 1e-15);
  EXPECT_LT(norm(above.project({0, 3.5, 0}) - Vec3{0, 4, 0}), 1e-15);
  EXPECT_GT(above.distance({0, 2, 0}), 0.5);
  EXPECT_GT(below.distance({0, 4, 0}), 0.5);
}

TEST(Revolution, AgreesWithAPlainSearchOverRandomProfiles) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 40; ++trial) {
    // Three pieces with random ends; the middle one an arc on a random center of the perpendicular bisector.
    std::vector<Meridian> end(4);
    for (Meridian& m : end) m = {2 * unit(random) - 1, 3 + unit(random)};
    const Meridian chord = end[2] - end[1], across{-chord.r, chord.x};
    const Meridian center = end[1] + 0.5 * chord + (2 * unit(random) - 1) * across;
    const bool clockwise = unit(random) < 0.5;
    const Revolution surface(origin, x_axis,
                             {line(end[0], end[1]), arc(end[1], end[2], center, clockwise), line(end[2], end[3])});
    std::vector<Meridian> samples;
    const auto angle_of = [&](Meridian m) { return std::atan2(m.r - center.r, m.x - center.x); };
    double from = angle_of(end[1]), to = angle_of(end[2]);
    if (clockwise && to > from) to -= 2 * pi;
    if (!clockwise && to < from) to += 2 * pi;
    for (int i = 0; i <= 2000; ++i) {
      const double t = i / 2000.0, angle = from + t * (to - from);
      samples.push_back(end[0] + t * (end[1] - end[0]));
      samples.push_back(center + norm(end[1] - center) * Meridian{std::cos(angle), std::sin(angle)});
      samples.push_back(end[2] + t * (end[3] - end[2]));
    }
    for (int k = 0; k < 50; ++k) {
      const Meridian p{4 * unit(random) - 2, 2 + 3 * unit(random)};
      double least = std::numeric_limits<double>::infinity();
      for (const Meridian q : samples) least = std::min(least, norm(p - q));

      const double turn = 2 * pi * unit(random);
      const double distance = surface.distance({p.x, p.r * std::cos(turn), p.r * std::sin(turn)});
      ASSERT_LE(distance, least + 1e-14);
      ASSERT_GE(distance + 3e-3, least);
    }
  }
}

TEST(Revolution, HasAContinuousNormalOverTangentJoints) {
  // Nose arc, tangent cone, tangent shoulder, with decimal data good to 12 digits only.
  const Revolution body(
      origin, x_axis,
      {arc({0, 0}, {0.25, 0.433012701892}, {0.5, 0}, true), line({0.25, 0.433012701892}, {1.25, 1.010362971082})});
  for (const double joint : {0.25}) {
    const double r = 0.433012701892;
    for (const double step : {1e-6, 1e-9, 1e-12}) {
      const Vec3 before = body.normal({joint - step, r, 0}), after = body.normal({joint + step, r, 0});
      EXPECT_LT(norm(after - before), 5 * step + 1e-11);
    }
  }
}

TEST(Revolution, FindsTheSeamWhereTwoPiecesJoin) {
  // a rounded shoulder that runs tangentially into a flat base: a chord's middle lies on the base, the seam beside it
  const Revolution body(origin, x_axis, {arc({0, 1}, {1, 2}, {0, 2}, false), line({1, 2}, {1, 3})});
  const Vec3 middle{1, 1.9 * std::cos(0.3), 1.9 * std::sin(0.3)};
  const Vec3 seam = body.project_to_seam(middle);
  EXPECT_LT(norm(seam - Vec3{1, 2 * std::cos(0.3), 2 * std::sin(0.3)}), 1e-15);
  const Revolution plain(origin, x_axis, {line({0, 1}, {1, 1})});
  EXPECT_EQ(plain.project_to_seam(middle), plain.project(middle));
}

TEST(Revolution, ClosesGapsWithinTolerance) {
  const double gap = 3e-10;
  const Revolution surface(origin, x_axis,
                           {line({0, 1}, {1, 1}), arc({1 + gap, 1}, {2, 2 - gap}, {1, 2}), line({2, 2 + gap}, {2, 3})});
  for (const Vec3 p : {Vec3{1, 1, 0}, Vec3{2, 2, 0}, Vec3{1, 0, 0.9}, Vec3{2.5, 2, 0}, Vec3{1.7, 1.3, 0}}) {
    const Vec3 once = surface.project(p);
    EXPECT_LT(norm(surface.project(once) - once), 1e-15);
  }
}

TEST(Revolution, IsFlatOnlyAsAFullDisc) {
  EXPECT_TRUE(Revolution(origin, x_axis, {line({2, 0}, {2, 1})}).is_flat());
  EXPECT_TRUE(Revolution(origin, x_axis, {line({2, 1}, {2, 0})}).is_flat());
  EXPECT_FALSE(Revolution(origin, x_axis, {line({2, 0.5}, {2, 1})}).is_flat());
  EXPECT_FALSE(Revolution(origin, x_axis, {line({2, 0}, {2.1, 1})}).is_flat());
}

TEST(Revolution, NamesThePieceThatIsWrong) {
  const auto build = [](std::vector<ProfilePiece> profile) { return [=] { Revolution(origin, x_axis, profile); }; };
  const auto says = [](auto... parts) { return ThrowsMessage<Error>(AllOf(HasSubstr(parts)...)); };
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_THAT(build({}), says("at least one piece"));
  EXPECT_THAT(build({line({0, 1}, {1, 1}), line({1.1, 1}, {2, 1})}),
              says("profile piece 2", "expected to start", "[1, 1]", "[1.1, 1]"));
  EXPECT_THAT(build({line({0, 1}, {1, 1}), line({1 + 1e-8, 1}, {2, 1})}), says("profile piece 2"));
  EXPECT_THAT(build({line({0, 1}, {0, 1})}), says("profile piece 1", "two distinct ends"));
  EXPECT_THAT(build({line({0, 1}, {1, -0.5})}), says("profile piece 1", "r >= 0", "[1, -0.5]"));
  EXPECT_THAT(build({line({0, 1}, {nan, 1})}), says("profile piece 1", "finite"));
  EXPECT_THAT(build({arc({0, 1}, {1, 1}, {0.4, 1})}), says("profile piece 1", "same distance", "0.4", "0.6"));
  EXPECT_THAT(build({arc({0, 1}, {1, 1}, {0.5, 1})}), says("profile piece 1", "clockwise", "half circle"));
  EXPECT_THAT(build({arc({0, 0.1}, {1, 0.1}, {0.5, 0.1}, false)}), says("profile piece 1", "reaches down", "-0.4"));
  EXPECT_THAT(build({line({0, 0}, {0, 1}), arc({0, 1}, {1, 1}, {0.5, nan})}), says("profile piece 2", "finite"));
  EXPECT_THROW(Revolution({0, 0, nan}, x_axis, {line({0, 1}, {1, 1})}), Error);
  EXPECT_THROW(Revolution(origin, {0, 0, 0}, {line({0, 1}, {1, 1})}), Error);
}

}  // namespace revolution_test
}  // namespace pamr::geometry
