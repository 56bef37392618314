// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// A 64-bit sum that tells two meshes apart by their points, cells, boundary patches and lineage. It does not depend on
/// the numbering of cells, nodes and patches, on the order of a cell's corners, or on the number of ranks; it does not
/// cover fields, surfaces and nodes without cells.
///
/// All arithmetic is on unsigned 64-bit integers, modulo 2^64; ^ is exclusive or, >> shifts in zeros.
///
///     mix(x):        x = x + 0x9e3779b97f4a7c15
///                    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9
///                    x = (x ^ (x >> 27)) * 0x94d049bb133111eb
///                    return x ^ (x >> 31)
///     chain(h, w):   mix(h ^ mix(w))
///     bits(d):       the IEEE 754 bits of the double d + 0.0 (so that -0 counts as +0)
///     node(p):       chain(chain(chain(0, bits(p.x)), bits(p.y)), bits(p.z))
///     name(s):       h = 0; for each byte b of the patch's name in UTF-8: h = chain(h, b)
///     state(cell):   kind + 4 * broken + 8 * level    (of the lineage, `lineage.hpp`; kind: 0 regular, 1 a
///                    closure cell of 1:2, 2 of 1:4, 3 of any other)
///     cell:          C = sum of node(p) over the four corners
///                    B = sum of chain(node(p), name(patch)) over the corners opposite which a face of the boundary
///                    lies chain(chain(chain(0, C), B), state)
///     fingerprint:   sum over all cells
///
/// Example: the tetrahedron (0,0,0) (1,0,0) (0,1,0) (0,0,1), its faces in the patch `wall`, a regular cell of level 0,
/// has the fingerprint 0x77d09ba2d04045ca.
/// Collective: one reduction. Cost: O(cells + nodes) time, 8 bytes a node of memory.
std::uint64_t fingerprint(const par::Comm& comm, const DistMesh& mesh);

}  // namespace pamr::mesh
