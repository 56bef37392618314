// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/quadratic_analysis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/mark/recovery.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_elements.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Calls `use(shape functions, point in space, its weight)` for the points of a cell.
template <class Use>
void at_points_of(const Domain& domain, std::size_t cell, const Use& use) {
  const auto node = domain.quadratic->points(domain, cell);
  for (const auto& point : cell_points()) {
    const auto placed = place(node, point);
    use(point.value, placed, point.weight * placed.jacobian / 6);
  }
}

Vec3 interpolated_at(std::span<const double> shape, std::span<const LocalId> nodes, std::span<const Vec3> value) {
  Vec3 sum;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += shape[k] * value[at(nodes[k])];
  return sum;
}

bool is_constant(const OfCellNodes<double>& value) {
  return std::all_of(value.begin(), value.end(), [&](double v) { return v == value[0]; });
}

OfFaceNodes<double> on_face(const OfFaceNodes<LocalId>& nodes, std::span<const double> value) {
  OfFaceNodes<double> result{};
  for (std::size_t k = 0; k < 6; ++k) result[k] = value[at(nodes[k])];
  return result;
}

}  // namespace

std::vector<Vec3> recover_quadratic(const par::Comm& comm, const Domain& domain, std::span<const double> u,
                                    Recovery recovery) {
  const auto& elements = *domain.quadratic;
  return mark::nodal_means<Vec3>(par::Exchange(comm, domain.nodes.shared()), domain.point.size(), [&](const auto& add) {
    for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
      const auto node = elements.points(domain, c);
      const auto value = elements.values(c, u);
      const double weight = recovery == Recovery::plain ? 1 : geometry::volume(domain.points(c));
      for (std::size_t k = 0; k < 10; ++k)
        add(elements.cell_to_node[c][k], weight, gradient_of(place(node, cell_nodes_as_points()[k]), value));
    }
  });
}

ManufacturedErrors quadratic_manufactured_errors(const par::Comm& comm, const Domain& domain,
                                                 std::span<const double> u) {
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < domain.quadratic->cell_to_node.size(); ++c) {
    const auto value = domain.quadratic->values(c, u);
    at_points_of(domain, c, [&](const OfCellNodes<double>& shape, const PlacedPoint& placed, double weight) {
      const double error = interpolated(shape, value) - manufactured_potential(placed.position);
      sums[0].add(weight * error * error);
      sums[1].add(weight * squared_norm(gradient_of(placed, value) - manufactured_gradient(placed.position)));
    });
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {std::sqrt(totals[0]), std::sqrt(totals[1])};
}

VolumeForm quadratic_volume_form(const par::Comm& comm, const State& state, std::span<const double> chi,
                                 std::uint64_t open_walls, Vec3 center) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  VectorSum force, torque, walls;
  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    const auto cut = elements.values(c, chi), value = elements.values(c, state.u);
    if (is_constant(cut)) continue;
    Vec3 of_cell, about_center;
    at_points_of(domain, c, [&](const OfCellNodes<double>& shape, const PlacedPoint& placed, double weight) {
      const auto slope = gradient_of(placed, cut);
      const double z = placed.position.z;
      const Vec3 base{0, 0, problem.split_slope(z)};
      const double pressure = problem.term.pressure(interpolated(shape, value), problem.split_potential(z));
      const auto part = -weight * (added_stress(gradient_of(placed, value), base, slope) - pressure * slope);
      of_cell += part;
      about_center += cross(placed.position - center, part);
    });
    force.add(of_cell);
    torque.add(about_center);
  }
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if ((open_walls >> static_cast<unsigned>(domain.faces[f].patch) & 1U) == 0) continue;
    const auto node = elements.face_points(domain, f);
    const auto cut = on_face(elements.face_to_node[f], chi), value = on_face(elements.face_to_node[f], state.u);
    const auto of_cell = elements.values(at(domain.faces[f].cell), state.u);
    for (const auto& point : face_points()) {
      const double share = interpolated(point.value, cut);
      if (share == 0) continue;
      const auto placed = place(node, point);
      const double z = placed.position.z;
      const Vec3 base{0, 0, problem.split_slope(z)};
      const double pressure = problem.term.pressure(interpolated(point.value, value), problem.split_potential(z));
      const auto gradient = gradient_of(elements.behind(domain, f, point), of_cell);
      const auto part = share * placed.area * (added_stress(gradient, base, placed.normal) - pressure * placed.normal);
      walls.add(part);
      torque.add(cross(placed.position - center, part));
    }
  }
  VolumeForm result;
  result.through_walls = walls.total(comm);
  result.force = force.total(comm) + result.through_walls;
  result.torque = torque.total(comm);
  return result;
}

