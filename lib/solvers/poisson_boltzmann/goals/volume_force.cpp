// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

#include <array>
#include <cmath>
#include <type_traits>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/goals/goal_space.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

Vec3 Component::at(Vec3 point) const {
  Vec3 unit;
  unit[pamr::at(axis)] = 1;
  return is_torque ? cross(unit, point - center) : unit;
}

namespace {

/// Pressure at the Gauss points of cells of first order where nothing is split off and the equation is not linear. An
/// exponential of a sum is a product of exponentials, which the nodes have once for all their cells.
class GaussPressure {
 public:
  explicit GaussPressure(std::span<const double> u) : shared_(u.size()), own_(u.size()) {
    constexpr double near = gauss_points[0].weight_of_corner[0], far = gauss_points[0].weight_of_corner[1];
    for (std::size_t i = 0; i < u.size(); ++i) {
      shared_[i] = std::exp(far * u[i] / 2);
      own_[i] = std::exp((near - far) * u[i] / 2);
    }
  }

  /// At the point that is near corner `point` of the cell.
  double at(const mesh::CellNodes& nodes, std::size_t point) const {
    double shared = 1;
    for (const auto node : nodes) shared *= shared_[pamr::at(node)];
    const double exponential = shared * own_[pamr::at(nodes[point])];  // of half of the potential
    const double twice_sinh = exponential - 1 / exponential;           // cosh u - 1 = 2 sinh(u/2)^2
    return 0.5 * twice_sinh * twice_sinh;
  }

 private:
  std::vector<double> shared_, own_;
};

struct VolumeSums {
  VectorSum force, torque, walls;
};

/// The cells in which the cut-off function varies.
template <class Element>
void add_cut_off_cells(const Element& element, const State& state, std::span<const double> chi, Vec3 center,
                       VolumeSums& sums) {
  const auto& problem = state.problem;
  const bool has_products = std::is_same_v<Element, LinearElement> && !problem.input.split && problem.term.is_sinh();
  const GaussPressure products(has_products ? state.u : std::span<const double>());
  for (std::size_t c = 0; c < element.cells().size(); ++c) {
    if (is_constant(chi, element.cells()[c])) continue;
    const auto cell = element.cell(c);
    const auto cut = cell.field(chi), u = cell.field(state.u);
    Vec3 force, torque;
    cell.at_points([&](const auto& point) {
      const double z = point.position.z;
      const Vec3 base{0, 0, problem.split_slope(z)}, slope = cut.gradient(point);
      const double pressure = has_products ? products.at(element.domain.mesh->cell_to_node[c], point.index)
                                           : problem.term.pressure(u.at(point), problem.split_potential(z));
      const auto part = -point.weight * (added_stress(u.gradient(point), base, slope) - pressure * slope);
      force += part;
      torque += cross(point.middle - center, part);
    });
    sums.force.add(force);
    sums.torque.add(torque);
  }
}

/// Calls `use(face, chi at its nodes, u at its nodes)` for the faces of the walls that meet the body and are no mirrors.
template <class Element, class Use>
void at_open_walls(const Element& element, const State& state, std::span<const double> chi, std::uint64_t open_walls,
                   const Use& use) {
  const auto& faces = element.domain.faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if ((open_walls >> static_cast<unsigned>(faces[f].patch) & 1U) == 0) continue;
    const auto face = element.face(f);
    use(face, face.values(chi), face.values(state.u));
  }
}

template <class Element>
void add_open_walls(const Element& element, const State& state, std::span<const double> chi, std::uint64_t open_walls,
                    Vec3 center, VolumeSums& sums) {
  const auto& problem = state.problem;
  at_open_walls(element, state, chi, open_walls, [&](const auto& face, const auto& cut, const auto& value) {
    const auto behind = face.behind(state.u);
    Vec3 force, torque;
    face.at_wall_points([&](const auto& point) {
      const double share = interpolated(point.value, cut);
      if (share == 0) return;
      const Vec3 base{0, 0, face.split_slope(problem, point)};
      const double pressure =
          problem.term.pressure(interpolated(point.value, value), face.split_potential(problem, point));
      const auto part =
          share * point.area * (added_stress(behind.gradient(point), base, point.normal) - pressure * point.normal);
      force += part;
      torque += cross(point.middle - center, part);
    });
    sums.walls.add(force);
    sums.torque.add(torque);
  });
}

/// Adds the derivative of `weight` times the component of the stress on a plane of normal n: `gradient` is that of psi,
/// `pressure_slope` that of the pressure.
template <class At, std::size_t N>
void add_stress_derivative(const At& here, double weight, Vec3 gradient, double pressure_slope, Vec3 n, Vec3 direction,
                           std::array<double, N>& to) {
  const double along = weight * dot(n, direction), source = along * pressure_slope;
  const auto by_gradient =
      weight * dot(gradient, n) * direction + weight * dot(gradient, direction) * n - along * gradient;
  for (std::size_t k = 0; k < N; ++k) to[k] += dot(here.gradient[k], by_gradient) - source * here.value[k];
}

