// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::io {

/// Makes the surfaces that a file describes and lets its patches lie on them. With `build` false they get only their
/// names, and the description is kept as it is. Local; the same on every rank. Throws `Error` for a description that
/// is none and for a patch on a surface that is not there.
void put_surfaces(const Layout& layout, const std::string& file,
                  std::vector<std::shared_ptr<const geometry::Triangulation>> triangulations, bool build,
                  mesh::MeshInfo& info);

}  // namespace pamr::io
