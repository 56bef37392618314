// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

/// The numbering of a tetrahedron's corners, edges and faces, here and nowhere else.
///
///            3            edge 0: 0-1   edge 3: 1-2      face i lies opposite corner i, and slot i of
///           /|\           edge 1: 0-2   edge 4: 1-3      `cell_to_cell` is the neighbor across it
///          / | \          edge 2: 0-3   edge 5: 2-3
///         0--|--2         opposite edges: e and 5 - e    (p1-p0) x (p2-p0) . (p3-p0) > 0
///          \ | /
///            1
namespace pamr::mesh::tet {

inline constexpr int n_edges = 6;

inline constexpr std::array<std::array<int, 2>, 6> edge_to_corner{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Corners of face i, such that the normal (p_b-p_a) x (p_c-p_a) points out of the cell.
inline constexpr std::array<std::array<int, 3>, 4> face_to_corner{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

constexpr int opposite_edge(int edge) { return 5 - edge; }

namespace detail {
constexpr std::array<std::array<int, 4>, 4> make_edge_of() {
  std::array<std::array<int, 4>, 4> table{{{-1, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}}};
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = edge_to_corner[static_cast<std::size_t>(e)];
    table[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = e;
    table[static_cast<std::size_t>(b)][static_cast<std::size_t>(a)] = e;
  }
  return table;
}
constexpr std::array<std::uint8_t, 4> make_face_mask() {
  std::array<std::uint8_t, 4> table{};
  for (int e = 0; e < 6; ++e)
    for (int f = 0; f < 4; ++f)
      if (edge_to_corner[static_cast<std::size_t>(e)][0] != f && edge_to_corner[static_cast<std::size_t>(e)][1] != f)
        table[static_cast<std::size_t>(f)] = static_cast<std::uint8_t>(table[static_cast<std::size_t>(f)] | 1U << e);
  return table;
}
}  // namespace detail

/// Edge between two corners; -1 on the diagonal.
inline constexpr auto edge_of = detail::make_edge_of();
/// Bits of the three edges of face i.
inline constexpr auto face_edge_mask = detail::make_face_mask();

}  // namespace pamr::mesh::tet
