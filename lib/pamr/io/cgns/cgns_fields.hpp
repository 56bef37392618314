// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "pamr/io/cgns/cgns_nodes.hpp"
#include "pamr/io/elements/whole_mesh.hpp"

namespace pamr::io::cgns {

/// Vertices and cells of a zone; those of a mesh may be more, which are cut out of them.
struct ZoneSizes {
  std::int64_t n_nodes = 0, n_cells = 0;
};

/// Adds the solutions at vertices and cell centers of a zone as fields: of several with one name the first, three
/// arrays of reals vX, vY and vZ as one field v. Those of other sizes and places are left out, and counted. Local.
void read_solutions(const Tree& tree, const std::string& zone, const ZoneSizes& sizes, WholeMesh& mesh);

}  // namespace pamr::io::cgns
