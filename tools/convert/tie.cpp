// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/tie.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/triangulated.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::convert_tool {

namespace {

double size_of(const par::Comm& comm, const mesh::DistMesh& mesh) {
  geometry::Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto p : mesh.node_position) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return geometry::norm(geometry::Vec3{comm.max(high.x), comm.max(high.y), comm.max(high.z)} -
                        geometry::Vec3{comm.min(low.x), comm.min(low.y), comm.min(low.z)});
}

mesh::Patch& patch_named(mesh::DistMesh& mesh, const std::string& name) {
  auto& patches = mesh.info.patches;
  const auto found = std::find_if(patches.begin(), patches.end(), [&](const auto& p) { return p.name == name; });
  if (found != patches.end()) return *found;
  std::string names;
  for (const auto& patch : patches) names += (names.empty() ? "" : ", ") + patch.name;
  throw Error("patch '" + name + "': expected one of the mesh's patches " + names + ", found none of that name");
}

/// Puts the names of the surfaces into the patches.
void name_surfaces(mesh::DistMesh& mesh, const geometry::SurfaceSet& surfaces, const std::vector<std::string>& pairs) {
  for (auto& patch : mesh.info.patches)
    if (surfaces.find(patch.name) != nullptr) patch.surface = patch.name;
  for (const auto& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) throw Error("--tie: expected PATCH=SURFACE, found \"" + pair + "\"");
    const auto surface = pair.substr(equals + 1);
    if (surfaces.find(surface) == nullptr)
      throw Error("--tie " + pair + ": expected the name of a surface, found \"" + surface + "\"");
    patch_named(mesh, pair.substr(0, equals)).surface = surface;
  }
  for (const auto& name : surfaces.name)
    if (std::none_of(mesh.info.patches.begin(), mesh.info.patches.end(),
                     [&](const auto& patch) { return patch.surface == name; }))
      throw Error("surface \"" + name +
                  "\": expected a patch that lies on it (of the same name, or by --tie), found none");
}

}  // namespace

std::vector<Tie> tie_patches(const par::Comm& comm, mesh::DistMesh& mesh, const std::string& text,
                             const std::string& file, const std::vector<std::string>& pairs, double tolerance) {
  geometry::SurfaceSet surfaces;
  par::agree(comm, [&] {
    mesh.info.triangulations = geometry::triangulations_of_toml(text, file);
    surfaces = geometry::surfaces_from_toml(text, file, mesh.info.triangulations);
    name_surfaces(mesh, surfaces, pairs);
  });
  mesh.info.surfaces_toml = text;
  const double limit = tolerance < 0 ? -tolerance * size_of(comm, mesh) : tolerance;
  std::vector<Tie> ties;
  for (std::size_t p = 0; p < mesh.info.patches.size(); ++p) {
    const auto& patch = mesh.info.patches[p];
    const auto* surface = surfaces.find(patch.surface);
    if (surface == nullptr) continue;
    std::vector<std::uint8_t> is_on_patch(mesh.node_position.size(), 0);
    for (LocalId c = 0; c < mesh.n_cells(); ++c)
      for (std::size_t slot = 0; slot < 4; ++slot)
        if (mesh.cell_to_cell[static_cast<std::size_t>(c)][slot] == mesh::patch_to_slot(static_cast<int>(p)))
          for (const auto corner : mesh::tet::face_to_corner[slot])
            is_on_patch[static_cast<std::size_t>(
                mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)])] = 1;
    Tie tie{patch.name, patch.surface, 0, 0};
    for (std::size_t i = 0; i < is_on_patch.size(); ++i) {
      if (is_on_patch[i] == 0) continue;
      const double distance = surface->distance(mesh.node_position[i]);
      tie.worst_distance = std::max(tie.worst_distance, distance);
      tie.n_far += distance > limit ? 1 : 0;
    }
    tie.worst_distance = comm.max(tie.worst_distance);
    tie.n_far = comm.sum(tie.n_far);
    ties.push_back(tie);
  }
  for (const auto& tie : ties)
    if (tie.n_far > 0)
      throw Error(
          fmt::format("patch '{}': expected nodes within {:.6g} of surface \"{}\", found some as far as {:.6g} "
                      "from it (--tolerance sets the bound)",
                      tie.patch, limit, tie.surface, tie.worst_distance));
  return ties;
}

}  // namespace pamr::convert_tool
