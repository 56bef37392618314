// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/face_geometry.hpp"
#include "pamr/mesh/inner_patches.hpp"

namespace pamr::test {

/// Adds a patch of the inner faces whose area vector and centroid `holds` accepts. Local.
inline void add_inner_patch(mesh::DistMesh& mesh, const std::string& name,
                            const std::function<bool(geometry::Vec3 normal, geometry::Vec3 center)>& holds) {
  const auto patch = static_cast<int>(mesh.info.patches.size());
  mesh.info.patches.push_back({name, "", -1});
  auto& words = mesh::make_inner_patches(mesh);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (int slot = 0; slot < 4; ++slot) {
      const auto points = mesh.points(cell);
      if (mesh.cell_to_cell[at(cell)][at(slot)] < 0) continue;
      if (holds(mesh::area_vector(points, slot), mesh::face_centroid(points, slot)))
        words[at(cell)] = mesh::with_inner_patch(words[at(cell)], slot, patch);
    }
}

}  // namespace pamr::test
