// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"
#include "solvers/dsmc/kernel/wide_sum.hpp"

namespace pamr::dsmc {

/// Particles, momentum and energy that have passed each surface (patches, then planes), of each species, each way: in
/// fixed point, so that the sums depend neither on the order nor on the ranks. Momentum and energy are those in the
/// frame of the mesh, times the species' weight; energy is translational and
/// internal.
class FluxTally {
 public:
  enum class Way : std::uint8_t {
    out,  ///< out of the gas; of a plane: along its normal
    in
  };
  /// Sums over the particles of one species that crossed a surface in one direction.
  struct Row {
    std::int64_t n = 0;             ///< particles
    std::array<WideSum, 4> sums{};  ///< momentum, energy; units of `SurfaceTally`

    void add(const SurfaceTally::Sums& fresh);
  };
  /// n; low and high of each sum.
  static constexpr std::size_t words_of_row = 9;

  FluxTally() = default;
  /// `units`: what momentum and energy are measured in.
  FluxTally(const Gas& gas, std::size_t n_surfaces, const SurfaceTally& units);

  void add(std::size_t surface, Way way, std::size_t species, Vec3 velocity, double internal) {
    const auto& unit = unit_[species];
    auto& sums = fresh_[row_of(surface, species, way, unit_.size())];
    ++n_fresh_;
    ++sums.hits;
    sums.momentum[0] += SurfaceTally::fixed(unit.momentum * velocity.x);
    sums.momentum[1] += SurfaceTally::fixed(unit.momentum * velocity.y);
    sums.momentum[2] += SurfaceTally::fixed(unit.momentum * velocity.z);
    sums.energy += SurfaceTally::fixed(unit.translation * geometry::squared_norm(velocity) + unit.internal * internal);
  }
  /// Particles that were added. Local.
  std::int64_t count(std::size_t surface, Way way, std::size_t species) const {
    const auto row = row_of(surface, species, way, unit_.size());
    return row_[row].n + fresh_[row].hits;
  }
  /// Index of the row of a surface, a species and a direction.
  static std::size_t row_of(std::size_t surface, std::size_t species, Way way, std::size_t n_species) {
    return 2 * (surface * n_species + species) + static_cast<std::size_t>(way);
  }

  /// To be called after each step: the sums of a step do not overflow, those of many would.
  void fold_if_many() {
    if (n_fresh_ >= fold_after) fold();
  }
  /// All rows as words, by surface, species and way. They add up over the ranks. Local.
  std::vector<std::int64_t> words() const;
  /// The reverse. Local.
  void set_words(std::span<const std::int64_t> words);
  std::size_t n_words() const { return words_of_row * fresh_.size(); }
  void clear();

 private:
  static constexpr std::int64_t fold_after = std::int64_t{1} << 14U;
  /// Units per kg m/s and J of a particle.
  struct Unit {
    double momentum = 0;     ///< per m/s
    double translation = 0;  ///< per m2/s2
    double internal = 0;     ///< per J
  };
  void fold();

  std::vector<Unit> unit_;                 ///< of each species
  std::vector<SurfaceTally::Sums> fresh_;  ///< not in `row_` yet
  std::vector<Row> row_;
  std::int64_t n_fresh_ = 0;
};

/// The row at these words.
FluxTally::Row flux_row(std::span<const std::int64_t> words, std::size_t row);

}  // namespace pamr::dsmc
