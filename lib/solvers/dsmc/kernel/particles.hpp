// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// One particle, outside of `Particles`.
struct Particle {
  Vec3 position;        ///< m
  Vec3 velocity;        ///< m/s
  double rotation = 0;  ///< rotational energy, J
  std::uint64_t id = 0;
  LocalId cell = 0;
  std::uint32_t species = 0;
  std::uint32_t partner = 0;  ///< tag of its last collision partner; 0: none
  std::uint32_t levels = 0;   ///< of its vibration, a word of `levels`
};

/// The value by which `Particle::partner` refers to a particle: the low 32 bits of its id, plus 1.
inline std::uint32_t tag_of(std::uint64_t id) { return static_cast<std::uint32_t>(id) + 1; }

/// A rank's particles as a structure of arrays: 76 bytes each, 80 with vibration, plus 12 for sorting. `cell` is `gone`
/// for particles that have left; `sort_by_cell` removes them.
class Particles {
 public:
  static constexpr LocalId gone = -1;

  std::vector<double> x, y, z, u, v, w;
  std::vector<double> rotation;
  std::vector<std::uint64_t> id;
  std::vector<LocalId> cell;
  std::vector<std::uint32_t> species, partner;
  std::vector<std::uint32_t> levels;  ///< empty unless they vibrate

  Particles() = default;
  explicit Particles(bool vibrate) : vibrate_(vibrate) {}
  /// Whether they have levels of vibration; without them all are on level 0.
  bool vibrate() const { return vibrate_; }
  std::uint32_t levels_of(std::size_t i) const { return vibrate_ ? levels[i] : 0; }
  std::size_t size() const { return x.size(); }
  Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Vec3 velocity(std::size_t i) const { return {u[i], v[i], w[i]}; }
  Particle get(std::size_t i) const {
    return {position(i), velocity(i), rotation[i], id[i], cell[i], species[i], partner[i], levels_of(i)};
  }
  /// Room for `n` in all. Without it arrays grow by a sixteenth at a time, and are copied each time.
  void reserve(std::size_t n);
  void append(const Particle& particle);
  void clear();

  /// Removes particles that are gone and sorts the rest by cell and, within a cell, by id. Afterwards the particles of
  /// cell c are `begin()[c] .. begin()[c+1]`. Those of one id, which are copies, all stay, in any order. Counting sort,
  /// O(particles + cells). Local.
  void sort_by_cell(LocalId n_cells);
  std::span<const std::uint32_t> begin() const { return begin_; }

  /// Memory reserved by all arrays, bytes.
  std::size_t bytes() const;

 private:
  struct Row {
    std::uint64_t id = 0;
    std::uint32_t row = 0;
  };
  void order_by_id(std::size_t begin, std::size_t end);
  /// What all arrays have room for. Sorting exchanges their memory, so that one may have more than another.
  std::size_t capacity() const;

  bool vibrate_ = false;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> order_;
  std::vector<double> spare_;
  std::vector<Row> new_;
};

}  // namespace pamr::dsmc
