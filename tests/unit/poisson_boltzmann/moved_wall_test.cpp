// SPDX-License-Identifier: GPL-3.0-or-later
// Shape derivatives of a moved wall against finite differences of the residual, on a sphere, an ellipsoid and a torus.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "solved.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"
#include "solvers/poisson_boltzmann/goals/shape_change.hpp"

namespace pamr::poisson_boltzmann {
namespace moved_wall_test {

using geometry::Surface;
using geometry::Vec3;

using Triangle = std::array<Vec3, 3>;
using Triangles = std::vector<Triangle>;
const double pi = std::numbers::pi;

struct Body {
  std::string name;
  const Surface* surface;
  std::function<Triangles(int)> triangles;  ///< with corners on the surface, by the edges along a side
};

/// An ellipsoid with these half axes: the eight faces of an octahedron with n edges a side. Normals point outwards.
Triangles round(Vec3 half_axes, int n) {
  Triangles result;
  const auto on_side = [&](int i, int j, Vec3 sign) {
    const Vec3 flat{sign.x * i, sign.y * j, sign.z * (n - i - j)};
    return (1 / norm(flat)) * Vec3{half_axes.x * flat.x, half_axes.y * flat.y, half_axes.z * flat.z};
  };
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        for (int i = 0; i < n; ++i)
          for (int j = 0; i + j < n; ++j) {
            const Vec3 sign{x, y, z};
            const auto a = on_side(i, j, sign), b = on_side(i + 1, j, sign), c = on_side(i, j + 1, sign);
            result.push_back(x * y * z > 0 ? Triangle{a, b, c} : Triangle{a, c, b});
            if (i + j + 1 == n) continue;
            const auto d = on_side(i + 1, j + 1, sign);
            result.push_back(x * y * z > 0 ? Triangle{b, d, c} : Triangle{b, c, d});
          }
  return result;
}

/// A torus about z with radii 1 and 0.4; 4 n edges along the tube, 2 n around it.
Triangles ring(int n) {
  const auto place = [&](int i, int j) {
    const double u = pi * i / (2 * n), v = pi * j / n, r = 1 + 0.4 * std::cos(v);
    return Vec3{r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v)};
  };
  Triangles result;
  for (int i = 0; i < 4 * n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const auto a = place(i, j), b = place(i + 1, j), c = place(i + 1, j + 1), d = place(i, j + 1);
      result.push_back({a, b, c});
      result.push_back({a, c, d});
    }
  return result;
}

double derivative(const std::function<double(Vec3)>& f, Vec3 at, Vec3 along) {
  const double h = 1e-4;
  return (f(at + h * along) - f(at - h * along)) / (2 * h);
}
Vec3 gradient(const std::function<double(Vec3)>& f, Vec3 at) {
  return {derivative(f, at, {1, 0, 0}), derivative(f, at, {0, 1, 0}), derivative(f, at, {0, 0, 1})};
}

/// A potential around a wall that meets its condition, and any dual solution.
class Fields {
 public:
  Fields(const Boundary& wall, const Surface& surface) : wall_(wall), surface_(surface) {}
  double psi(Vec3 x) const {
    const auto foot = surface_.project(x);
    const double d = dot(x - foot, surface_.normal(foot)), at_wall = 1 + 0.3 * foot.x + 0.2 * foot.y * foot.z;
    return at_wall - wall_.charge_at(at_wall) * d + 0.7 * d * d;
  }
  Vec3 psi_gradient(Vec3 x) const {
    return gradient([&](Vec3 y) { return psi(y); }, x);
  }
  static double w(Vec3 x) { return 2 + std::sin(x.x + 0.5 * x.z) + 0.5 * x.y * x.y; }
  static Vec3 w_gradient(Vec3 x) {
    const double c = std::cos(x.x + 0.5 * x.z);
    return {c, x.y, 0.5 * c};
  }

 private:
  const Boundary& wall_;
  const Surface& surface_;
};

/// Residual of the equation for w, energy, and charge of the wall; or what they change by.
struct Amounts {
  double residual = 0, energy = 0, charge = 0;
  Amounts& operator+=(const Amounts& a) {
    residual += a.residual;
    energy += a.energy;
    charge += a.charge;
    return *this;
  }
  Amounts operator-(const Amounts& a) const { return {residual - a.residual, energy - a.energy, charge - a.charge}; }
};

/// A point of a triangle and its image on the moved wall, with the area vectors of both (of unit triangles twice it).
struct Moved {
  Vec3 from, to;
  std::array<Vec3, 2> edge_from, edge_to;
};

class Wall {
 public:
  Wall(const Problem& problem, const Boundary& boundary, const Surface& surface)
      : problem_(problem), boundary_(boundary), fields_(boundary, surface) {}

