// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/budget.hpp"

namespace pamr::mark {

std::vector<std::uint8_t> marks_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              std::span<const double> indicator, std::int64_t max_cells,
                                              const Prediction& predicted_cells) {
  auto best = mark::marks_of(indicator);
  std::int64_t too_many = mark::count_marked(comm, best);
  if (too_many == 0 || predicted_cells(best) <= max_cells) return best;
  best.assign(best.size(), 0);
  for (std::int64_t fits = 0; too_many - fits > 1;) {
    const std::int64_t middle = fits + (too_many - fits) / 2;
    auto marks = mark::strongest(comm, mesh, indicator, middle);
    if (predicted_cells(marks) <= max_cells) {
      fits = middle;
      best = std::move(marks);
    } else {
      too_many = middle;
    }
  }
  return best;
}

}  // namespace pamr::mark
