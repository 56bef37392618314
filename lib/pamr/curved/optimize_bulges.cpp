// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/optimize_bulges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/par/sum_at_items.hpp"

namespace pamr::curved {

namespace {

using geometry::Vec3;
using Vectors = std::vector<Vec3>;  // one of each edge

/// Cells below this mean ratio count as flat: rounding decides on their volume.
constexpr double min_mean_ratio = 1e-6;
/// Of the norm of the gradient, what is left of it in the residual of a Newton direction.
constexpr double direction_tolerance = 0.1;
constexpr int max_direction_steps = 100, max_newton_steps = 30, max_halvings = 20;
/// Share of the decrease that the gradient promises, for a step to be taken (Armijo).
constexpr double sufficient_decrease = 1e-4;

struct Stage {
  Distortion distortion;
  double tolerance = 0;  ///< of the change of every cell's energy, relative
};
constexpr std::array<Stage, 5> stages{
    {{{1, 1}, 0.3}, {{0.2, 1}, 0.3}, {{0.03, 1}, 0.3}, {{1e-3, 2}, 0.3}, {{1e-3, 3}, 1e-2}}};

struct Problem {
  const BulgeZone& zone;
  par::Exchange exchange;
  std::vector<StraightCell> cell;
  std::vector<std::uint8_t> is_mine;  ///< edges that no lower rank holds
  std::vector<std::uint8_t> is_free;  ///< bits of each cell's edges