  /// By definition: liquid between both places is lost, the charge lies on the new one.
  Amounts difference(const Moved& at, double weight) const {
    Amounts sum;
    const double half = 0.5 * std::sqrt(0.6);
    for (const auto& [t, part] : {std::pair{0.5 - half, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + half, 5.0 / 18}}) {
      const auto x = at.from + t * (at.to - at.from);
      const auto along = [&](std::size_t k) { return at.edge_from[k] + t * (at.edge_to[k] - at.edge_from[k]); };
      const double lost = part * weight * 0.5 * dot(at.to - at.from, cross(along(0), along(1)));
      const auto slope = fields_.psi_gradient(x);
      const double psi = fields_.psi(x);
      sum.residual -= lost * (dot(slope, Fields::w_gradient(x)) + problem_.term.value(psi, 0) * Fields::w(x));
      sum.energy -= lost * (0.5 * squared_norm(slope) + problem_.term.pressure(psi, 0));
    }
    const auto add = [&](Vec3 x, const std::array<Vec3, 2>& edge, double sign) {
      const double charge = sign * weight * 0.5 * norm(cross(edge[0], edge[1])) * boundary_.charge_at(fields_.psi(x));
      sum.residual -= charge * Fields::w(x);
      sum.charge += charge;
    };
    add(at.to, at.edge_to, 1);
    add(at.from, at.edge_from, -1);
    return sum;
  }

  /// By `shape_change`, of which a residual has the other sign.
  Amounts predicted(const WallTraces& at, WallShift shift, double area) const {
    const auto change = [&](Goal::Kind kind, double counted) {
      Goal goal;
      goal.kind = kind;
      auto traces = at;
      traces.counted = counted;
      return area * shape_change(problem_, goal, boundary_, traces, shift);
    };
    const double missed = change(Goal::Kind::force, 0);
    return {-missed, change(Goal::Kind::energy, 0) - missed, change(Goal::Kind::charge, 1) + missed};
  }
  WallTraces traces(Vec3 x, Vec3 out_of_liquid) const {
    return {out_of_liquid, fields_.psi_gradient(x), fields_.psi(x), 0, 0, Fields::w_gradient(x), Fields::w(x), 0};
  }
  const Boundary& boundary() const { return boundary_; }

 private:
  const Problem& problem_;
  const Boundary& boundary_;
  Fields fields_;
};

/// Calls `use(point, weight, edges, unit normal)` for points of triangles.
template <class Use>
void at_points(const Triangles& triangles, const Use& use) {
  for (const auto& triangle : triangles) {
    const std::array<Vec3, 2> edge{triangle[1] - triangle[0], triangle[2] - triangle[0]};
    const auto normal = cross(edge[0], edge[1]);
    for (const auto& point : triangle_points) {
      Vec3 x;
      for (std::size_t k = 0; k < 3; ++k) x += point.weight_of_corner[k] * triangle[k];
      use(x, point.weight, edge, (1 / norm(normal)) * normal);
    }
  }
}

/// Change from triangles to the curved surface that they approximate: by definition, and as the solver finds it.
std::array<Amounts, 2> from_triangles(const Domain& domain, const Wall& wall, const Surface& surface,
                                      const Triangles& triangles) {
  std::array<Amounts, 2> sum;
  at_points(triangles, [&](Vec3 x, double weight, const std::array<Vec3, 2>& edge, Vec3 normal) {
    const auto moved = [&](Vec3 along) {
      const double h = 1e-3;
      return (0.5 / h) * (surface.project(x + h * along) - surface.project(x - h * along));
    };
    sum[0] += wall.difference({x, surface.project(x), edge, {moved(edge[0]), moved(edge[1])}}, weight);
    const double area = 0.5 * norm(cross(edge[0], edge[1]));
    const auto shift = wall_shift(domain, wall.boundary(), surface, {x, -normal, weight * area}, norm(edge[0]));
    sum[1] += wall.predicted(wall.traces(x, -normal), shift, weight * area);
  });
  return sum;
}

/// What triangles change by if all their corners move by `distance` along the normals of the surface, divided by it: by
/// definition, and with 2 H for the area.
std::array<Amounts, 2> as_a_whole(const Wall& wall, const Surface& surface, const Triangles& triangles,
                                  double distance) {
  const auto twice_mean_curvature = [&](Vec3 x) {
    const auto part = [&](std::size_t k) { return [&surface, k](Vec3 y) { return surface.normal(y)[k]; }; };
    return derivative(part(0), x, {1, 0, 0}) + derivative(part(1), x, {0, 1, 0}) + derivative(part(2), x, {0, 0, 1});
  };
  std::array<Amounts, 2> sum;
  for (const auto& triangle : triangles) {
    const auto& [a, b, c] = triangle;
    const std::array<Vec3, 3> by{surface.normal(a), surface.normal(b), surface.normal(c)};
    const std::array<Vec3, 2> edge{b - a, c - a};
    const auto flat = cross(edge[0], edge[1]);
    for (const auto& point : triangle_points) {
      Vec3 x, shift;
      for (std::size_t k = 0; k < 3; ++k) {
        x += point.weight_of_corner[k] * triangle[k];
        shift += distance * point.weight_of_corner[k] * by[k];
      }
      const std::array<Vec3, 2> edge_to{edge[0] + distance * (by[1] - by[0]), edge[1] + distance * (by[2] - by[0])};
      sum[0] += wall.difference({x, x + shift, edge, edge_to}, point.weight / distance);
      const auto on = surface.project(x);
      sum[1] += wall.predicted(wall.traces(on, -surface.normal(on)), {1, twice_mean_curvature(on)},
                               point.weight * 0.5 * norm(flat));
    }
  }
  return sum;
}

class MovedWall : public ::testing::Test {
 public:
  MovedWall() {
    walls[0].condition = Condition::charge;
    walls[0].value = 1.3;
    walls[1].condition = Condition::regulated;
    walls[1].site = {-2, -0.4, -1};
  }
  /// Calls `use(body, condition)` for all of both.
  template <class Use>
  void for_all(const Use& use) {
    for (const auto& body : bodies)
      for (const auto& wall : walls) use(body, wall);
  }

