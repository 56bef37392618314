// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/shape_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/mesh/plane_fit.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Surface;
using geometry::Vec3;

namespace {

/// Step of the differences that measure an area, over the length of edges: their errors are its square and rounding
/// over it.
constexpr double step_over_size = 1e-3;

/// A direction at right angles to `n`.
Vec3 across(Vec3 n) {
  const auto a = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const auto t = a - dot(a, n) * n;
  return (1 / norm(t)) * t;
}

}  // namespace

bool is_curved_wall(const Boundary& b, const Surface* surface) {
  return surface != nullptr && !surface->is_flat() &&
         (b.condition == Condition::potential || b.condition == Condition::charge ||
          b.condition == Condition::regulated || b.condition == Condition::symmetry);
}

WallShift wall_shift(const Domain& domain, const Boundary& b, const Surface& surface, const WallPlace& place,
                     double size) {
  const auto normal = place.normal, on_mesh = (1 / domain.scale) * place.point;
  WallShift result{-domain.scale * dot(surface.project(on_mesh) - on_mesh, normal), 0};
  if (b.condition == Condition::potential) return result;
  const auto t = across(normal);
  const double step = step_over_size * size / domain.scale;
  const auto moved = [&](Vec3 along) {
    return (0.5 / step) * (surface.project(on_mesh + step * along) - surface.project(on_mesh - step * along));
  };
  result.stretch = norm(cross(moved(t), moved(cross(normal, t)))) - 1;
  return result;
}

void GapWave::add(const Domain& domain, const Surface& surface, const WallPlace& place, double distance) {
  const double cosine = dot(surface.normal((1 / domain.scale) * place.point), place.normal);
  squared_tilts_ += place.area * std::max(0.0, 1 - cosine * cosine);
  squared_distances_ += place.area * distance * distance;
}

double GapWave::number() const { return squared_distances_ > 0 ? std::sqrt(squared_tilts_ / squared_distances_) : 0; }

double shape_change(const Problem& problem, const Goal& goal, const Boundary& b, const WallTraces& at,
                    WallShift shift) {
  const double d = shift.distance, slope = -dot(at.gradient, at.normal), dual_slope = -dot(at.dual_gradient, at.normal);
  const double source = problem.term.pressure_slope(at.u, at.psi0);
  if (b.condition == Condition::potential) {
    if (goal.kind == Goal::Kind::charge) return d * (slope * dual_slope - at.w * source);
    const double density = 0.5 * (slope * slope + at.base * at.base) - problem.term.pressure(at.u, at.psi0);
    return d * ((goal.kind == Goal::Kind::energy ? density : 0) - slope * dual_slope);
  }
  const auto along = at.gradient + slope * at.normal;
  const double charge = b.charge_at(at.psi0 + at.u), charge_slope = b.charge_slope_at(at.psi0 + at.u);
  const double missed = d * (dot(along, at.dual_gradient) + source * at.w) +
                        charge * (shift.stretch - d * charge_slope) * (at.w - at.counted);
  if (goal.kind == Goal::Kind::charge) return -missed;
  if (goal.kind != Goal::Kind::energy) return missed;
  const double squares = squared_norm(along) + charge * charge - at.base * at.base;
  return missed - d * (0.5 * squares + problem.term.pressure(at.u, at.psi0));
}

namespace {

/// The surface of each patch, a plane where it has none and is flat, else null.
class PatchSurfaces {
 public:
  PatchSurfaces(const par::Comm& comm, const mesh::DistMesh& mesh) {
    std::vector<bool> has_none;
    for (std::size_t p = 0; p < mesh.info.patches.size(); ++p) {
      surface_.push_back(mesh.info.surface_of(static_cast<int>(p)));
      has_none.push_back(surface_.back() == nullptr);
    }
    const auto planes = mesh::fit_planes(comm, mesh, has_none);
    for (std::size_t p = 0; p < planes.size(); ++p) {
      if (!has_none[p] || !planes[p].is_flat) continue;
      plane_.push_back(std::make_unique<geometry::Plane>(planes[p].point, planes[p].normal));
      surface_[p] = plane_.back().get();
    }
  }
  const Surface* of(std::size_t patch) const { return surface_[patch]; }

