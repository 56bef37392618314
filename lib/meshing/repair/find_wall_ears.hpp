// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// The ears of a mesh: inner faces with two edges in one smooth curved wall. The same on every rank.
///
/// With corners a, b, c, d on the wall and faces abc and abd in it, the face acd inside is an ear. When it is refined
/// the edges from a along the wall lie more and more in one plane, and so does all that is between the ear and the
/// wall: the children at a lose 0.63 of their mean ratio at every level, wherever new nodes are put. A cell with two
/// faces on the wall has two ears.
struct WallEars {
  std::vector<std::array<GlobalId, 2>> edge;  ///< inner edges opposite the corner a (here cd), ascending
  std::vector<std::array<GlobalId, 3>> face;  ///< ears whose third edge lies in the boundary too, ascending
  std::int64_t count = 0;                     ///< ears; several may have one edge
  /// Faces in the boundary, but not in that wall, with two edges in it (a chord of a round lid cuts off two edges of its
  /// rim): cells behind them lose shape as behind ears, and are not opened.
  std::int64_t n_at_rims = 0;
};

/// Finds them. Walls are patches on a surface that is not flat; two edges count where the surface's normals along
/// them, next to their common node, agree to 18 degrees. Collective: borders, one exchange, two small gatherings. Cost
/// O(cells) time; every rank gets the faces with three nodes on one wall that they do not lie in, which are few.
WallEars find_wall_ears(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::meshing
