// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/part_runs.hpp"

#include <algorithm>

#include "pamr/base/contract.hpp"

namespace pamr::adapt {

namespace {

constexpr int block_bits = 8;  ///< of cells in a block of the index of runs

}  // namespace

PartRuns::PartRuns(const MeshPart& before, const Coverage& coverage) : before_(before), coverage_(coverage) {
  const auto n_before = static_cast<LocalId>(before.whole_cell.size());
  place_of_before_.reserve(at(n_before));
  LocalId next = 0;
  const auto append_before = [&](LocalId cell) {
    for (; next < n_before && before.whole_cell[at(next)] < cell; ++next) {
      place_of_before_.push_back(n_cells_);
      append(false, next, 1);
    }
  };
  for (const auto [first, count] : coverage.ranges) {
    append_before(first);
    append(true, first, count);
  }
  append_before(static_cast<LocalId>(coverage.of_cell.size()));
  PAMR_ENSURES(next == n_before);
  for (const auto& run : runs_)
    if (run.is_of_whole) of_whole_.push_back(run);
  const auto n_blocks = (coverage.of_cell.size() >> block_bits) + 1;
  block_to_run_.reserve(n_blocks);
  LocalId run = 0;
  for (std::size_t block = 0; block < n_blocks; ++block) {
    while (at(run) < of_whole_.size() &&
           of_whole_[at(run)].from + of_whole_[at(run)].count <= static_cast<LocalId>(block << block_bits))
      ++run;
    block_to_run_.push_back(run);
  }
}

void PartRuns::append(bool is_of_whole, LocalId from, LocalId count) {
  if (!runs_.empty() && runs_.back().is_of_whole == is_of_whole && runs_.back().from + runs_.back().count == from)
    runs_.back().count += count;
  else
    runs_.push_back({is_of_whole, from, n_cells_, count});
  n_cells_ += count;
}

LocalId PartRuns::place_of(LocalId cell) const {
  if (coverage_.of_cell[at(cell)] == Coverage::held) {
    const auto& cells = before_.whole_cell;
    return place_of_before_[at(std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin())];
  }
  auto run = at(block_to_run_[at(cell >> block_bits)]);
  while (of_whole_[run].from + of_whole_[run].count <= cell) ++run;
  return of_whole_[run].to + (cell - of_whole_[run].from);
}

}  // namespace pamr::adapt
