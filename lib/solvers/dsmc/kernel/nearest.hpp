// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/dsmc/kernel/near_filter.hpp"
#include "solvers/dsmc/kernel/particles.hpp"

namespace pamr::dsmc {

/// Finds nearest neighbors among the particles of one cell. A few hundred are compared several at a time in single
/// precision, and the nearest of these in double precision. More are sorted into a grid of boxes with about one each,
/// so that a search visits only a few. The answer is the same. Local.
class NearestInCell {
 public:
  /// Takes the `n` particles starting at `begin`, which must not move until the next call. `n_searches`: expected
  /// number of searches, which decides what preparation is worth its cost. O(n), for few searches O(1).
  void start(const Particles& particles, std::uint32_t begin, std::uint32_t n, std::int64_t n_searches);

  /// The particle nearest to particle `first`, except those at the same position and the one with the tag `excluded`;
  /// of equally near ones the first; if there is none, the first other particle of the cell. Indices count from
  /// `begin`. Only copies of a particle share its position: a transferred flow may have them. They fly together, and as
  /// partners they would never collide.
  std::uint32_t find(std::uint32_t first, std::uint32_t excluded);

 private:
  enum class Way : std::uint8_t { one_by_one, filter, grid };
  struct Best {
    double distance;  ///< squared
    std::uint32_t particle;
  };
  struct Member {
    Vec3 position;
    std::uint32_t tag, particle;
  };
  void look_at(std::uint32_t k, const Vec3& here, std::uint32_t excluded, Best& best) const;
  void look_at_all(const Vec3& here, std::uint32_t excluded, Best& best) const;
  void look_through_filter(std::uint32_t first, const Vec3& here, std::uint32_t excluded, Best& best);
  void look_around(const Vec3& here, std::uint32_t excluded, Best& best) const;
  bool make_grid();
  /// The boxes whose number along some side differs by more than `inner` and by at most `outer` from the middle's.
  struct Shell {
    std::array<int, 3> middle;
    int inner, outer;
  };
  void look_at_shell(const Shell& shell, const Vec3& here, std::uint32_t excluded, Best& best) const;
  std::array<int, 3> box_of(const Vec3& position) const;
  std::size_t number_of(int x, int y, int z) const;

  const Particles* particles_ = nullptr;
  std::uint32_t begin_ = 0, n_ = 0;
  Way way_ = Way::one_by_one;
  NearFilter filter_;
  std::array<double, 3> low_{};
  double side_ = 1;  ///< of a box, m
  std::array<int, 3> boxes_{1, 1, 1};
  std::vector<std::uint32_t> first_;  ///< members of box b: first_[b] to first_[b + 1]
  std::vector<Member> member_;        ///< rows of boxes along x lie side by side
};

}  // namespace pamr::dsmc
