// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "solvers/poisson_boltzmann/fem/elements.hpp"
#include "solvers/poisson_boltzmann/fem/state.hpp"
#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"

/// The functions that a goal is differentiated by, and the error of the solution as far as it is known: of first order
/// those of the element and what recovered gradients say, of second order those of third (`CubicFunctions`) and
/// `CubicCorrection`.
namespace pamr::poisson_boltzmann {

/// The error of u at a point.
struct ErrorAt {
  geometry::Vec3 gradient;
  double value = 0;
};

/// Collects a derivative cell by cell and face by face. `at` and `behind` are the functions with their gradients at a
/// point of a cell, and at one of a face as the cell behind it sees it.
template <class Element>
class GoalSpace;

template <>
class GoalSpace<LinearElement> {
 public:
  static constexpr bool has_walls = false;    ///< derivatives contain what open walls give
  static constexpr bool knows_value = false;  ///< of the error, and not its gradient alone
  static constexpr std::size_t n_functions = 4;
  struct At {
    std::array<double, 4> value;
    std::array<geometry::Vec3, 4> gradient;
  };

  explicit GoalSpace(const State& state) : state_(state), value_(state.problem.domain.point.size(), 0) {}

  At at(const LinearElement::Cell& cell, const LinearElement::Point& point) const {
    return {point.value, cell.gradients()};
  }
  At behind(const LinearElement::Face& face, const LinearElement::Face::Point& point) const {
    return {face.values_behind(point), face.cell().gradients()};
  }
  void add(std::size_t cell, const std::array<double, 4>& of_cell) {
    const auto& nodes = state_.problem.domain.mesh->cell_to_node[cell];
    for (std::size_t k = 0; k < 4; ++k) value_[pamr::at(nodes[k])] += of_cell[k];
  }
  /// Adds an amount at a point of the rule for walls.
  template <class Point>
  void add_on_face(std::size_t face, const Point& point, double amount) {
    const auto& nodes = state_.problem.domain.faces[face].node;
    for (std::size_t k = 0; k < 3; ++k) value_[pamr::at(nodes[k])] += amount * point.value[k];
  }
  ErrorAt error(std::size_t cell, const At& here) const {
    return {interpolated(here.value, state_.problem.domain.recovery_nodes(cell), state_.recovered) -
            state_.cell_gradient[cell]};
  }
  double error_on_face(std::size_t, std::size_t) const { return 0; }
  std::vector<double> total(const par::Comm& comm) {
    state_.problem.domain.nodes.sum_copies(comm, value_);
    return std::move(value_);
  }

 private:
  const State& state_;
  std::vector<double> value_;
};

template <>
class GoalSpace<QuadraticElement> {
 public:
  static constexpr bool has_walls = true, knows_value = true;
  static constexpr std::size_t n_functions = n_cubic;

  explicit GoalSpace(const State& state)
      : state_(state), functions_(state.cubic->functions()), value_(functions_.all.n_nodes(), 0) {}

  CubicAt at(const QuadraticElement::Cell&, const QuadraticElement::Point& point) const {
    return cubic_at(point.placed, point.value, cubic_points()[point.index]);
  }
  CubicAt behind(const QuadraticElement::Face& face, const QuadraticElement::Face::Point& point) const {
    const auto of_cell = face.point_behind(point);
    return cubic_at(face.placed_behind(of_cell), of_cell.value, cubic_point(of_cell.barycentric));
  }
  void add(std::size_t cell, const OfCubicCell<double>& of_cell) {
    for (std::size_t k = 0; k < n_cubic; ++k)
      value_[pamr::at(functions_.cell_to_function[cell][k])] += functions_.sign(cell, k) * of_cell[k];
  }
  template <class Point>
  void add_on_face(std::size_t face, const Point& point, double amount) {
    const auto shape = functions_.face_values(face, point.index);
    for (std::size_t k = 0; k < shape.size(); ++k)
      value_[pamr::at(functions_.face_to_function[face][k])] += amount * shape[k];
  }
  ErrorAt error(std::size_t cell, const CubicAt& here) const {
    const auto value = functions_.values(cell, state_.cubic->error());
    return {gradient_of(here, value), interpolated(here.value, value)};
  }
  /// At a point of the rule for walls; 0 of first order.
  double error_on_face(std::size_t face, std::size_t point) const {
    return functions_.on_face(face, functions_.face_values(face, point), state_.cubic->error());
  }
  std::vector<double> total(const par::Comm& comm) {
    functions_.all.sum_copies(comm, value_);
    return std::move(value_);
  }

 private:
  const State& state_;
  const CubicFunctions& functions_;
  std::vector<double> value_;
};

template <class Element>
GoalSpace<Element> goal_space(const Element&, const State& state) {
  return GoalSpace<Element>(state);
}

/// |grad e|^2 and, where e itself is known, f'(psi) e^2: twice what an error adds to the energy. `slope()` is f'(psi).
template <class Space, class Slope>
double squares_of(const Space&, const ErrorAt& error, const Slope& slope) {
  double result = squared_norm(error.gradient);
  if constexpr (Space::knows_value) result += slope() * error.value * error.value;
  return result;
}

}  // namespace pamr::poisson_boltzmann
