// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// The nodes of a face.
std::array<std::int32_t, 3> corners_of(const RawMesh& mesh, const BoundaryFace& face);

/// Finds the piece that each face between two regions lies on. Faces that are connected without crossing a feature edge
/// lie on one piece: of those between their regions the one that is nearest to the middles of all of them.
/// `is_feature`: of an edge, the smaller node first. Local. Throws `Error` where no piece lies between the regions: the
/// sizes are too coarse.
void find_pieces_between_regions(const Domain& domain,
                                 const std::function<bool(std::pair<std::int32_t, std::int32_t>)>& is_feature,
                                 RawMesh& mesh);

}  // namespace pamr::meshing