Energy quadratic_energy(const par::Comm& comm, const State& state) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < domain.quadratic->cell_to_node.size(); ++c) {
    const auto value = domain.quadratic->values(c, state.u);
    std::array<double, 2> of_cell{};
    at_points_of(domain, c, [&](const OfCellNodes<double>& shape, const PlacedPoint& placed, double weight) {
      const double z = placed.position.z, psi0 = problem.profile.potential(z);
      const Vec3 base{0, 0, problem.profile.slope(z)};
      auto rest = gradient_of(placed, value);
      double excess = interpolated(shape, value);
      if (!problem.input.split) {
        rest -= base;
        excess -= psi0;
      }
      of_cell[0] += weight * (0.5 * squared_norm(rest + base) + problem.term.pressure(excess + psi0, 0));
      of_cell[1] += weight * (0.5 * squared_norm(rest) + dot(rest, base) + problem.term.pressure(excess, psi0));
    });
    sums[0].add(of_cell[0]);
    sums[1].add(of_cell[1]);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], totals[1]};
}

double quadratic_midplane_force(const par::Comm& comm, const State& state, int patch) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  std::array<par::ExactSum, 1> sum;
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if (domain.faces[f].patch != patch) continue;
    const auto node = elements.face_points(domain, f);
    const auto value = on_face(elements.face_to_node[f], state.u);
    const auto of_cell = elements.values(at(domain.faces[f].cell), state.u);
    double of_face = 0;
    for (const auto& point : face_points()) {
      const auto placed = place(node, point);
      const double z = placed.position.z, psi0 = problem.profile.potential(z);
      double u = interpolated(point.value, value);
      auto gradient = gradient_of(elements.behind(domain, f, point), of_cell);
      if (!problem.input.split) {
        u -= psi0;
        gradient -= Vec3{0, 0, problem.profile.slope(z)};
      }
      gradient -= dot(gradient, placed.normal) * placed.normal;
      of_face += placed.area * (0.5 * squared_norm(gradient) + problem.term.convex_rest(u, psi0));
    }
    sum[0].add(of_face);
  }
  return par::reproducible_sums(comm, sum)[0];
}

double outward_slope(const Problem& problem, const Boundary& b, const PlacedFacePoint& placed, double u) {
  const double z = placed.position.z;
  switch (b.condition) {
    case Condition::charge:
    case Condition::regulated:
      return b.charge_at(problem.split_potential(z) + u);
    case Condition::symmetry:
      return 0;
    case Condition::far_field:
      return placed.normal.z * problem.profile.slope(z) -
             far_field_coefficient(problem.input.spheres, placed.position, placed.normal) *
                 (u - (problem.input.split ? 0 : problem.profile.potential(z)));
    default:
      return placed.normal.z * problem.split_slope(z);
  }
}

namespace {

struct SurfaceSums {
  std::array<par::ExactSum, 3> area_potential_charge;
  VectorSum raw, recovered;
};

void add_surface(const State& state, std::size_t f, SurfaceSums& sums) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  const auto& nodes = elements.face_to_node[f];
  const auto& b = *problem.input.find_boundary(domain.mesh->info.patches[at(domain.faces[f].patch)].name);
  const auto node = elements.face_points(domain, f);
  const auto value = on_face(nodes, state.u);
  const auto of_cell = elements.values(at(domain.faces[f].cell), state.u);
  for (const auto& point : face_points()) {
    const auto placed = place(node, point);
    const double z = placed.position.z, u = interpolated(point.value, value), psi0 = problem.split_potential(z);
    const Vec3 base{0, 0, problem.split_slope(z)}, n = -placed.normal;  // from the body into the liquid
    const double pressure = problem.term.pressure(u, psi0);
    const auto stress_of = [&](Vec3 gradient) {
      return placed.area * (added_stress(gradient, base, n) - pressure * n);
    };
    sums.area_potential_charge[0].add(placed.area);
    sums.area_potential_charge[1].add(placed.area * (psi0 + u));
    sums.area_potential_charge[2].add(placed.area * outward_slope(problem, b, placed, u));
    sums.raw.add(stress_of(gradient_of(elements.behind(domain, f, point), of_cell)));
    sums.recovered.add(stress_of(interpolated_at(point.value, nodes, state.recovered)));
  }
}

}  // namespace

std::vector<QuadraticSurface> quadratic_surfaces(const par::Comm& comm, const State& state) {
  const auto& domain = state.problem.domain;
  std::vector<SurfaceSums> sums(domain.mesh->info.patches.size());
  for (std::size_t f = 0; f < domain.faces.size(); ++f) add_surface(state, f, sums[at(domain.faces[f].patch)]);
  const auto& deciding = state.problem.conditions.deciding_patch;
  for (const auto node : domain.nodes.owned())
    if (deciding[at(node)] >= 0) sums[at(deciding[at(node)])].area_potential_charge[2].add(state.reaction[at(node)]);
  std::vector<QuadraticSurface> result;
  for (auto& patch : sums) {
    const auto scalars = par::reproducible_sums(comm, patch.area_potential_charge);
    result.push_back({scalars[0], scalars[1], scalars[2], patch.raw.total(comm), patch.recovered.total(comm)});
  }
  return result;
}

}  // namespace pamr::poisson_boltzmann
