// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/level0.hpp"

#include <algorithm>
#include <utility>

#include "pamr/mesh/level0_map.hpp"

namespace pamr::adapt {

ReadyMesh with_level0_map(const par::Comm& comm, GivenMesh mesh, const refine::Options& options) {
  const bool has_map = mesh.get().info.level0 != nullptr;
  const bool is_wanted = options.project && (has_map || curved::needs_level0_map(comm, mesh.get(), options.bend));
  if (has_map == is_wanted) return {std::move(mesh), {}};
  auto own = std::move(mesh).take();
  if (has_map) mesh::drop_level0(own);
  const auto report = has_map ? curved::Level0Report{} : curved::make_level0_map(comm, own, options.bend);
  return {std::move(own), report};
}

void drop_level0_map_of_level0(const par::Comm& comm, mesh::DistMesh& mesh) {
  if (mesh.info.level0 == nullptr) return;
  const auto is_split = [](mesh::Lineage lineage) { return lineage.level() > 0 || lineage.is_closure(); };
  if (!comm.any(std::any_of(mesh.lineage.begin(), mesh.lineage.end(), is_split))) mesh::drop_level0(mesh);
}

}  // namespace pamr::adapt
