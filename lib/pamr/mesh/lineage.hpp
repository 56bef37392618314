// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>

#include "pamr/mesh/family_states.hpp"

namespace pamr::mesh {

/// How a cell came about. `regular`: a level-0 cell or a child of 1:8. `edge`: a closure cell of 1:2. `face`: a closure
/// cell of 1:4. `other`: a closure cell of any other set of marked edges.
enum class FamilyKind : std::uint8_t { regular = 0, edge = 1, face = 2, other = 3 };

/// Largest level of a cell: cells of this level are not split 1:8 any more.
inline constexpr int max_level = 255;
/// Number of ancestors of which a cell can know the child numbers.
inline constexpr int max_known_depth = 14;

/// Lineage of a cell, packed into one word. No ids in it.
///
/// | bits  |        |                                                                                           |
/// |-------|--------|-------------------------------------------------------------------------------------------|
/// | 0-10  | code   | state of the closure family and child in it (`family_states.hpp`); 0: regular             |
/// | 11    | broken | the family is no longer whole, its parent cannot be rebuilt                               |
/// | 12-19 | level  | of the base cell: the cell itself when regular, its parent when a closure cell            |
/// | 20-62 | path   | child numbers (0-7) under 1:8 of the base cell, its parent, ..., 3 bits each, lowest first, |
/// |       |        | and a 1 above the last; 0: none is known                                                  |
/// | 63    |        | 0                                                                                         |
///
/// The path is no longer than the level, and may be shorter: cells of old files, and children of cells of broken
/// families, know fewer ancestors, and of more than `max_known_depth` the oldest are forgotten. So the last
/// `max_known_depth` splits can always be undone. The ancestor where the path ends is a root: as far as is known,
/// it came from nothing.
class Lineage {
 public:
  constexpr Lineage() = default;
  constexpr explicit Lineage(std::uint64_t bits) : bits_(bits) {}
  /// A cell without known ancestors. `index`: edge of `edge`, face of `face`, 0 of `regular`; not for `other`.
  constexpr Lineage(FamilyKind kind, int index, int child, int level)
      : Lineage(kind == FamilyKind::regular ? 0 : (kind == FamilyKind::edge ? 1 : first_face_state) + index, child,
                level, 0) {}
  /// A cell that is no closure cell and knows no ancestors.
  static constexpr Lineage regular(int level) { return {0, 0, level, 0}; }

  constexpr std::uint64_t bits() const { return bits_; }
  constexpr int code() const { return static_cast<int>(bits_ & code_mask); }
  constexpr bool is_broken() const { return (bits_ & broken_bit) != 0; }
  constexpr int level() const { return static_cast<int>(bits_ >> level_shift & 0xffU); }
  constexpr std::uint64_t path() const { return bits_ >> path_shift; }

  constexpr bool is_closure() const { return (bits_ & code_mask) != 0; }
  /// A member of a whole family, whose parent can be rebuilt.
  constexpr bool is_removable() const { return is_closure() && !is_broken(); }

  /// State by which its family was made, 0 for a regular cell.
  constexpr int state() const { return is_closure() ? member().state : 0; }
  /// Number in its family, 0 for a regular cell.
  constexpr int child() const { return is_closure() ? member().child : 0; }
  /// Number of cells of its family; 1 for a regular cell.
  constexpr int family_size() const { return is_closure() ? member().family_size : 1; }
  constexpr FamilyKind kind() const {
    const int s = state();
    return s == 0                                 ? FamilyKind::regular
           : s < first_face_state                 ? FamilyKind::edge
           : s < first_face_state + n_face_states ? FamilyKind::face
                                                  : FamilyKind::other;
  }
  /// Edge of `edge`, face of `face`, 0 of the others.
  constexpr int index() const {
    return kind() == FamilyKind::edge ? state() - 1 : kind() == FamilyKind::face ? state() - first_face_state : 0;
  }

  /// Number of ancestors that the base cell knows.
  constexpr int depth() const { return path() == 0 ? 0 : (static_cast<int>(std::bit_width(path())) - 1) / 3; }
  /// Number of the base cell among the eight children of its parent. Pre: `depth() > 0`.
  constexpr int child_number() const { return static_cast<int>(path() & 7U); }

  /// The base cell of a closure cell; a regular cell is its own.
  constexpr Lineage base() const { return Lineage(bits_ & ~(code_mask | broken_bit)); }
  /// The base cell that this cell is when it is split by itself: a closure cell then is a root.
  constexpr Lineage base_for_split() const { return is_closure() ? regular(level()) : *this; }
  /// Closure cell `child` of the state that replaces this base cell. Pre: a regular cell.
  constexpr Lineage closed(int state, int child) const {
    return Lineage(bits_ | static_cast<std::uint64_t>(first_code[static_cast<std::size_t>(state)] + child));
  }
  /// Child of 1:8. Pre: a regular cell of a level below `max_level`.
  constexpr Lineage red_child(int number) const {
    auto path = (this->path() == 0 ? 1U : this->path()) << 3U | static_cast<std::uint64_t>(number);
    if (path > max_path) path = (path & (path_end - 1)) | path_end;
    return {0, 0, level() + 1, path};
  }
  /// The cell of which this one is a child of 1:8. Pre: a regular cell, `depth() > 0`.
  constexpr Lineage red_parent() const { return {0, 0, level() - 1, depth() == 1 ? 0 : path() >> 3U}; }
  /// The same cell of a family that is not whole any more: a root.
  constexpr Lineage broken() const { return Lineage((bits_ & ~path_mask) | broken_bit); }

  friend constexpr bool operator==(Lineage, Lineage) = default;

  static constexpr std::uint64_t path_end = std::uint64_t{1} << (3 * max_known_depth);  ///< end of the longest path
  static constexpr std::uint64_t max_path = 2 * path_end - 1;

 private:
  static constexpr int first_face_state = 7, n_face_states = 4;
  static constexpr int level_shift = 12, path_shift = 20;
  static constexpr std::uint64_t code_mask = (1U << n_code_bits) - 1, broken_bit = 1U << n_code_bits;
  static constexpr std::uint64_t path_mask = ~std::uint64_t{0} << path_shift;

  constexpr Lineage(int state, int child, int level, std::uint64_t path)
      : bits_(static_cast<std::uint64_t>(first_code[static_cast<std::size_t>(state)] + child) |
              static_cast<std::uint64_t>(level) << level_shift | path << path_shift) {}
  constexpr const FamilyMember& member() const { return member_of_code[static_cast<std::size_t>(code())]; }

  std::uint64_t bits_ = 0;
};

}  // namespace pamr::mesh
