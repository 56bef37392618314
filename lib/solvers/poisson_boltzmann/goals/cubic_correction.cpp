// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Conjugate gradients stop where the norm of the residual, scaled by the diagonal, has fallen by these factors for u
/// and for a dual solution: what is left of a goal's error is as their product.
constexpr double reduction = 0.001, dual_reduction = 0.01;
constexpr int max_iterations = 200;
/// What the last iterations gained in the squared energy norm bounds what is missing if as many more would gain less
/// than these, and so on. Source: M. R. Hestenes, E. Stiefel, J. Res. Nat. Bur. Standards 49 (1952), theorem 6:1.
constexpr std::size_t n_last = 5;

/// The excess of fourth order over second in front of a flat wall, for a layer of unit thickness and a cell of unit
/// height: the energies of the parts h^4 u""/1680 and h^2 u"/12 of Legendre polynomials, with u"" = k^2 u" by the
/// equation.
const double fourth_over_second = std::sqrt(20.0 / 6) * 12 / 1680;

constexpr std::size_t entry_of(std::size_t i, std::size_t j) { return i * (i + 1) / 2 + j; }

}  // namespace

CubicCorrection::CubicCorrection(const par::Comm& comm, const Problem& problem, std::span<const double> u)
    : problem_(problem),
      functions_(number_cubic(comm, problem.domain)),
      conditions_(cubic_conditions(comm, problem, functions_, u)),
      block_(functions_.cell_to_function.size()),
      right_(functions_.all.n_nodes(), 0),
      u_(u.begin(), u.end()) {
  for (std::size_t c = 0; c < block_.size(); ++c) add_cell(problem, c, u);
  for (std::size_t f = 0; f < problem.domain.faces.size(); ++f) add_face(problem, f, u);
  functions_.all.sum_copies(comm, right_);
  // Of the functions of second order the residual is that of Newton's method.
  for (std::size_t i = 0; i < problem.domain.point.size(); ++i) right_[i] = 0;
  diagonal_ = diagonal(comm);
  auto right = product(comm, conditions_.value);
  for (std::size_t i = 0; i < right.size(); ++i) right[i] = right_[i] - right[i];
  auto solved = solve(comm, std::move(right), reduction);
  error_ = std::move(solved.value);
  remaining_ = std::move(solved.residual);
  iterations_ = solved.iterations;
  rest_ = solved.rest;
  for (std::size_t i = 0; i < error_.size(); ++i) error_[i] += conditions_.value[i];
  auto all = error_;
  for (std::size_t i = 0; i < u_.size(); ++i) all[i] += u_[i];
  decay_ = decay_of(comm, all);
}