  std::size_t n_cells() const { return cell.size(); }
  /// Of a cell's free bulges.
  std::size_t n_components(std::size_t c) const { return 3 * at(std::popcount(unsigned{is_free[c]})); }
  CellBulges bulges(std::size_t c, const Vectors& of_edge) const {
    CellBulges result;
    for (std::size_t e = 0; e < 6; ++e) result[e] = of_edge[at(zone.cell_to_edge[c][e])];
    return result;
  }
  const SampledRows* residual(std::size_t c) const { return zone.walls.of(c); }
};

/// The part of a vector that an edge's freedom allows; exact along axes and in planes across them.
Vec3 allowed(const Freedom& freedom, Vec3 v) {
  switch (freedom.kind) {
    case Freedom::Kind::any:
      return v;
    case Freedom::Kind::in_plane:
      return v - dot(v, freedom.direction) * freedom.direction;
    case Freedom::Kind::along_line:
      return dot(v, freedom.direction) * freedom.direction;
    case Freedom::Kind::none:
      break;
  }
  return {};
}

/// Throws `Error` if a cell of this rank cannot be optimized. Local.
void check_values(const BulgeZone& zone, const std::vector<StraightCell>& cell) {
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto& p = zone.corner[c][0];
    if (!(cell[c].mean_ratio >= min_mean_ratio) || !std::isfinite(cell[c].inverse_determinant))
      throw Error(fmt::format("curved walls: expected cells with a volume, found mean ratio {:.3g} at ({}, {}, {})",
                              cell[c].mean_ratio, p.x, p.y, p.z));
    const auto* residual = zone.walls.of(c);
    const bool is_residual_finite =
        residual == nullptr || std::all_of(residual->begin(), residual->end(), [](const auto& rows) {
          return std::all_of(rows.begin(), rows.end(), geometry::is_finite);
        });
    if (!is_residual_finite)
      throw Error(fmt::format("curved walls: expected finite derivatives, found others in the cell at ({}, {}, {})",
                              p.x, p.y, p.z));
  }
  for (const auto& b : zone.bulge)
    if (!is_finite(b))
      throw Error(fmt::format("curved walls: expected finite bulges, found ({}, {}, {})", b.x, b.y, b.z));
}

/// True if something is not straight on any rank. Collective.
bool is_curved(const par::Comm& comm, const BulgeZone& zone) {
  const auto is_nonzero = [](Vec3 v) { return !(v == Vec3{}); };
  bool here = std::any_of(zone.bulge.begin(), zone.bulge.end(), is_nonzero);
  for (const auto& cell : zone.walls.rows)
    for (const auto& rows : cell) here = here || std::any_of(rows.begin(), rows.end(), is_nonzero);
  return comm.any(here);
}

/// Collective.
double smallest_ratio(const par::Comm& comm, const Problem& problem, const Vectors& bulge) {
  double smallest = 1;
  for (std::size_t c = 0; c < problem.n_cells(); ++c)
    smallest = std::min(smallest, smallest_mean_ratio(problem.cell[c], problem.bulges(c, bulge), problem.residual(c)));
  return comm.min(smallest);
}

/// For each edge the allowed part of the sum over its cells, on all ranks. Collective: two exchanges.
Vectors sum_at_edges(const Problem& problem, const std::vector<CellBulges>& of_cell) {
  const auto& zone = problem.zone;
  const auto sum = par::sum_at_items<3>(problem.exchange, zone.bulge.size(), [&](const auto& add) {
    for (std::size_t c = 0; c < of_cell.size(); ++c)
      for (std::size_t e = 0; e < 6; ++e)
        add(zone.cell_to_edge[c][e], {of_cell[c][e].x, of_cell[c][e].y, of_cell[c][e].z});
  });
  Vectors result;
  result.reserve(sum.size());
  for (std::size_t i = 0; i < sum.size(); ++i)
    result.push_back(allowed(zone.freedom[i], {sum[i][0], sum[i][1], sum[i][2]}));
  return result;
}

/// Collective: a reduction.
double inner(const par::Comm& comm, const Problem& problem, const Vectors& a, const Vectors& b) {
  par::ExactSum sum;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (problem.is_mine[i] != 0) sum.add(dot(a[i], b[i]));
  return par::reproducible_sums(comm, {&sum, 1}).front();
}

/// Quadratic model of the energy of all cells. One for all steps: its arrays are large.
struct Model {
  std::vector<double> energy;  ///< of each cell
  /// Of each cell its gradient, later its part of a product; 0 for edges that are not free.
  std::vector<CellBulges> of_cell;
  Vectors gradient;             ///< of the sum over all cells, what is allowed of it
  std::vector<double> hessian;  ///< the cells' upper triangles, one after the other
  /// Of each edge the inverse of its block of the matrix, within what is allowed.
  std::vector<Symmetric3> inverse;
};

Vec3 product(const Symmetric3& m, Vec3 v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
          m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

/// The inverse of a positive definite block, within what is allowed. In the other directions the block's mean stands in
/// its place, so that it can be inverted as a whole.
Symmetric3 invert(const Freedom& freedom, const Symmetric3& block) {
  const double mean = (block[0] + block[3] + block[5]) / 3;
  std::array<Vec3, 3> column;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 axis;
    axis[k] = 1;
    const Vec3 inside = allowed(freedom, axis);
    column[k] = allowed(freedom, product(block, inside)) + mean * (axis - inside);
  }
  const Vec3 x = cross(column[1], column[2]), y = cross(column[2], column[0]), z = cross(column[0], column[1]);
  const double factor = 1 / dot(x, column[0]);
  return {factor * x.x, factor * x.y, factor * x.z, factor * y.y, factor * y.z, factor * z.z};
}

/// Makes the model at some bulges. Collective: four exchanges.
void linearize(const Problem& problem, const Distortion& distortion, const Vectors& bulge, Model& model) {
  const auto& zone = problem.zone;
  std::size_t n_entries = 0;
  for (std::size_t c = 0; c < problem.n_cells(); ++c) n_entries += triangle_size(problem.n_components(c));
  model.energy.clear();
  model.of_cell.clear();
  model.hessian.clear();
  model.hessian.reserve(n_entries);
  for (std::size_t c = 0; c < problem.n_cells(); ++c) {
    const auto of_cell =
        bulge_model(problem.cell[c], problem.bulges(c, bulge), problem.residual(c), distortion, problem.is_free[c]);
    model.energy.push_back(of_cell.energy);
    model.of_cell.push_back(of_cell.gradient);
    const auto begin = of_cell.hessian.begin();
    model.hessian.insert(model.hessian.end(), begin,
                         begin + static_cast<std::ptrdiff_t>(triangle_size(problem.n_components(c))));
  }
  model.gradient = sum_at_edges(problem, model.of_cell);
  const auto block = par::sum_at_items<6>(problem.exchange, zone.bulge.size(), [&](const auto& add) {
    const double* h = model.hessian.data();
    for (std::size_t c = 0; c < problem.n_cells(); ++c) {
      const auto n = problem.n_components(c);
      const auto entry = [&](std::size_t i, std::size_t j) { return h[triangle_entry(n, i, j)]; };
      std::size_t i = 0;
      for (unsigned rest = problem.is_free[c]; rest != 0; rest &= rest - 1, i += 3)
        add(zone.cell_to_edge[c][at(std::countr_zero(rest))],
            {entry(i, i), entry(i, i + 1), entry(i, i + 2), entry(i + 1, i + 1), entry(i + 1, i + 2),
             entry(i + 2, i + 2)});
      h += triangle_size(n);
    }
  });
  model.inverse.clear();
  for (std::size_t i = 0; i < block.size(); ++i) model.inverse.push_back(invert(zone.freedom[i], block[i]));
}

/// The model's matrix times a vector. Collective: two exchanges.
Vectors product(const Problem& problem, Model& model, const Vectors& v) {
  const double* row = model.hessian.data();  // from the diagonal on
  for (std::size_t c = 0; c < problem.n_cells(); ++c) {
    std::array<double, 18> in{}, out{};
    std::size_t n = 0;
    for (unsigned rest = problem.is_free[c]; rest != 0; rest &= rest - 1) {
      const Vec3 bulge = v[at(problem.zone.cell_to_edge[c][at(std::countr_zero(rest))])];
      for (std::size_t k = 0; k < 3; ++k) in[n++] = bulge[k];
    }
    for (std::size_t i = 0; i < n; row += n - i, ++i) {
      double sum = row[0] * in[i];
      for (std::size_t j = i + 1; j < n; ++j) {
        sum += row[j - i] * in[j];
        out[j] += row[j - i] * in[i];
      }
      out[i] += sum;
    }
    const double* next = out.data();
    for (unsigned rest = problem.is_free[c]; rest != 0; rest &= rest - 1, next += 3)
      model.of_cell[c][at(std::countr_zero(rest))] = {next[0], next[1], next[2]};
  }
  return sum_at_edges(problem, model.of_cell);
}

Vectors precondition(const Problem& problem, const Model& model, const Vectors& v) {
  Vectors result(v.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    result[i] = allowed(problem.zone.freedom[i], product(model.inverse[i], v[i]));
  return result;
}

void add_multiple(Vectors& to, double factor, const Vectors& v) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * v[i];
}

/// Nearly the minimum of the model, as a change of the bulges, by conjugate gradients with blocks of edges as
/// preconditioner. Collective.
Vectors newton_direction(const par::Comm& comm, const Problem& problem, Model& model) {
  Vectors result(model.gradient.size()), rest(model.gradient.size());
  add_multiple(rest, -1, model.gradient);
  auto direction = precondition(problem, model, rest);
  double left = inner(comm, problem, rest, direction);
  const double enough = direction_tolerance * direction_tolerance * left;
  for (int step = 0; step < max_direction_steps && left > enough; ++step) {
    const auto image = product(problem, model, direction);
    const double curvature = inner(comm, problem, direction, image);
    if (!(curvature > 0)) break;
    add_multiple(result, left / curvature, direction);
    add_multiple(rest, -left / curvature, image);
    auto next = precondition(problem, model, rest);
    const double left_before = std::exchange(left, inner(comm, problem, rest, next));
    add_multiple(next, left / left_before, direction);
    direction = std::move(next);
  }
  return result;
}

/// Bulges after a step, and the largest relative change of a cell's energy, over the length of the step so that short
/// ones do not look like the end; no bulges if no step helps.
struct Step {
  Vectors bulge;
  double change = 0;
};

/// Halves the step until the energy falls enough. Collective: a reduction of a sum for each step tried.
Step search(const par::Comm& comm, const Problem& problem, const Distortion& distortion, Model& model, double energy,
            const Vectors& bulge) {
  const auto direction = newton_direction(comm, problem, model);
  const double slope = inner(comm, problem, model.gradient, direction);
  if (!std::isfinite(slope))
    throw Error(
        "curved walls: expected bulges of about the size of cells, found some so large that derivatives of "
        "the energy overflow");
  if (slope == 0) return {};
  std::vector<double> of_cell(problem.n_cells());
  double length = 1;
  for (int i = 0; i < max_halvings; ++i, length *= 0.5) {
    auto trial = bulge;
    add_multiple(trial, length, direction);
    for (std::size_t c = 0; c < of_cell.size(); ++c)
      of_cell[c] = bulge_energy(problem.cell[c], problem.bulges(c, trial), problem.residual(c), distortion);
    if (!(par::reproducible_sum(comm, of_cell) <= energy + sufficient_decrease * length * slope)) continue;
    double change = 0;
    for (std::size_t c = 0; c < of_cell.size(); ++c)
      change = std::max(change, std::abs(of_cell[c] - model.energy[c]) / model.energy[c]);
    return {std::move(trial), comm.max(change) / length};
  }
  return {};
}

/// Changes the bulges to what makes the energy smallest and returns the number of steps. Collective.
int minimize(const par::Comm& comm, const Problem& problem, const Stage& stage, Model& model, Vectors& bulge) {
  for (int step = 0; step < max_newton_steps; ++step) {
    linearize(problem, stage.distortion, bulge, model);
    const double energy = par::reproducible_sum(comm, model.energy);
    if (!std::isfinite(energy))
      throw Error(
          "curved walls: expected bulges of about the size of cells, found some so large that the energy "
          "overflows");
    auto [next, change] = search(comm, problem, stage.distortion, model, energy, bulge);
    if (change == 0) return step;
    bulge = std::move(next);
    if (change < stage.tolerance) return step + 1;
  }
  return max_newton_steps;
}

}  // namespace

