// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/budget.hpp"

#include <cmath>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::mark {

namespace {

/// Fewest cells that can come of these marks, whatever the closure: eight of a cell or closure family with a mark, one
/// of each other that may not be coarsened. Collective.
std::int64_t fewest_cells(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> marks,
                          std::span<const std::uint8_t> may_go) {
  std::int64_t n = 0;
  for (LocalId c = 0; c < mesh.n_cells();) {
    const auto lineage = mesh.lineage[pamr::at(c)];
    const auto end = c + (lineage.is_removable() ? lineage.family_size() : 1);
    bool is_marked = false, stays = false;
    for (; c < end; ++c) {
      is_marked = is_marked || marks[pamr::at(c)] != 0;
      stays = stays || may_go[pamr::at(c)] == 0;
    }
    n += is_marked ? 8 : stays ? 1 : 0;
  }
  return comm.sum(n);
}

/// What a request gives when it is made stricter by 2 to the power of `exponent`.
struct Trial {
  double exponent = 0;
  Applied applied;
  std::int64_t cells = 0;
};

/// Makes trials, collectively.
class Trials {
 public:
  Trials(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request, Budget& budget)
      : comm_(&comm), mesh_(&mesh), request_(&request), budget_(&budget) {}

  Trial at(double exponent) {
    return measured(exponent, apply(*comm_, *mesh_, scaled(*request_, std::exp2(exponent)), budget_->known));
  }
  Trial measured(double exponent, Applied applied) const {
    keep_below_level(*mesh_, mesh::max_level, applied.indicator);
    const auto marks = marks_of(applied.indicator);
    auto cells = fewest_cells(*comm_, *mesh_, marks, applied.may_go);
    if (cells <= budget_->max_cells) cells = budget_->predicted_cells(marks, applied.may_go);
    return {exponent, std::move(applied), cells};
  }

 private:
  const par::Comm* comm_;
  const mesh::DistMesh* mesh_;
  const Request* request_;
  Budget* budget_;  ///< gets the errors that are recovered
};

}  // namespace

std::vector<std::uint8_t> marks_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              std::span<const double> indicator, Exact<std::int64_t> max_cells,
                                              const Prediction& predicted_cells) {
  auto best = mark::marks_of(indicator);
  std::int64_t too_many = mark::count_marked(comm, best);
  const std::vector<std::uint8_t> all_may_go(best.size(), 1);
  const auto fits_in = [&](std::span<const std::uint8_t> marks) {
    return fewest_cells(comm, mesh, marks, all_may_go) <= max_cells && predicted_cells(marks) <= max_cells;
  };
  if (too_many == 0 || fits_in(best)) return best;
  best.assign(best.size(), 0);
  for (std::int64_t fits = 0; too_many - fits > 1;) {
    const std::int64_t middle = fits + (too_many - fits) / 2;
    auto marks = mark::strongest(comm, mesh, indicator, middle);
    if (fits_in(marks)) {
      fits = middle;
      best = std::move(marks);
    } else {
      too_many = middle;
    }
  }
  return best;
}

Choice choose_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request,
                            const Applied& applied, Budget budget) {
  constexpr double last_exponent = 64;
  const std::int64_t max_cells = budget.max_cells;
  Trials trials(comm, mesh, request, budget);
  const auto is_enough = [&](const Trial& trial) {
    return trial.cells <= max_cells &&
           static_cast<double>(trial.cells) >= smallest_part_of_budget * static_cast<double>(max_cells);
  };
  const auto chosen = [](Trial trial) {
    return Choice{marks_of(trial.applied.indicator), std::move(trial.applied.may_go), std::exp2(trial.exponent)};
  };
  // Many cells of one value, or criteria without a value: as many of them as fit, beside what is coarsened.
  const auto chosen_in_part = [&](Trial trial, std::span<const double> indicator) {
    auto choice = chosen(std::move(trial));
    choice.marks = marks_within_budget(comm, mesh, indicator, max_cells, [&](std::span<const std::uint8_t> marks) {
      return budget.predicted_cells(marks, choice.may_go);
    });
    return choice;
  };
  auto fits = trials.measured(0, applied);
  if (is_enough(fits) || (fits.cells <= max_cells && !budget.fill)) return chosen(std::move(fits));
  Trial too_many = fits;
  if (fits.cells <= max_cells) {
    for (double e = -1; too_many.cells <= max_cells && e >= -last_exponent; e *= 2) {
      too_many = trials.at(e);
      if (too_many.cells <= max_cells) fits = too_many;
    }
    if (too_many.cells <= max_cells) return chosen(std::move(fits));
  } else {
    for (double e = 1; fits.cells > max_cells && e <= last_exponent; e *= 2) {
      if (e > 1) too_many = fits;
      fits = trials.at(e);
    }
    if (fits.cells > max_cells) return chosen_in_part(fits, fits.applied.indicator);
  }
  // The loosest of those that fit: where the worst cells are split for the best ones, not only where nothing happens.
  constexpr double fine_enough = 0.01;
  constexpr int max_halvings = 24;
  for (int i = 0; i < max_halvings; ++i) {
    if (is_enough(fits) && std::fabs(too_many.exponent - fits.exponent) < fine_enough) break;
    auto middle = trials.at(0.5 * (fits.exponent + too_many.exponent));
    (middle.cells <= max_cells ? fits : too_many) = std::move(middle);
  }
  return is_enough(fits) ? chosen(std::move(fits)) : chosen_in_part(fits, too_many.applied.indicator);
}

}  // namespace pamr::mark
