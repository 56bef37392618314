// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/adapt/part/mesh_part.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::adapt {

/// Cells that follow each other, in the whole mesh or in the part before, and after it is widened.
struct Run {
  bool is_of_whole = false;
  LocalId from = 0, to = 0, count = 0;
};

/// The order of the cells of a part that is widened: runs of cells that are added, and those that it had.
class PartRuns {
 public:
  PartRuns(const MeshPart& before, const Coverage& coverage);

  const std::vector<Run>& all() const { return runs_; }
  LocalId n_cells() const { return n_cells_; }
  /// Of a cell of the part before.
  LocalId place_of_before(LocalId cell) const { return place_of_before_[at(cell)]; }
  /// Of a cell of the whole mesh that is held or added, or of what came of it first.
  LocalId place_of(LocalId cell) const;
  bool is_added(LocalId cell) const { return coverage_.of_cell[at(cell)] == Coverage::added; }
  bool has(LocalId cell) const { return coverage_.of_cell[at(cell)] != Coverage::outside; }

  /// Rows of the runs' cells, `width` items each.
  template <class T>
  std::vector<T> join(std::span<const T> of_whole, std::span<const T> of_before, std::size_t width = 1) const {
    std::vector<T> rows;
    reserve_array(rows, at(n_cells_) * width);
    for (const auto& run : runs_) {
      const auto from = (run.is_of_whole ? of_whole : of_before).subspan(at(run.from) * width, at(run.count) * width);
      rows.insert(rows.end(), from.begin(), from.end());
    }
    return rows;
  }

 private:
  void append(bool is_of_whole, LocalId from, LocalId count);

  const MeshPart& before_;
  const Coverage& coverage_;
  std::vector<Run> runs_;
  LocalId n_cells_ = 0;
  std::vector<LocalId> place_of_before_;  ///< of each cell of the part before
  std::vector<Run> of_whole_;             ///< runs of the whole mesh
  std::vector<LocalId> block_to_run_;     ///< the first of them that ends beyond the begin of a block
};

}  // namespace pamr::adapt