void CubicCorrection::add_cell(const Problem& problem, std::size_t cell, std::span<const double> u) {
  const QuadraticElement::Cell on(problem.domain, cell);
  const auto value = on.field(u);
  std::array<double, n_cubic*(n_cubic + 1) / 2> block{};
  std::array<double, 10> right{};
  on.at_points([&](const auto& point) {
    const auto at_point = cubic_at(point.placed, point.value, cubic_points()[point.index]);
    const auto& shape = at_point.value;
    const auto& slope = at_point.gradient;
    const double weight = point.weight, here = value.at(point), psi0 = problem.split_potential(point.position.z);
    const auto gradient = value.gradient(point);
    double source = problem.term.value(here, psi0);
    if (problem.input.manufactured) {
      const double psi = manufactured_potential(point.position);
      source -= psi + problem.term.value(psi, 0);
    }
    for (std::size_t k = 0; k < 10; ++k) right[k] -= weight * (dot(gradient, slope[10 + k]) + source * shape[10 + k]);
    const double stiffness = weight * problem.term.slope(here, psi0);
    for (std::size_t i = 0; i < n_cubic; ++i) {
      const auto along = weight * slope[i];
      const double mass = stiffness * shape[i];
      for (std::size_t j = 0; j <= i; ++j) block[entry_of(i, j)] += dot(along, slope[j]) + mass * shape[j];
    }
  });
  for (std::size_t i = 0; i < n_cubic; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      block_[cell][entry_of(i, j)] =
          static_cast<float>(functions_.sign(cell, i) * functions_.sign(cell, j) * block[entry_of(i, j)]);
  for (std::size_t k = 0; k < 10; ++k)
    right_[at(functions_.cell_to_function[cell][10 + k])] += functions_.sign(cell, 10 + k) * right[k];
}

void CubicCorrection::add_face(const Problem& problem, std::size_t face, std::span<const double> u) {
  const auto& domain = problem.domain;
  const auto& b = problem.boundary_of(domain.faces[face]);
  const bool is_far = b.condition == Condition::far_field, depends_on_u = is_far || b.condition == Condition::regulated;
  if (fixes_potential(b.condition)) return;
  const auto& function = functions_.face_to_function[face];
  const QuadraticElement::Face on(domain, face);
  const auto value = on.values(u);
  FaceBlock block{function, {}};
  on.at_points([&](const auto& point) {
    const auto shape = functions_.face_values(face, point.index);
    const double here = interpolated(point.value, value);
    double flux = given_flux(problem.input, problem.profile, b, point);
    double alpha = 0;  // minus the slope of the flux
    if (is_far) {
      alpha = far_field_coefficient(problem.input.spheres, point.middle, point.normal);
      flux -= alpha * here;
    } else {
      const double psi = here + problem.split_potential(point.position.z);
      if (depends_on_u) flux += b.charge_at(psi);
      alpha = -b.charge_slope_at(psi);
    }
    if (depends_on_u)
      for (std::size_t i = 0; i < 10; ++i)
        for (std::size_t j = 0; j < 10; ++j) block.entry[10 * i + j] += alpha * point.area * shape[i] * shape[j];
    for (std::size_t k = 6; k < 10; ++k) right_[at(function[k])] += flux * point.area * shape[k];
  });
  if (depends_on_u) face_block_.push_back(block);
}

std::vector<double> CubicCorrection::product(const par::Comm& comm, std::span<const double> x) const {
  std::vector<double> result(x.size(), 0);
  for (std::size_t c = 0; c < block_.size(); ++c) {
    const auto& function = functions_.cell_to_function[c];
    const auto& block = block_[c];
    OfCubicCell<double> from{}, to{};
    for (std::size_t k = 0; k < n_cubic; ++k) from[k] = x[at(function[k])];
    for (std::size_t i = 0; i < n_cubic; ++i) {
      double sum = 0;
      const double here = from[i];
      const float* row = &block[entry_of(i, 0)];
      for (std::size_t j = 0; j < i; ++j) {
        const double entry = row[j];
        sum += entry * from[j];
        to[j] += entry * here;
      }
      to[i] += sum + row[i] * here;
    }
    for (std::size_t k = 0; k < n_cubic; ++k) result[at(function[k])] += to[k];
  }
  for (const auto& [function, entry] : face_block_)
    for (std::size_t i = 0; i < 10; ++i)
      for (std::size_t j = 0; j < 10; ++j) result[at(function[i])] += entry[10 * i + j] * x[at(function[j])];
  functions_.all.sum_copies(comm, result);
  return result;
}

std::vector<double> CubicCorrection::diagonal(const par::Comm& comm) const {
  std::vector<double> result(right_.size(), 0);
  for (std::size_t c = 0; c < block_.size(); ++c)
    for (std::size_t k = 0; k < n_cubic; ++k)
      result[at(functions_.cell_to_function[c][k])] += block_[c][entry_of(k, k)];
  for (const auto& [function, entry] : face_block_)
    for (std::size_t i = 0; i < 10; ++i) result[at(function[i])] += entry[11 * i];
  functions_.all.sum_copies(comm, result);
  return result;
}

double CubicCorrection::dot_owned(const par::Comm& comm, std::span<const double> a, std::span<const double> b) const {
  double sum = 0;
  for (const auto i : functions_.all.owned()) sum += a[at(i)] * b[at(i)];
  const auto of_ranks = comm.all_gather(sum);
  return std::accumulate(of_ranks.begin(), of_ranks.end(), 0.0);
}

CubicCorrection::Solved CubicCorrection::solve(const par::Comm& comm, std::vector<double> right, double to) const {
  const auto n = right.size();
  Solved result{std::vector<double>(n, 0), std::move(right), 0, 0};
  std::array<double, n_last> gain{};
  auto& residual = result.residual;
  std::vector<double> scaled(n), direction(n, 0);
  const auto scale = [&] {
    for (std::size_t i = 0; i < n; ++i) scaled[i] = residual[i] / diagonal_[i];
  };
  for (std::size_t i = 0; i < n; ++i)
    if (conditions_.fixed[i] != 0) residual[i] = 0;
  scale();
  double size = dot_owned(comm, residual, scaled), last = 1;
  const double wanted = to * to * size;
  for (; size > wanted && result.iterations < max_iterations; ++result.iterations) {
    const double turn = result.iterations == 0 ? 0 : size / last;
    for (std::size_t i = 0; i < n; ++i) direction[i] = scaled[i] + turn * direction[i];
    const auto image = product(comm, direction);
    const double step = size / dot_owned(comm, direction, image);
    gain[static_cast<std::size_t>(result.iterations) % n_last] = step * size;
    for (std::size_t i = 0; i < n; ++i) {
      result.value[i] += step * direction[i];
      if (conditions_.fixed[i] == 0) residual[i] -= step * image[i];
    }
    scale();
    last = size;
    size = dot_owned(comm, residual, scaled);
  }
  result.rest = std::accumulate(gain.begin(), gain.end(), 0.0);
  return result;
}

OfCubicCell<double> CubicCorrection::of_cell(std::size_t cell, std::span<const double> x) const {
  OfCubicCell<double> value{};
  for (std::size_t k = 0; k < n_cubic; ++k) value[k] = x[at(functions_.cell_to_function[cell][k])];
  return value;
}

double CubicCorrection::product_of(std::size_t cell, const OfCubicCell<double>& a, const OfCubicCell<double>& b) const {
  double sum = 0;
  for (std::size_t i = 0; i < n_cubic; ++i) {
    for (std::size_t j = 0; j < i; ++j) sum += block_[cell][entry_of(i, j)] * (a[i] * b[j] + a[j] * b[i]);
    sum += block_[cell][entry_of(i, i)] * a[i] * b[i];
  }
  return sum;
}

std::vector<double> CubicCorrection::cell_energy(std::span<const double> x) const {
  std::vector<double> result(block_.size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    const auto value = of_cell(c, x);
    result[c] = std::max(0.0, product_of(c, value, value));
  }
  return result;
}

double CubicCorrection::fourth_of(std::size_t cell, std::span<const double> x) const {
  const auto& domain = problem_.domain;
  const auto shape = domain.shape(cell);
  const auto points = domain.points(cell);
  geometry::Vec3 gradient;
  double source = 0, size = 0;  // largest k^2 x and x: a wall in whose layer x is 0 has no part in k
  for (std::size_t k = 0; k < 4; ++k) {
    const auto node = at(functions_.cell_to_function[cell][k]);
    gradient += x[node] * shape.gradient[k];
    const double here = std::abs(x[node]);
    const double slope = problem_.term.slope(u_[node], problem_.split_potential(domain.point[node].z));
    source = std::max(source, here * slope);
    size = std::max(size, here);
  }
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const auto& point : points) {
    low = std::min(low, dot(gradient, point));
    high = std::max(high, dot(gradient, point));
  }
  const double squared = squared_norm(gradient), height = high - low;
  // At most 1, as that of third order over second: where a cell is many layers high, the series says nothing.
  return squared > 0 ? std::min(1.0, fourth_over_second * source / size * height * height / squared) : 0;
}

