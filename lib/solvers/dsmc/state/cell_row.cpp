// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/cell_row.hpp"

#include "solvers/dsmc/state/checkpoint_rows.hpp"

namespace pamr::dsmc {

CellColumns columns_of(const Gas& gas) { return {gas.species.size(), gas.is_weighted, gas.is_vibrating}; }

CellRow row_of(const Flow& flow, std::size_t cell) {
  const auto begin = flow.particles.begin();
  const auto n_species = flow.setup().gas.species.size();
  const auto* sums = flow.cells.sums.data() + cell * n_species;
  return {begin[cell + 1] - begin[cell],     flow.collisions[cell],      flow.cells.block[cell],
          flow.cells.square_of_blocks[cell], flow.domain().volume[cell], flow.domain().fnum[cell],
          {sums, sums + n_species}};
}

void put(const CellRow& row, std::size_t cell, Flow& flow) {
  flow.collisions[cell] = row.collisions;
  flow.cells.block[cell] = row.block;
  flow.cells.square_of_blocks[cell] = row.square_of_blocks;
  for (std::size_t s = 0; s < row.sums.size(); ++s) flow.cells.sums[cell * row.sums.size() + s] = row.sums[s];
}

void append(const CellRow& row, const CellColumns& columns, std::vector<std::uint64_t>& words) {
  const auto& [particles, collisions, block, square_of_blocks, volume, fnum, sums] = row;
  const auto& [max_sigma_cr, remainder, temperature, separation, n_collisions, energy_deficit] = collisions;
  words.insert(words.end(), {word(particles), word(max_sigma_cr), word(remainder), word(temperature), word(separation),
                             word(n_collisions), word(block), word(square_of_blocks), word(volume), word(fnum)});
  std::vector<std::uint64_t> vibrations;
  for (const auto& [n, velocity, square, rotation, vibration] : sums) {
    words.insert(words.end(),
                 {word(n), word(velocity.x), word(velocity.y), word(velocity.z), word(square), word(rotation)});
    if (columns.is_vibrating) vibrations.push_back(word(vibration));
  }
  if (columns.is_weighted) words.push_back(word(energy_deficit));
  words.insert(words.end(), vibrations.begin(), vibrations.end());
}

CellRow cell_row(const std::uint64_t* w, const CellColumns& columns) {
  CellRow row{integer(w[0]),
              {real(w[1]), real(w[2]), real(w[3]), real(w[4]), integer(w[5]),
               columns.is_weighted ? real(w[columns.deficit()]) : 0},
              real(w[6]),
              real(w[7]),
              real(w[CellColumns::volume]),
              real(w[CellColumns::fnum]),
              {}};
  for (std::size_t s = 0; s < columns.n_species; ++s) {
    const auto* v = w + CellColumns::sums + s * CellColumns::words_of_sums;
    row.sums.push_back({real(v[0]),
                        {real(v[1]), real(v[2]), real(v[3])},
                        real(v[4]),
                        real(v[5]),
                        columns.is_vibrating ? real(w[columns.vibration() + s]) : 0});
  }
  return row;
}

}  // namespace pamr::dsmc
