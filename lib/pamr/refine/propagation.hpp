// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/carried.hpp"
#include "pamr/refine/mapped_points.hpp"
#include "pamr/refine/options.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// Marks of one rank while they grow to their fixed point: every mark is set in all own cells of its arc at once, and
/// the cells it touches wait in a list until their rule has been applied. Local; `close` adds the exchange.
class Propagation {
 public:
  /// `requests`: a `Request` for each cell. `retained[c]`: the cell's family is not taken back (n_cells, or empty:
  /// none). `carried`: what is known already. Marks what the requests say.
  Propagation(const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
              std::span<const std::uint8_t> retained, const Options& options, const Carried& carried);

  /// Applies the rules until nothing changes on this rank. Returns the number of sweeps over the waiting cells.
  int settle();
  /// Marks an edge in every cell of its arc.
  void mark(LocalId cell, int edge);
  bool is_marked(LocalId cell, int edge) const { return (marks_[at(cell)] >> edge & 1) != 0; }

  /// First members of the families that have to change, ascending.
  std::vector<LocalId> touched_families() const;
  /// The marks of each cell, beside other bits.
  const std::vector<EdgeMask>& marks_and_more() const { return marks_; }
  /// Moves the marks out, one byte a cell.
  std::vector<EdgeMask> take_marks() &&;

 private:
  static constexpr EdgeMask waiting = 0x40;
  static constexpr EdgeMask family_is_red = 0x80;  ///< on the first member

  bool is_removable(LocalId cell) const;
  void start(std::span<const std::uint8_t> requests);
  void start_from(const Carried& carried, std::span<const std::uint8_t> requests);
  void start_family(LocalId cell, std::uint8_t request);
  void mark_from_behind(LocalId cell, int face);
  void mark_across(LocalId cell, int face);
  void wait(LocalId cell);
  void set_mark(LocalId cell, int edge);
  void add_marks(LocalId cell, EdgeMask wanted);
  void prefetch_cell(LocalId cell) const;
  void prefetch_around(LocalId cell) const;
  void prefetch_behind(LocalId cell) const;
  void apply_rule(LocalId cell);
  void apply_family_rule(LocalId first);
  void make_red(LocalId first, int state);
  BaseCorners parent_corners(LocalId first, int state) const;

  const mesh::DistMesh& mesh_;
  mesh::Level0View level0_;
  std::span<const std::uint8_t> retained_;
  const Options& options_;
  std::vector<EdgeMask> marks_;
  std::vector<LocalId> waiting_;
};

}  // namespace pamr::refine
