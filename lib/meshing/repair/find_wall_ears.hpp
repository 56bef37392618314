// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// The ears of a mesh: faces with two edges in one smooth curved wall that they do not lie in. The same on every rank.
///
/// With corners a, b, c, d on the wall and faces abc and abd in it, the face acd inside is an ear. When it is refined
/// the edges from a along the wall lie more and more in one plane, and so does all that is between the ear and the
/// wall: the children at a lose 0.63 of their mean ratio at every level, wherever new nodes are put. A cell with two
/// faces on the wall has two ears. A triangle acd of a flat lid with ac and ad on its round rim is the same in the
/// plane. Patches inside are walls too, seen from both sides.
struct WallEars {
  std::vector<std::array<GlobalId, 2>> edge;  ///< edges to split: those opposite the corner a (here cd), ascending
  std::vector<std::array<GlobalId, 3>> face;  ///< ears whose third edge may not be split, ascending
  std::int64_t n_inside = 0;                  ///< ears without a patch; several may have one edge
  std::int64_t n_at_rims = 0;                 ///< ears in a patch
  std::int64_t n_left = 0;                    ///< those of them in a curved wall or a periodic patch: not to be opened

  std::int64_t count() const { return n_inside + n_at_rims; }
  bool can_be_opened() const { return !edge.empty() || !face.empty(); }
};

/// Finds them. Walls are patches on a surface that is not flat; two edges count where the surface's normals along them,
/// next to their common node, agree to 18 degrees. An edge in no patch may be split, at a rim also one between flat
/// faces. Collective: borders, one exchange, two small gatherings. Cost O(cells) time; every rank gets the faces with
/// three nodes on one wall that they do not lie in, which are few.
WallEars find_wall_ears(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::meshing
