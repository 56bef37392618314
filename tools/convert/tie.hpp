// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::convert_tool {

/// How far the nodes of a patch lie from its surface.
struct Tie {
  std::string patch, surface;
  double worst_distance = 0;
  std::int64_t n_far = 0;  ///< nodes farther than the tolerance, counted on every rank that holds them
};

/// Gives patches their surfaces: `text` describes the surfaces (docs/surfaces.md); `pairs` are `PATCH=SURFACE`, and a
/// patch of the same name as a surface is tied without being named. Collective. Throws `Error` on every rank for bad
/// text, names that are not there, surfaces that no patch uses, and when a node lies farther than `tolerance` (in
/// length units; of the mesh's size when negative: -tolerance times) from its surface.
std::vector<Tie> tie_patches(const par::Comm& comm, mesh::DistMesh& mesh, const std::string& text,
                             const std::string& file, const std::vector<std::string>& pairs, double tolerance);

}  // namespace pamr::convert_tool
