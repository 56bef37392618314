// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

using GmshOptions = ElementOptions;
using GmshMesh = ElementMesh;

/// Reads a mesh in Gmsh's format 2.2 or 4.1, text or binary, whose cells are tetrahedra of first order. Physical
/// surfaces become patches of the same name (`surface_N` without a name; geometrical surfaces where there are no
/// physical ones), physical volumes the cell field `region` with the names of its values. An entity in several groups
/// stays in the one with the smallest number (`ElementMesh::overlaps`). Cells are put in order along Hilbert's curve.
///
/// Collective; the result does not depend on the number of ranks. Every rank reads its block of nodes and
/// elements and passes over the rest, in a text by the number of lines, which the ranks have counted together. Throws
/// the same `Error` on every rank, with line or byte, for what is no such file; and by name, with counts, for elements
/// of other kinds, triangles inside a region or apart from the cells, cells that are inverted (unless
/// `repair`) or flat, node numbers that are missing, twice or so scattered that no table holds them (more than 64 times
/// as many as nodes).
GmshMesh read_gmsh(const par::Comm& comm, const std::filesystem::path& file, const GmshOptions& options = {});

}  // namespace pamr::io
