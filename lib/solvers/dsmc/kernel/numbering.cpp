// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/numbering.hpp"

#include <utility>

#include "pamr/par/exchange.hpp"

namespace pamr::dsmc {

Numbering number_along_cells(const par::Comm& comm, GlobalId n_cells, std::span<const GlobalId> cell,
                             std::span<const std::int64_t> count) {
  auto block = par::scatter_rows<std::int64_t>(comm, n_cells, count, 1, cell);
  std::int64_t here = 0;
  for (const auto n : block) here += n;
  auto next = comm.exclusive_sum(here);
  for (auto& n : block) {
    const auto first = next;
    next += n;
    n = first;
  }
  return {par::fetch_rows<std::int64_t>(comm, n_cells, block, 1, cell), comm.sum(here)};
}

}  // namespace pamr::dsmc
