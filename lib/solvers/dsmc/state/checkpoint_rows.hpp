// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/particles.hpp"

/// The rows of a checkpoint's tables (docs/tools/pamr-dsmc.md).
namespace pamr::dsmc {

/// particles: id, species (low half) and last partner (high half), position, velocity, rotational energy, and in a gas
/// that vibrates the levels.
constexpr std::size_t particle_words(bool is_vibrating) { return is_vibrating ? 10 : 9; }
/// Particles that a rank sends at a time.
inline constexpr std::size_t particles_of_round = std::size_t{1} << 14U;

inline std::uint64_t word(double value) { return std::bit_cast<std::uint64_t>(value); }
inline std::uint64_t word(std::int64_t value) { return std::bit_cast<std::uint64_t>(value); }
inline double real(std::uint64_t bits) { return std::bit_cast<double>(bits); }
inline std::int64_t integer(std::uint64_t bits) { return std::bit_cast<std::int64_t>(bits); }

inline std::uint32_t species_of(const std::uint64_t* row) { return static_cast<std::uint32_t>(row[1]); }

/// A particle from its row, its cell not set.
inline Particle particle_from(const std::uint64_t* row, bool is_vibrating) {
  Particle p;
  p.id = row[0];
  p.species = species_of(row);
  p.partner = static_cast<std::uint32_t>(row[1] >> 32U);
  p.position = {real(row[2]), real(row[3]), real(row[4])};
  p.velocity = {real(row[5]), real(row[6]), real(row[7])};
  p.rotation = real(row[8]);
  if (is_vibrating) p.levels = static_cast<std::uint32_t>(row[9]);
  return p;
}

/// How many there are in each cell, of particles sorted by cell.
inline std::vector<std::int64_t> particles_of_cells(const Particles& particles) {
  const auto begin = particles.begin();
  std::vector<std::int64_t> count;
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) count.push_back(begin[c + 1] - begin[c]);
  return count;
}

/// Walks along particles that lie cell by cell, `count` of them in each.
class InOrderOfCells {
 public:
  struct Place {
    std::size_t cell = 0;
    std::int64_t in_cell = 0;
  };

  explicit InOrderOfCells(std::vector<std::int64_t> count) : count_(std::move(count)) {}

  /// All of them.
  std::int64_t size() const { return std::accumulate(count_.begin(), count_.end(), std::int64_t{0}); }
  /// Where the next `n` are.
  std::vector<Place> take(std::size_t n) {
    std::vector<Place> places;
    places.reserve(n);
    for (; places.size() < n; ++next_.in_cell) {
      while (next_.in_cell == count_[next_.cell]) next_ = {next_.cell + 1, 0};
      places.push_back(next_);
    }
    return places;
  }

 private:
  std::vector<std::int64_t> count_;
  Place next_;
};

}  // namespace pamr::dsmc
