// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/options.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// Marks of one rank while they grow to their fixed point: every mark is set in all own cells of its arc at once, and
/// the cells it touches wait in a list until their rule has been applied. Local; `close` adds the exchange.
class Propagation {
 public:
  /// `kept[c]`: the cell's family is not taken back (n_cells, or empty: none). Marks what the flags say.
  Propagation(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags, std::span<const std::uint8_t> kept,
              QualityControl policy);

  /// Applies the rules until nothing changes on this rank.
  void settle();
  /// Marks an edge in every cell of its arc.
  void mark(LocalId cell, int edge);
  bool is_marked(LocalId cell, int edge) const { return (marks_[at(cell)] >> edge & 1) != 0; }

  /// First members of the families that have to change, ascending.
  std::vector<LocalId> hit_families() const;
  /// Moves the marks out, one byte a cell.
  std::vector<EdgeMask> take_marks() &&;

 private:
  static constexpr EdgeMask waiting = 0x40;
  static constexpr EdgeMask family_is_red = 0x80;  ///< on the first member

  bool is_removable(LocalId cell) const;
  void start_from_flags(std::span<const std::uint8_t> flags);
  void set_mark(LocalId cell, int edge);
  void add_marks(LocalId cell, EdgeMask wanted);
  void prefetch_cell(LocalId cell) const;
  void prefetch_round(LocalId cell) const;
  void prefetch_behind(LocalId cell) const;
  void apply_rule(LocalId cell);
  void apply_family_rule(LocalId first);
  void make_red(LocalId first, int state);
  geometry::TetPoints parent_corners(LocalId first, int state) const;

  const mesh::DistMesh& mesh_;
  std::span<const std::uint8_t> kept_;
  QualityControl policy_;
  std::vector<EdgeMask> marks_;
  std::vector<LocalId> waiting_;
};

}  // namespace pamr::refine
