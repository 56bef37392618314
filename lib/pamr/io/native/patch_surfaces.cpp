// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/patch_surfaces.hpp"

#include <fmt/format.h>

#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::io {

void put_surfaces(const Layout& layout, const std::string& file,
                  std::vector<std::shared_ptr<const geometry::Triangulation>> triangulations, bool build,
                  mesh::MeshInfo& info) {
  geometry::SurfaceSet set;
  if (build) {
    set = geometry::surfaces_from_toml(layout.surfaces_toml, file + ", surfaces", std::move(triangulations));
  } else {
    set.toml = layout.surfaces_toml;
    set.triangulations = std::move(triangulations);
    for (const auto& name : layout.surface_of_patch)
      if (!name.empty() && set.index_of(name) < 0) set.add(name, file, nullptr);
  }
  for (std::size_t p = 0; p < layout.surface_of_patch.size(); ++p) {
    const auto& name = layout.surface_of_patch[p];
    if (name.empty()) continue;
    info.patches[p].surface = set.index_of(name);
    if (info.patches[p].surface < 0)
      throw Error(
          fmt::format("file '{}', {}: patch \"{}\" lies on surface \"{}\": expected a surface of that name in "
                      "the mesh, found none",
                      file, path::patch_surfaces, info.patches[p].name, name));
  }
  info.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(set));
}

}  // namespace pamr::io