  par::Comm comm{MPI_COMM_WORLD};
  Solved cube{comm, test::kuhn_cube(comm, 1), cube_boundary("kind = \"potential\"\nvalue = 1")};
  std::array<Boundary, 2> walls;
  geometry::SharedSurfaces surfaces = test::surfaces_of(
      "[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n"
      "[[surface]]\nname = \"egg\"\nkind = \"quadric\"\ncoefficients = [1, 1.5625, 0.64, 0, 0, 0, 0, 0, 0, -1]\n"
      "[[surface]]\nname = \"ring\"\nkind = \"torus\"\ncenter = [0, 0, 0]\naxis = [0, 0, 1]\nmajor_radius = 1\n"
      "minor_radius = 0.4\n");
  const std::array<Body, 3> bodies{{{"ball", surfaces->surface[0].get(),
                                     [](int n) {
                                       return round({1, 1, 1}, n);
                                     }},
                                    {"egg", surfaces->surface[1].get(),
                                     [](int n) {
                                       return round({1, 0.8, 1.25}, n);
                                     }},
                                    {"ring", surfaces->surface[2].get(), ring}}};
};

double worst(const std::array<Amounts, 2>& pair) {
  const auto& [exact, found] = pair;
  return std::max({std::abs(found.residual / exact.residual - 1), std::abs(found.energy / exact.energy - 1),
                   std::abs(found.charge / exact.charge - 1)});
}

TEST_F(MovedWall, ChangesTheResidualAsDifferencesBetweenTwoTriangulationsDo) {
  for_all([&](const Body& body, const Boundary& boundary) {
    const Wall wall(cube.problem, boundary, *body.surface);
    std::array<std::array<Amounts, 2>, 3> at_level;
    for (int level = 0; level < 3; ++level)
      at_level[static_cast<std::size_t>(level)] =
          from_triangles(cube.domain, wall, *body.surface, body.triangles(3 << level));
    // Between two triangulations: what one lacks, less what the other does. What is left is as the square of the edges.
    std::array<double, 2> error{};
    for (std::size_t k = 0; k < 2; ++k)
      error[k] = worst({at_level[k][0] - at_level[k + 1][0], at_level[k][1] - at_level[k + 1][1]});
    EXPECT_LT(error[0], 0.1) << body.name << name_of(boundary.condition);
    EXPECT_LT(error[1], 0.35 * error[0]) << body.name << name_of(boundary.condition);
  });
}

TEST_F(MovedWall, AsAWholeAddsTwiceTheMeanCurvatureToTheArea) {
  for_all([&](const Body& body, const Boundary& boundary) {
    const Wall wall(cube.problem, boundary, *body.surface);
    std::array<double, 2> error{};
    for (int level = 0; level < 2; ++level)
      error[static_cast<std::size_t>(level)] = worst(as_a_whole(wall, *body.surface, body.triangles(6 << level), 1e-5));
    EXPECT_LT(error[0], 0.1) << body.name << name_of(boundary.condition);
    EXPECT_LT(error[1], 0.35 * error[0]) << body.name << name_of(boundary.condition);
  });
}

}  // namespace moved_wall_test
}  // namespace pamr::poisson_boltzmann
