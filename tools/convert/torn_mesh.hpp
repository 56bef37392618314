// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/session.hpp"
#include "convert/convert_options.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::convert {

/// Says where a mesh of another program is torn or overlaps itself, or refuses it with `Options::strict`; with
/// `Options::weld` first joins the nodes that lie in one place, of a native mesh as well. The mesh is valid.
/// Collective.
void treat_tears(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report);

}  // namespace pamr::convert
