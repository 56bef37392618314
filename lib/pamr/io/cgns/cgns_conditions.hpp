// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pamr/io/cgns/cgns_nodes.hpp"
#include "pamr/io/elements/whole_mesh.hpp"

namespace pamr::io::cgns {

/// Where the elements of a zone, by their numbers in the file, are in a mesh, and the groups that they are in.
struct ZoneElements {
  /// The first of those that an element is, or was cut into, and their number.
  struct Pieces {
    std::size_t first = 0, n = 1;
  };
  std::map<std::int64_t, Pieces> cell_of, triangle_of;
  std::vector<std::string> group_of_cell;  ///< name of its section, or of a condition
  bool has_named_cells = false;            ///< by conditions
  std::map<std::string, std::int64_t> tag_of_name;

  /// The number of the patch of this name, a new one for a new name.
  std::int64_t tag_of(const std::string& name, WholeMesh& mesh);
};

/// Boundary conditions of a zone give triangles their patch and cells their region: first those on elements, then those
/// on vertices, which have the triangles whose three corners they name. Patches of sections of which no triangle is left
/// are no patches. Local. Throws `Error` for damaged nodes. Source: CGNS SIDS, "Boundary Conditions".
void read_conditions(const Tree& tree, const std::string& base, const std::string& zone, ZoneElements& elements,
                     WholeMesh& mesh);

}  // namespace pamr::io::cgns