Bulges optimize_bulges(const par::Comm& comm, const BulgeZone& zone) {
  const auto n_cells = zone.corner.size();
  PAMR_EXPECTS(zone.cell_to_edge.size() == n_cells);
  PAMR_EXPECTS(zone.walls.cell_to_rows.empty() || zone.walls.cell_to_rows.size() == n_cells);
  PAMR_EXPECTS(zone.freedom.size() == zone.bulge.size());
  Problem problem{zone, par::Exchange(comm, zone.shared), {}, {}, {}};
  for (const auto& corner : zone.corner) problem.cell.push_back(prepare(corner));
  for (const auto& edges : zone.cell_to_edge) {
    unsigned is_free = 0;
    for (std::size_t e = 0; e < 6; ++e) is_free |= zone.freedom[at(edges[e])].kind != Freedom::Kind::none ? 1U << e : 0;
    problem.is_free.push_back(static_cast<std::uint8_t>(is_free));
  }
  par::agree(comm, [&] { check_values(zone, problem.cell); });
  problem.is_mine = par::held_first_here(problem.exchange, zone.bulge.size());

  Bulges result;
  result.bulge = zone.bulge;
  result.smallest_before = smallest_ratio(comm, problem, result.bulge);
  if (zone.bends_straight_cells || is_curved(comm, zone)) {
    Model model;
    for (const auto& stage : stages) result.iterations += minimize(comm, problem, stage, model, result.bulge);
  }
  result.smallest = smallest_ratio(comm, problem, result.bulge);
  return result;
}

}  // namespace pamr::curved
