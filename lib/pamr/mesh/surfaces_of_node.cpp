// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/surfaces_of_node.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"

namespace pamr::mesh {

SurfacesOfNode surfaces_of_node(const MeshInfo& info, const geometry::SurfaceSet& surfaces, const PatchList& patch) {
  SurfacesOfNode on;
  for (const auto p : patch) {
    if (p < 0) continue;
    const auto* surface = surfaces.get(info.patches[at(p)].surface);
    if (surface == nullptr)
      on.without_surface = p;
    else if (std::find(on.surface.begin(), on.surface.end(), surface) == on.surface.end())
      on.surface.push_back(surface);
  }
  on.is_on_seam = patch[1] >= 0 && patch[2] < 0 &&
                  info.patches[at(patch[0])].surface == info.patches[at(patch[1])].surface && !on.surface.empty();
  return on;
}

}  // namespace pamr::mesh
