// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "pamr/mesh/closure_state.hpp"
#include "pamr/mesh/lineage.hpp"
#include "pamr/mesh/tet.hpp"

/// Closure families, the cells that replace one base cell. With m_xy the middle of corners x and y:
///
/// 1:2 on edge (i,j): child 0 is the parent with m_ij in place of corner j, child 1 with m_ij in place of corner i.
///
/// 1:4 on face f, a < b < c the corners other than f:   slot   a     b     c     f
///            c                                     child 0   a     m_ab  m_ac  f
///           / \                                    child 1   m_ab  b     m_bc  f
///       m_ac---m_bc                                child 2   m_ac  m_bc  c     f
///         / \ / \                                  child 3   m_bc  m_ac  m_ab  f
///        a--m_ab--b
///
/// All others, with 3 to 7 cells: `closure_state.hpp`. All are positively oriented when the parent is.
namespace pamr::mesh {

/// True when the bits describe a cell that can be: a state and child that are there, a path that is no longer than the
/// level, broken only what is a closure cell without known ancestors, and no other bits.
bool is_well_formed(Lineage lineage);

/// The same family's cell number `child`.
constexpr Lineage sibling(Lineage lineage, int child) {
  const auto other = lineage.bits() - static_cast<std::uint64_t>(lineage.child()) + static_cast<std::uint64_t>(child);
  return Lineage(other);
}

/// True when a cell can be the next one of the same tree, where the cells of a tree (a root and all that was split of
/// it) follow each other as refining numbers them: members of a family, then the next child of the nearest ancestor
/// that has one. Looks at what both know of their ancestors only.
bool follows_in_tree(Lineage before, Lineage cell);

/// "1:4 closure cell of face 2, child 3, level 1": for messages.
std::string describe(Lineage lineage);

/// Corners of the face opposite `face`, ascending.
constexpr std::array<std::size_t, 3> ascending_corners(std::size_t face) {
  std::array<std::size_t, 3> corner{};
  for (std::size_t i = 0, k = 0; i < 4; ++i)
    if (i != face) corner[k++] = i;
  return corner;
}

/// The parent's corners, from the cells of its family in template order (2 to 7, any kind of node number).
template <class Id>
std::array<Id, 4> parent_corners(Lineage first, std::span<const std::array<Id, 4>> family) {
  const auto& shape = family_template(first.state());
  std::array<Id, 4> parent{};
  for (std::size_t child = 0; child < family.size(); ++child)
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (const auto code = static_cast<std::size_t>(shape.child_to_node[child][slot]); code < 4)
        parent[code] = family[child][slot];
  return parent;
}

/// True when the cells of a family, in template order, share their nodes as the template says.
template <class Id>
bool fits_template(Lineage first, std::span<const std::array<Id, 4>> family) {
  const auto& shape = family_template(first.state());
  std::array<Id, 4 + tet::n_edges> node{};
  for (std::size_t child = 0; child < family.size(); ++child)
    for (std::size_t slot = 0; slot < 4; ++slot)
      node[static_cast<std::size_t>(shape.child_to_node[child][slot])] = family[child][slot];
  bool fits = true;
  for (std::size_t child = 0; child < family.size(); ++child)
    for (std::size_t slot = 0; slot < 4; ++slot)
      fits = fits && node[static_cast<std::size_t>(shape.child_to_node[child][slot])] == family[child][slot];
  return fits;
}

}  // namespace pamr::mesh