std::vector<double> CubicCorrection::decay_of(const par::Comm& comm, std::span<const double> x) const {
  std::vector<double> second(problem_.domain.point.size(), 0), third(second.size(), 0);
  for (std::size_t c = 0; c < block_.size(); ++c) {
    const auto value = of_cell(c, x);
    OfCubicCell<double> surplus{}, added{};
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = mesh::tet::edge_to_corner[e];
      surplus[4 + e] = value[4 + e] - 0.5 * (value[at(a)] + value[at(b)]);
    }
    std::copy(value.begin() + 10, value.end(), added.begin() + 10);
    const double of_second = product_of(c, surplus, surplus), of_third = product_of(c, added, added);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = at(functions_.cell_to_function[c][k]);
      second[node] += of_second;
      third[node] += of_third;
    }
  }
  problem_.domain.nodes.sum_copies(comm, second);
  problem_.domain.nodes.sum_copies(comm, third);
  std::vector<double> result(block_.size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    const double fourth = fourth_of(c, x);
    double below = 0, above = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      below += second[at(functions_.cell_to_function[c][k])];
      above += third[at(functions_.cell_to_function[c][k])];
    }
    const double ratio = above < below ? std::sqrt(above / below) : 1;
    result[c] = std::max(ratio, ratio > 0 ? fourth / ratio : 0);
  }
  return result;
}

