// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/particles.hpp"

/// The rows of a checkpoint's tables (docs/tools/pamr-dsmc.md).
namespace pamr::dsmc {

/// particles: id, species (low half) and last partner (high half), position, velocity, rotational energy.
inline constexpr std::size_t particle_words = 9;
/// cells: particles, (sigma c_r)_max, remainder, temperature, separation, collisions, block, squares of blocks, volume
/// and F_num, then for each species the sums of n, velocity, square and rotation.
inline constexpr std::size_t fixed_cell_words = 10, species_words = 6;
inline constexpr std::size_t volume_word = 8, fnum_word = 9;

/// Words of a row of cells. In a gas with species of different weights the energy deficit comes last.
inline std::size_t cell_words(std::size_t n_species, bool is_weighted) {
  return fixed_cell_words + species_words * n_species + (is_weighted ? 1 : 0);
}
inline std::size_t cell_words(const Gas& gas) { return cell_words(gas.species.size(), gas.is_weighted); }

inline std::uint64_t word(double value) { return std::bit_cast<std::uint64_t>(value); }
inline std::uint64_t word(std::int64_t value) { return std::bit_cast<std::uint64_t>(value); }
inline double real(std::uint64_t bits) { return std::bit_cast<double>(bits); }
inline std::int64_t integer(std::uint64_t bits) { return std::bit_cast<std::int64_t>(bits); }

inline std::uint32_t species_of(const std::uint64_t* row) { return static_cast<std::uint32_t>(row[1]); }

/// A particle from its row, its cell not set.
inline Particle particle_from(const std::uint64_t* row) {
  Particle p;
  p.id = row[0];
  p.species = species_of(row);
  p.partner = static_cast<std::uint32_t>(row[1] >> 32U);
  p.position = {real(row[2]), real(row[3]), real(row[4])};
  p.velocity = {real(row[5]), real(row[6]), real(row[7])};
  p.rotation = real(row[8]);
  return p;
}

/// Numbers of the rows of things of which cell i has `count[i]` from `first[i]` on.
inline std::vector<GlobalId> consecutive(const std::vector<std::int64_t>& first,
                                         const std::vector<std::int64_t>& count) {
  std::vector<GlobalId> rows;
  for (std::size_t c = 0; c < first.size(); ++c)
    for (std::int64_t i = 0; i < count[c]; ++i) rows.push_back(first[c] + i);
  return rows;
}

}  // namespace pamr::dsmc
