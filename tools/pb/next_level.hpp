// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "cli/session.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::tools {

/// The mesh of the next level: the fewest cells that carry most of the estimated error of the goals (`goal_error`), or
/// of the potential (`indicator`) where the case has no goals, are split into eight, and the mesh is closed around
/// them. On the first level these carry 0.6 of it, later 0.5 of that of goals, 0.3 of that of the potential. Cells are
/// taken in falling order while the refined mesh has at most `max_cells`; nothing where not one of them fits, and where
/// the estimate is 0. Fields go to the new mesh. Collective.
std::optional<mesh::DistMesh> next_level(cli::Session& session, mesh::DistMesh mesh, int level, std::int64_t max_cells);

}  // namespace pamr::tools