Estimate CubicCorrection::estimate(const par::Comm& comm, std::span<const double> u) const {
  const auto& domain = problem_.domain;
  Estimate result;
  result.squared = cell_energy(error_);
  result.residual_squared.assign(result.squared.size(), 0);
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < result.squared.size(); ++c) {
    sums[0].add(result.squared[c]);
    const QuadraticElement::Cell cell(domain, c);
    const auto value = cell.field(u);
    double norm_squared = 0;
    cell.at_points([&](const auto& point) { norm_squared += point.weight * squared_norm(value.gradient(point)); });
    sums[1].add(norm_squared);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  result.total_squared = totals[0];
  result.norm_squared = totals[1];
  return result;
}

CubicGoalError CubicCorrection::goal_error(const par::Comm& comm, std::span<const double> w,
                                           std::span<const double> load) const {
  CubicGoalError result;
  result.rest = GoalRest(block_.size());
  auto& all = result.dual;
  all.assign(right_.size(), 0);
  std::copy(w.begin(), w.end(), all.begin());
  auto right = product(comm, all);
  for (std::size_t i = 0; i < right.size(); ++i)
    right[i] = i < w.size() ? 0 : (i < load.size() ? load[i] : 0) - right[i];
  result.correction = dot_owned(comm, right, error_);
  const auto dual = solve(comm, std::move(right), dual_reduction);
  result.correction += dot_owned(comm, remaining_, dual.value);
  result.rest.unsolved = std::sqrt(rest_ * dual.rest);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] += dual.value[i];
  result.decay = decay_of(comm, all);
  for (std::size_t c = 0; c < block_.size(); ++c) {
    const auto of_u = of_cell(c, error_), of_w = of_cell(c, dual.value);
    const double share = std::sqrt(std::max(0.0, product_of(c, of_u, of_u) * product_of(c, of_w, of_w)));
    const double rest = further_orders(decay_[c] * result.decay[c]);
    result.share.push_back(share);
    result.rest.add(c, rest * product_of(c, of_u, of_w), rest * share);
  }
  if (!problem_.input.linear || problem_.input.has_regulated()) add_curvature(comm, result);
  return result;
}

std::vector<double> CubicCorrection::of_curvature(std::span<const double> of_dual) const {
  const auto& domain = problem_.domain;
  std::vector<double> result(block_.size(), 0);
  for (std::size_t c = 0; c < block_.size() && !problem_.input.linear; ++c) {
    const QuadraticElement::Cell cell(domain, c);
    const auto value = cell.field(u_);
    const auto error = functions_.values(c, error_), dual = functions_.values(c, of_dual);
    cell.at_points([&](const auto& point) {
      const auto shape = cubic_at(point.placed, point.value, cubic_points()[point.index]).value;
      const double e = interpolated(shape, error), psi0 = problem_.split_potential(point.position.z);
      const double curvature = problem_.term.curvature(value.at(point), psi0);
      result[c] -= 0.5 * point.weight * curvature * e * e * interpolated(shape, dual);
    });
  }
  at_site_points(problem_, u_, [&](const SitePoint& point) {
    const auto shape = functions_.face_values(point.face, point.index);
    const double e = functions_.on_face(point.face, shape, error_), w = functions_.on_face(point.face, shape, of_dual);
    result[at(domain.faces[point.face].cell)] += 0.5 * point.area * point.site->curvature(point.psi) * e * e * w;
  });
  return result;
}

void CubicCorrection::add_curvature(const par::Comm& comm, CubicGoalError& to) const {
  const auto added = of_curvature(to.dual);
  std::array<par::ExactSum, 1> total;
  for (std::size_t c = 0; c < added.size(); ++c) {
    total[0].add(added[c]);
    to.rest.add_square(c, added[c], decay_[c]);
  }
  to.correction += par::reproducible_sums(comm, total)[0];
}

void CubicCorrection::add_energy_error(const par::Comm& comm, CubicGoalError& to) const {
  const auto of_u = cell_energy(error_);
  for (std::size_t c = 0; c < of_u.size(); ++c) {
    to.share[c] += 0.5 * of_u[c];
    const double rest = 0.5 * further_orders(decay_[c] * decay_[c]) * of_u[c];  // e3 and what follows are orthogonal
    to.rest.add(c, -rest, rest);
  }
  to.rest.unsolved += 0.5 * rest_;
  to.correction += 0.5 * par::reproducible_sum(comm, of_u) - dot_owned(comm, right_, error_);
}

}  // namespace pamr::poisson_boltzmann
