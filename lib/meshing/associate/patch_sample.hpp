// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// A boundary face, corners counter-clockwise from outside.
struct PatchFace {
  int patch = 0;
  std::array<geometry::Vec3, 3> corner;
};

/// The faces of this rank on patches with `is_wanted`. Local.
std::vector<PatchFace> faces_of_patches(const mesh::DistMesh& mesh, const std::vector<bool>& is_wanted);

/// Some nodes of a patch, chosen by their coordinates, with unit normals from the faces around them.
struct PatchSample {
  int patch = 0;
  std::vector<geometry::Vec3> point, normal;
};

/// All nodes of patches of up to 600 faces, about 300 of larger ones: patch p on rank p modulo the number of ranks. The
/// same for any number of ranks, partition and numbering. `n_faces`: of each patch, on all ranks. Collective: one
/// sparse exchange.
std::vector<PatchSample> sample_patches(const par::Comm& comm, const std::vector<PatchFace>& faces,
                                        const std::vector<std::int64_t>& n_faces);

}  // namespace pamr::meshing
