// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "solvers/dsmc/run/advance.hpp"
#include "solvers/dsmc/run/checked_coefficient.hpp"
#include "solvers/dsmc/run/computation.hpp"
#include "solvers/dsmc/sampling/cell_resolution.hpp"

namespace pamr::dsmc {

/// The run with a quarter of the particles.
struct FewerRun {
  std::int64_t n_particles = 0;  ///< at its end
  std::uint64_t n_steps = 0;
};

/// The run with cells at the walls split.
struct SplitRun {
  std::int64_t n_split = 0, n_cells = 0;  ///< cells at walls that were split; of the mesh that came of it
  std::int64_t n_particles = 0;           ///< at its end
  std::uint64_t n_steps = 0;
  double particles_per_piece = 0;  ///< at its end, mean of the cells that the split ones became
  double distance = 1;             ///< `SplitCoefficient::distance`
};

struct ResolutionCheck {
  std::vector<CheckedCoefficient> coefficients;  ///< C_D, C_L, C_m, C_H; without lift C_D, C_H
  std::optional<FewerRun> fewer{};               ///< none where molecules do not collide
  std::optional<SplitRun> split{};
};

/// Goes on from the gas of a computation that has ended with a quarter of the particles, on the same mesh, until it has
/// as many averaged steps, after the transient of the case and a passage. With `cells` once more: with all particles,
/// on the mesh whose cells at the walls are split (`split_walls`). The computation stays as it is. Where molecules do
/// not collide, neither their number nor cells add an error, and only flat faces are looked at.
/// `resolution`: of its cells. None if the observer of some rank asked for the end. Collective.
/// Throws `Error` for a computation without averages or that `require_checkable` refuses.
std::optional<ResolutionCheck> check_resolution(const Computation& computation, const CellResolution& resolution,
                                                bool cells, const Observer& observer);

/// Throws `Error` for a case that cannot be checked, with `cells` or without. Local.
void require_checkable(const Case& the_case, bool cells);
/// Throws `Error` if no face lies on a wall, so that there are no cells to split. Collective.
void require_walls(const Computation& computation);

nlohmann::json to_json(const ResolutionCheck& check);
/// A line for each coefficient, and one where split cells hold few particles. Local.
std::vector<std::string> describe(const ResolutionCheck& check);

}  // namespace pamr::dsmc
