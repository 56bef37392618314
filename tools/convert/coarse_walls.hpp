// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/session.hpp"
#include "convert/convert_options.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::convert {

/// Forgets how the mesh was refined, if that is asked for (`Options::as_level0`). Collective.
void forget_levels(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report);

/// Says where edges of a mesh of level 0 are long for the radius of their curved walls. With `Options::repair`, if the map
/// of level 0 folds, or if it is poor and edges are longer than `curved::longest_kept`, splits the cells at them into
/// eight by that map and makes level 0 of the result. Collective.
void treat_coarse_walls(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report);

}  // namespace pamr::convert
