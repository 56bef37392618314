// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace pamr::mesh {

/// How a cell came about. `regular`: a level-0 cell or a child of 1:8. `edge`: a closure cell of 1:2. `face`: a closure
/// cell of 1:4.
enum class FamilyKind : std::uint8_t { regular = 0, edge = 1, face = 2 };

/// Lineage of a cell, packed: bits 0-1 family kind; bits 2-4 template index (edge 0..5 of `edge`, face 0..3 of `face`,
/// 0 otherwise); bits 5-6 child number in template order (0..1 of `edge`, 0..3 of `face`; 0 for regular);
/// bit 7 broken (the family is no longer whole, its parent cannot be rebuilt); bits 8-15 level of the base cell
/// (the cell itself when regular, its parent when a closure cell). Higher bits are zero. No ids in it.
class Lineage {
 public:
  constexpr Lineage() = default;
  constexpr explicit Lineage(std::uint32_t bits) : bits_(bits) {}
  constexpr Lineage(FamilyKind kind, int index, int child, int level)
      : bits_(static_cast<std::uint32_t>(kind) | static_cast<std::uint32_t>(index) << 2U |
              static_cast<std::uint32_t>(child) << 5U | static_cast<std::uint32_t>(level) << 8U) {}

  constexpr std::uint32_t bits() const { return bits_; }
  constexpr FamilyKind kind() const { return static_cast<FamilyKind>(bits_ & 3U); }
  constexpr int index() const { return static_cast<int>(bits_ >> 2U & 7U); }
  constexpr int child() const { return static_cast<int>(bits_ >> 5U & 3U); }
  constexpr bool is_broken() const { return (bits_ & 0x80U) != 0; }
  constexpr int level() const { return static_cast<int>(bits_ >> 8U & 0xffU); }
  constexpr bool is_closure() const { return kind() != FamilyKind::regular; }
  /// A member of a whole family, whose parent can be rebuilt.
  constexpr bool is_removable() const { return is_closure() && !is_broken(); }
  /// Number of cells of its family; 1 for a regular cell.
  constexpr int family_size() const { return kind() == FamilyKind::regular ? 1 : kind() == FamilyKind::edge ? 2 : 4; }
  constexpr Lineage broken() const { return Lineage(bits_ | 0x80U); }

  friend constexpr bool operator==(Lineage, Lineage) = default;

 private:
  std::uint32_t bits_ = 0;
};

}  // namespace pamr::mesh
