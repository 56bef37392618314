// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

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
/// All are positively oriented when the parent is.
namespace pamr::mesh {

/// True when the bits describe a cell that can be: a kind, template index, child number and no bits besides.
bool is_well_formed(Lineage lineage);

/// The same family's cell number `child`.
constexpr Lineage sibling(Lineage lineage, int child) {
  return Lineage((lineage.bits() & ~0x60U) | static_cast<std::uint32_t>(child) << 5U);
}

/// "1:4 closure cell of face 2, child 3, level 1": for messages.
std::string describe(Lineage lineage);

/// Corners of the face opposite `face`, ascending.
constexpr std::array<std::size_t, 3> ascending_corners(std::size_t face) {
  std::array<std::size_t, 3> corner{};
  for (std::size_t i = 0, k = 0; i < 4; ++i)
    if (i != face) corner[k++] = i;
  return corner;
}

/// The parent's corners, from the cells of its family in template order (2 or 4, any kind of node number).
template <class Id>
std::array<Id, 4> parent_corners(Lineage first, std::span<const std::array<Id, 4>> family) {
  auto parent = family[0];
  if (first.kind() == FamilyKind::edge) {
    const auto j = static_cast<std::size_t>(tet::edge_to_corner[static_cast<std::size_t>(first.index())][1]);
    parent[j] = family[1][j];
  } else if (first.kind() == FamilyKind::face) {
    const auto [a, b, c] = ascending_corners(static_cast<std::size_t>(first.index()));
    parent[b] = family[1][b];
    parent[c] = family[2][c];
  }
  return parent;
}

/// True when the cells of a family, in template order, share their nodes as the template says.
template <class Id>
bool fits_template(Lineage first, std::span<const std::array<Id, 4>> family) {
  const auto parent = parent_corners(first, family);
  if (first.kind() == FamilyKind::edge) {
    const auto corner = tet::edge_to_corner[static_cast<std::size_t>(first.index())];
    const auto i = static_cast<std::size_t>(corner[0]), j = static_cast<std::size_t>(corner[1]);
    auto child_0 = parent, child_1 = parent;
    child_0[j] = child_1[i] = family[0][j];
    return family[0] == child_0 && family[1] == child_1;
  }
  if (first.kind() == FamilyKind::face) {
    const auto [a, b, c] = ascending_corners(static_cast<std::size_t>(first.index()));
    const auto ab = family[0][b], ac = family[0][c], bc = family[1][c];
    std::array<std::array<Id, 4>, 4> child{parent, parent, parent, parent};
    child[0][b] = child[1][a] = child[3][c] = ab;
    child[0][c] = child[2][a] = child[3][b] = ac;
    child[1][c] = child[2][b] = child[3][a] = bc;
    return child[0] == family[0] && child[1] == family[1] && child[2] == family[2] && child[3] == family[3];
  }
  return true;
}

}  // namespace pamr::mesh
