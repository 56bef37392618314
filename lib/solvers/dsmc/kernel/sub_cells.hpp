// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/random.hpp"

namespace pamr::dsmc {

/// Sub-cells of one cell that last for one step: cubes with two particles each on average. The partner of a particle is
/// drawn in its sub-cell, which costs the same however many particles the cell has, while the nearest has to be looked
/// for. Local.
///
/// Source of transient sub-cells: G. A. Bird, M. A. Gallis, J. R. Torczynski, D. J. Rader, "Accuracy and efficiency of
/// the sophisticated direct simulation Monte Carlo algorithm for simulating noncontinuum gas flows", Phys. Fluids 21
/// (2009).
class SubCells {
 public:
  /// Whether they pay in a cell of `n` particles in which so many partners will be looked for. In smaller cells
  /// comparing all is faster (measured: docs/tools/pamr-dsmc.md).
  static bool are_worth(std::uint32_t n, std::int64_t n_searches) { return n > 240 && 8 * n_searches >= n; }

  /// Takes the `n` particles of a cell of this volume, which must not move until the next call. False when they are all
  /// in one place. O(n).
  bool start(const Particles& particles, std::uint32_t begin, std::uint32_t n, double volume);

  /// One of the particles in the sub-cell of `first`, each with the same chance, except those at its position (copies;
  /// see `NearestInCell::find`) and the one with the tag `excluded`; if there is none, the nearest of the sub-cells
  /// around; if there is none in all of the cell, its first other particle. Indices count from `begin`.
  std::uint32_t find(std::uint32_t first, std::uint32_t excluded, Random& random);

 private:
  bool is_eligible(std::uint32_t k, const Vec3& here, std::uint32_t excluded) const;
  std::uint32_t nearest_around(std::uint32_t first, std::uint32_t excluded) const;
  std::span<const std::uint32_t> members(std::size_t box) const {
    return std::span(member_).subspan(first_[box], first_[box + 1] - first_[box]);
  }

  const Particles* particles_ = nullptr;
  std::uint32_t begin_ = 0, n_ = 0;
  std::array<int, 3> boxes_{1, 1, 1};
  std::vector<std::uint32_t> box_;     ///< of each particle
  std::vector<std::uint32_t> first_;   ///< members of box b: first_[b] to first_[b + 1]
  std::vector<std::uint32_t> member_;  ///< in each box ascending
  std::vector<std::uint32_t> eligible_;
};

}  // namespace pamr::dsmc
