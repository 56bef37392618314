// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// True when the bits describe a cell that can be: a kind, template index, child number and no other bits.
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

/// The nodes of a family's cells by code: 0..3 the corners of the parent, 4 + e the middle of its edge e.
struct FamilyTemplate {
  int n_children = 0;
  std::array<std::array<std::int8_t, 4>, 4> child_to_node{};
};

namespace detail {

constexpr std::array<FamilyTemplate, tet::n_edges> make_edge_templates() {
  std::array<FamilyTemplate, tet::n_edges> templates{};
  for (std::size_t e = 0; e < templates.size(); ++e) {
    const auto [i, j] = tet::edge_to_corner[e];
    auto& [n_children, child] = templates[e];
    n_children = 2;
    child[0] = child[1] = {0, 1, 2, 3};
    child[0][static_cast<std::size_t>(j)] = child[1][static_cast<std::size_t>(i)] = static_cast<std::int8_t>(4 + e);
  }
  return templates;
}

constexpr std::array<FamilyTemplate, 4> make_face_templates() {
  std::array<FamilyTemplate, 4> templates{};
  for (std::size_t f = 0; f < templates.size(); ++f) {
    const auto corner = ascending_corners(f);
    auto& [n_children, child] = templates[f];
    n_children = 4;
    child.fill({0, 1, 2, 3});
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = k + 1; l < 3; ++l) {
        const auto middle = static_cast<std::int8_t>(4 + tet::edge_of[corner[k]][corner[l]]);
        child[k][corner[l]] = child[l][corner[k]] = child[3][corner[3 - k - l]] = middle;
      }
  }
  return templates;
}

inline constexpr auto edge_templates = make_edge_templates();
inline constexpr auto face_templates = make_face_templates();
inline constexpr FamilyTemplate regular_template{1, {{{0, 1, 2, 3}}}};

}  // namespace detail

/// How the cells of such a family lie in their parent. Pre: `kind` and `index` are of a well-formed lineage.
constexpr const FamilyTemplate& family_template(FamilyKind kind, int index) {
  const auto i = static_cast<std::size_t>(index);
  return kind == FamilyKind::edge   ? detail::edge_templates[i]
         : kind == FamilyKind::face ? detail::face_templates[i]
                                    : detail::regular_template;
}

/// The parent's corners, from the cells of its family in template order (2 or 4, any kind of node number).
template <class Id>
std::array<Id, 4> parent_corners(Lineage first, std::span<const std::array<Id, 4>> family) {
  const auto& shape = family_template(first.kind(), first.index());
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
  const auto& shape = family_template(first.kind(), first.index());
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