 private:
  std::vector<const Surface*> surface_;
  std::vector<std::unique_ptr<geometry::Plane>> plane_;
};

/// Weights of the ends and the middle of an edge at three points of it, and the derivatives: Gauss, degree 5.
struct EdgePoint {
  std::array<double, 3> value, slope;
  double weight;
};
EdgePoint edge_point(double s, double weight) {
  return {{(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)}, {4 * s - 3, 4 * s - 1, 4 - 8 * s}, weight};
}
std::array<EdgePoint, 3> edge_points() {
  const double a = 0.5 * std::sqrt(0.6);
  return {edge_point(0.5 - a, 5.0 / 18), edge_point(0.5, 8.0 / 18), edge_point(0.5 + a, 5.0 / 18)};
}

/// Area between an edge of a face and the curve where its surface meets the other one, weighted with |amount|.
double width_at_edge(const Domain& domain, const std::array<const Surface*, 2>& surfaces,
                     const std::array<Vec3, 3>& node, const std::array<double, 3>& amount, Vec3 normal) {
  double sum = 0;
  for (const auto& point : edge_points()) {
    Vec3 x, t;
    double value = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x += point.value[k] / domain.scale * node[k];
      t += point.slope[k] * node[k];
      value += point.value[k] * amount[k];
    }
    const auto gap = geometry::project_onto_all(surfaces, x).point - surfaces[0]->project(x);
    sum += point.weight * std::abs(value * domain.scale * dot(gap, cross(t, normal)));
  }
  return sum;
}

}  // namespace

double charge_at_edges(const par::Comm& comm, const State& state, std::uint64_t counted, std::span<const double> w) {
  const auto& problem = state.problem;
  if (std::none_of(problem.input.boundary.begin(), problem.input.boundary.end(),
                   [](const Boundary& b) { return b.holds_charge(); }))
    return 0;
  const auto& domain = problem.domain;
  const auto& patches = domain.mesh->info.patches;
  const PatchSurfaces surfaces(comm, *domain.mesh);
  std::array<par::ExactSum, 1> sum;
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& face = domain.faces[f];
    const auto own = at(face.patch);
    const auto& b = problem.boundary_of(face);
    if (!b.holds_charge() || surfaces.of(own) == nullptr) continue;
    const double of_goal = (counted >> own & 1U) != 0 ? 1 : 0;
    const auto weight = [&](std::size_t node, double of_w) {
      return b.charge_at(problem.conditions.psi0[node] + state.u[node]) * (of_w - of_goal);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<std::size_t, 2> end{at(face.node[k]), at(face.node[(k + 1) % 3])};
      auto shared = domain.node_patches[end[0]] & domain.node_patches[end[1]] & ~(std::uint64_t{1} << own);
      std::array<Vec3, 3> node{domain.point[end[0]], domain.point[end[1]]};
      std::array<double, 3> amount{weight(end[0], w[end[0]]), weight(end[1], w[end[1]])};
      node[2] = 0.5 * (node[0] + node[1]);
      amount[2] = 0.5 * (amount[0] + amount[1]);
      if (const auto nodes = domain.face_nodes(f); nodes.size() == 6) {
        const auto middle = at(nodes[3 + k]);
        shared &= domain.node_patches[middle];
        node[2] = domain.point[middle];
        amount[2] = weight(middle, w[middle]);
      }
      for (std::size_t p = 0; p < patches.size(); ++p) {
        const auto* other = surfaces.of(p);
        if ((shared >> p & 1U) == 0 || other == nullptr || (other->is_flat() && surfaces.of(own)->is_flat())) continue;
        sum[0].add(width_at_edge(domain, {surfaces.of(own), other}, node, amount, face.normal));
      }
    }
  }
  return par::reproducible_sums(comm, sum)[0];
}

}  // namespace pamr::poisson_boltzmann