template <class Element>
std::vector<double> component_derivative(const Element& element, const par::Comm& comm, const State& state,
                                         std::span<const double> chi, std::uint64_t open_walls,
                                         const Component& component) {
  const auto& problem = state.problem;
  auto space = goal_space(element, state);
  using OfCell = std::array<double, GoalSpace<Element>::n_functions>;
  for (std::size_t c = 0; c < element.cells().size(); ++c) {
    if (is_constant(chi, element.cells()[c])) continue;
    const auto cell = element.cell(c);
    const auto cut = cell.field(chi), u = cell.field(state.u);
    OfCell of_cell{};
    cell.at_points([&](const auto& point) {
      const double z = point.position.z;
      const auto gradient = u.gradient(point) + Vec3{0, 0, problem.split_slope(z)};
      const double slope = problem.term.pressure_slope(u.at(point), problem.split_potential(z));
      add_stress_derivative(space.at(cell, point), -point.weight, gradient, slope, cut.gradient(point),
                            component.at(point.middle), of_cell);
    });
    space.add(c, of_cell);
  }
  if (!space.has_walls) open_walls = 0;
  at_open_walls(element, state, chi, open_walls, [&](const auto& face, const auto& cut, const auto& value) {
    const auto behind = face.behind(state.u);
    OfCell of_cell{};
    face.at_wall_points([&](const auto& point) {
      const auto gradient = behind.gradient(point) + Vec3{0, 0, face.split_slope(problem, point)};
      const double slope =
          problem.term.pressure_slope(interpolated(point.value, value), face.split_potential(problem, point));
      add_stress_derivative(space.behind(face, point), interpolated(point.value, cut) * point.area, gradient, slope,
                            point.normal, component.at(point.middle), of_cell);
    });
    space.add(at(element.domain.faces[face.number].cell), of_cell);
  });
  return space.total(comm);
}

template <class Element>
std::vector<double> component_remainder(const Element& element, const State& state, std::span<const double> chi,
                                        std::uint64_t open_walls, const Component& component) {
  const auto& problem = state.problem;
  const auto space = goal_space(element, state);
  const auto stress_of = [&](const ErrorAt& error, Vec3 n, Vec3 direction, double squares) {
    return dot(error.gradient, direction) * dot(error.gradient, n) - 0.5 * squares * dot(n, direction);
  };
  std::vector<double> result(element.cells().size(), 0);
  for (std::size_t c = 0; c < result.size(); ++c) {
    if (is_constant(chi, element.cells()[c])) continue;
    const auto cell = element.cell(c);
    const auto cut = cell.field(chi), u = cell.field(state.u);
    cell.at_points([&](const auto& point) {
      const auto error = space.error(c, space.at(cell, point));
      const double squares = squares_of(
          space, error, [&] { return problem.term.slope(u.at(point), problem.split_potential(point.position.z)); });
      result[c] -= point.weight * stress_of(error, cut.gradient(point), component.at(point.middle), squares);
    });
  }
  if (!space.has_walls) open_walls = 0;
  at_open_walls(element, state, chi, open_walls, [&](const auto& face, const auto& cut, const auto& value) {
    const auto c = at(element.domain.faces[face.number].cell);
    face.at_wall_points([&](const auto& point) {
      const auto error = space.error(c, space.behind(face, point));
      const double squares = squares_of(space, error, [&] {
        return problem.term.slope(interpolated(point.value, value), face.split_potential(problem, point));
      });
      result[c] += interpolated(point.value, cut) * point.area *
                   stress_of(error, point.normal, component.at(point.middle), squares);
    });
  });
  return result;
}

}  // namespace

VolumeForm volume_form(const par::Comm& comm, const State& state, std::span<const double> chi, std::uint64_t open_walls,
                       Vec3 center) {
  VolumeSums sums;
  with_element(state.problem.domain, [&](const auto& element) {
    add_cut_off_cells(element, state, chi, center, sums);
    add_open_walls(element, state, chi, open_walls, center, sums);
  });
  VolumeForm result;
  result.through_walls = sums.walls.total(comm);
  result.force = sums.force.total(comm) + result.through_walls;
  result.torque = sums.torque.total(comm);
  return result;
}

std::vector<double> volume_form_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                           std::uint64_t open_walls, const Component& component) {
  return with_element(state.problem.domain, [&](const auto& element) {
    return component_derivative(element, comm, state, chi, open_walls, component);
  });
}

std::vector<double> volume_form_remainder(const State& state, std::span<const double> chi, std::uint64_t open_walls,
                                          const Component& component) {
  return with_element(state.problem.domain, [&](const auto& element) {
    return component_remainder(element, state, chi, open_walls, component);
  });
}

}  // namespace pamr::poisson_boltzmann
