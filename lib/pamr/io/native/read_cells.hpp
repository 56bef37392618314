// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/slab_reader.hpp"
#include "pamr/mesh/block_mesh.hpp"

/// The parts of the native file that describe cells. Every value is verified as far as one row can tell; all functions
/// are collective and throw the same `Error` on every rank.
namespace pamr::io {

/// First border of a family at or after row `cell`, a different row on each rank.
GlobalId family_border(SlabReader& reader, const Layout& layout, GlobalId cell);

/// Lineage words of whole families; empty when the file has none.
std::vector<mesh::Lineage> read_lineage(SlabReader& reader, const Layout& layout, Rows cells);

/// The same of any rows, nothing verified: a word that is none counts as a regular cell.
std::vector<mesh::Lineage> read_lineage_unchecked(SlabReader& reader, const Layout& layout, Rows cells);

/// Verifies that the offsets and types are those of tetrahedra.
void check_offsets_and_types(SlabReader& reader, const Layout& layout, Rows cells);

/// Nodes of the cells (n x 4, global ids, in range). `verify`: compare the checksum.
std::vector<std::array<GlobalId, 4>> read_connectivity(SlabReader& reader, const Layout& layout, Rows cells,
                                                       bool verify);
/// Verifies that no cell names a node twice.
void check_corners(SlabReader& reader, const Layout& layout, Rows cells,
                   const std::vector<std::array<GlobalId, 4>>& cell_to_node);

/// Neighbors of the cells (n x 4, global ids or -(patch+1), in range); empty when the file has none.
std::vector<std::array<GlobalId, 4>> read_neighbors(SlabReader& reader, const Layout& layout, Rows cells);

/// The triangles of the boundary, this rank's block of them. Collective.
mesh::BoundaryTriangles read_boundary(SlabReader& reader, const Layout& layout);

}  // namespace pamr::io
