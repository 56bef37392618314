// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// The ears of a mesh: inner faces of which two edges lie in one smooth curved wall. The same on every rank.
///
/// With corners a, b, c, d on the wall and faces abc and abd in it, the face acd inside is an ear. When it is refined
/// the edges from a along the wall lie more and more in one plane, and so does all that is between the ear and the
/// wall: the children at a lose 0.63 of their mean ratio at every level, wherever new nodes are put. A cell with two
/// faces on the wall has two ears.
struct WallEars {
  std::vector<std::array<GlobalId, 2>> edge;  ///< inner edges opposite the corner a (here cd), ascending
  std::vector<std::array<GlobalId, 3>> face;  ///< ears whose third edge lies in the boundary too, ascending
  std::int64_t count = 0;                     ///< ears; several may have one edge
};

/// Finds them. Walls are patches tied to a surface that is not flat; two edges count where the surface's normals along
/// them, next to their common node, agree to 18 degrees. Collective: borders, one exchange, two small gatherings. Cost
/// O(cells) time; every rank gets the inner faces with three nodes on one wall, which are few.
WallEars find_wall_ears(const par::Comm& comm, const mesh::DistMesh& mesh);

/// Takes the ears away: splits each edge of `ears`, and so all cells round it, by a new node, and each face of them,
/// and so the two cells at it, by another. The boundary stays as it is. Edges are split in falling order of length, so
/// that neighbors agree on their common faces; children take the place of their parent in the order of cells, new
/// nodes come last. A new node begins in the middle and moves to where the cells at it are best, both as they are and
/// as their corners on the wall will be once refined often; so do inner nodes of the split cells, where they are poor
/// and no node field would have to follow. Cell fields are copied, node fields averaged. Pre: `ears` of this mesh, all
/// cells regular. Collective; every rank gets the cells to be split and those next to them. The result depends on the
/// mesh only, not on ranks.
mesh::DistMesh open_wall_ears(const par::Comm& comm, mesh::DistMesh mesh, const WallEars& ears);

}  // namespace pamr::meshing
