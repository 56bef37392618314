// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

/// All that a cell carries from one step to the next: through checkpoints, to other ranks, and to the cells of an
/// adapted mesh. In a table of cells (`Section`) it is one row: particles, (sigma c_r)_max, remainder, temperature,
/// separation, collisions, block, squares of blocks, volume, F_num, for each species the sums of n, velocity, square
/// and rotation, in a gas with species of different weights the energy deficit, and in one that vibrates for each
/// species the sum of vibration.
struct CellRow {
  std::int64_t particles = 0;
  CellCollisions collisions;
  double block = 0, square_of_blocks = 0;  ///< see `CellSamples`
  double volume = 0;                       ///< m3
  double fnum = 0;                         ///< molecules that a particle of weight 1 stands for
  std::vector<CellSums> sums;              ///< of each species
};

/// The columns of a table of cells.
struct CellColumns {
  std::size_t n_species = 1;
  bool is_weighted = false;
  bool is_vibrating = false;

  static constexpr std::size_t volume = 8, fnum = 9, sums = 10, words_of_sums = 6;
  std::size_t deficit() const { return sums + words_of_sums * n_species; }
  std::size_t vibration() const { return deficit() + (is_weighted ? 1 : 0); }
  std::size_t width() const { return vibration() + (is_vibrating ? n_species : 0); }
};
CellColumns columns_of(const Gas& gas);

/// The row of a cell of this rank, whose particles are sorted. Local.
CellRow row_of(const Flow& flow, std::size_t cell);
/// Gives the cell what the row holds, its particles apart. Local.
void put(const CellRow& row, std::size_t cell, Flow& flow);

/// The words of a row behind `words`. Local.
void append(const CellRow& row, const CellColumns& columns, std::vector<std::uint64_t>& words);
/// The reverse; `words`: `columns.width()` of them. Local.
CellRow cell_row(const std::uint64_t* words, const CellColumns& columns);

}  // namespace pamr::dsmc
