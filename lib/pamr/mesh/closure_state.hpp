// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pamr/mesh/closure_state_table.hpp"
#include "pamr/mesh/family_states.hpp"

/// The 271 ways to replace a base cell by a closure family: all triangulations of a tetrahedron for the sets of one to
/// five marked edges that are conforming with their neighbors, and no node inside. They are enumerated by
/// scripts/closure_states.py. A way is named by its state:
/// 0 nothing; 1 + e: 1:2 on edge e; 7 + f: 1:4 on face f; from 11 on the others, ordered by their marks (bit e: edge
/// e), then by the cuts of their faces with two marks (face 0 first; from the edge of the smaller number first), then
/// by their inner edge (none, then between the midpoints of edges 0 and 5, 1 and 4, 2 and 3).
namespace pamr::mesh {

/// The nodes of a family's cells by code: 0..3 the corners of the parent, 4 + e the middle of its edge e.
struct FamilyTemplate {
  int n_children = 0;
  std::array<std::array<std::int8_t, 4>, max_family_size> child_to_node{};
};

struct ClosureState {
  std::uint8_t mask = 0;  ///< marked edges
  std::uint8_t cuts = 0;  ///< bit f: face f has two marks and is cut from the marked edge of the larger number
  int inner_edge = -1;    ///< d: from the midpoint of edge d to that of edge 5 - d; -1: there is none
  FamilyTemplate family;
};

namespace detail {

constexpr auto make_closure_states() {
  std::array<ClosureState, closure_rows.size()> states{};
  for (std::size_t s = 0; s < states.size(); ++s) {
    const auto& row = closure_rows[s];
    states[s] = {row.mask, row.cuts, row.inner_edge, {}};
    auto& family = states[s].family;
    std::size_t slot = 0;
    for (const char* code = row.children; *code != '\0'; ++code) {
      if (*code == ' ') continue;
      family.child_to_node[slot / 4][slot % 4] = static_cast<std::int8_t>(*code - '0');
      ++slot;
    }
    family.n_children = static_cast<int>(slot / 4);
  }
  return states;
}

}  // namespace detail

/// By state.
inline constexpr auto closure_states = detail::make_closure_states();

/// How the cells of a family of that state lie in their parent. Pre: there is such a state.
constexpr const FamilyTemplate& family_template(int state) {
  return closure_states[static_cast<std::size_t>(state)].family;
}

}  // namespace pamr::mesh
