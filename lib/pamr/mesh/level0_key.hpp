// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "pamr/base/index.hpp"
#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::mesh {

/// Nodal field of 8 integers: where a node lies in level 0, see `Level0Key`: four numbers, then four weights.
inline constexpr const char* level0_key_field = "level0_key";
/// Integer cell field: the row of `Level0Map` of the level-0 cell that a cell descends from, -1 if it has none.
inline constexpr const char* level0_cell_field = "level0_cell";
inline constexpr int n_key_words = 8;  ///< components of `level0_key`

/// Whether a field is one of these: it says something beside the map only, to no other program.
inline bool is_level0_field(const Field& field) {
  return field.name == level0_key_field || field.name == level0_cell_field;
}

/// Throws `Error` where a field of nodes or cells has the name of one of these, and the mesh has no map, or the field
/// another shape. Local.
void require_level0_field(const Field& field, bool on_cells, bool has_map);

/// The place of a node in the straight level 0: barycentric coordinates of at most four of its nodes. Exact, and the
/// same from whatever cell one looks. Source: docs/level0-map.md.
struct Level0Key {
  static constexpr int one = 62;  ///< weights are multiples of 2^-62

  std::array<GlobalId, 4> node{-1, -1, -1, -1};  ///< numbers in level 0, ascending; -1 where there are no more
  std::array<std::int64_t, 4> weight{};          ///< they add up to 2^62

  bool is_known() const { return node[0] >= 0; }
  static Level0Key of_node(GlobalId node) { return {{node, -1, -1, -1}, {std::int64_t{1} << one, 0, 0, 0}}; }
  friend bool operator==(const Level0Key&, const Level0Key&) = default;
};

/// The key in the middle of an edge with these at its ends. Not known if one of them is not, if both together have more
/// than four nodes, or if the weights cannot be halved.
Level0Key middle(const Level0Key& a, const Level0Key& b);

/// The key of a node of a mesh; not known where the field is missing. Local.
inline Level0Key key_of(const NodeField* keys, LocalId node) {
  if (keys == nullptr) return {};
  const auto* row = keys->integer().data() + at(node) * n_key_words;
  return {{row[0], row[1], row[2], row[3]}, {row[4], row[5], row[6], row[7]}};
}
/// A field without values yet, and one more key at its end.
NodeField empty_key_field();
void append_key(NodeField& keys, const Level0Key& key);

}  // namespace pamr::mesh
