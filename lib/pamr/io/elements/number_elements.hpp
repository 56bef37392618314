// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Cells and boundary triangles by the places of their nodes.
struct Numbered {
  std::vector<std::array<GlobalId, 4>> cell;
  std::vector<std::array<GlobalId, 3>> triangle;
  GlobalId n_nodes = 0;
  std::vector<geometry::Vec3> position;      ///< canonical block
  std::vector<mesh::NodeField> node_fields;  ///< canonical block
  std::vector<GlobalId> origin;              ///< of the block's nodes, among all that were given
  std::int64_t n_dropped = 0;
};

/// Finds the nodes that the elements of a file name by the numbers that it gives them, leaves out those that no cell
/// has, which are -1 in triangles, and closes the gaps. Takes numbers, positions and fields of the nodes out of `parts`.
/// Throws `Error`, which begins with `source`, where there is no node, the numbers have wide gaps or are negative, two
/// nodes have the same, or an element names one that no node has. `with_origin`: fill `origin`. Collective.
Numbered number_elements(const par::Comm& comm, ElementParts& parts, const std::string& source, bool with_origin);

}  // namespace pamr::io
