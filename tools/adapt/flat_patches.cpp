// SPDX-License-Identifier: GPL-3.0-or-later
#include "adapt/flat_patches.hpp"

#include <utility>

#include "pamr/mesh/undescribed_patches.hpp"

namespace pamr::tools {

void keep_flat_patches(cli::Session& session, mesh::DistMesh& mesh) {
  const auto undescribed = mesh::find_undescribed_patches(session.comm(), mesh);
  mesh.info = mesh::with_planes(std::move(mesh.info), undescribed);
  for (const auto& warning : mesh::warnings_of(mesh.info, undescribed)) session.warn(warning);
}

}  // namespace pamr::tools
