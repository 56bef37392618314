// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/cell_resolution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace pamr::dsmc {

CellResolution assess_resolution(const par::Comm& comm, const CellFlow& flow, double free_density,
                                 std::int64_t n_steps) {
  std::array<std::int64_t, 8> count{};
  double max_temperature = 0;
  for (std::size_t c = 0; c < flow.density.size(); ++c) {
    if (!(flow.density[c] > 0)) continue;
    if (flow.particles[c] * static_cast<double>(n_steps) >= 100) max_temperature = std::max(max_temperature, flow.t[c]);
    const std::array<bool, 4> good{flow.knudsen[c] >= 1, flow.collision_probability[c] < 1, flow.separation[c] < 1,
                                   flow.particles[c] >= 10};
    ++count[0];
    for (std::size_t k = 0; k < 4; ++k) count[1 + k] += good[k] ? 1 : 0;
    count[5] += std::all_of(good.begin(), good.end(), [](bool one) { return one; }) ? 1 : 0;
    if (flow.density[c] > free_density) {
      ++count[6];
      count[7] += flow.particles[c] < 5 ? 1 : 0;
    }
  }
  comm.sum_in_place(count);
  const auto part = [&](std::size_t k, std::size_t of) {
    return static_cast<double>(count[k]) / static_cast<double>(std::max<std::int64_t>(1, count[of]));
  };
  return {static_cast<double>(count[0]),
          part(1, 0),
          part(2, 0),
          part(3, 0),
          part(4, 0),
          part(5, 0),
          static_cast<double>(count[6]),
          part(7, 6),
          0,
          0,
          comm.max(max_temperature)};
}

nlohmann::json to_json(const CellResolution& q) {
  return {{"cells_with_gas", q.cells_with_gas},
          {"size_below_mean_free_path", q.size},
          {"collision_probability_below_1", q.probability},
          {"separation_below_mean_free_path", q.separation},
          {"at_least_10_particles", q.particles},
          {"all_of_these", q.all},
          {"cells_of_dense_gas", q.cells_of_dense_gas},
          {"dense_gas_below_5_particles", q.few_in_dense_gas},
          {"wall_separation", q.wall_separation},
          {"wall_cell_size", q.wall_cell_size},
          {"max_temperature", q.max_temperature}};
}

std::vector<std::string> warnings_of(const CellResolution& resolution, const Gas* gas) {
  std::vector<std::string> warnings;
  if (resolution.few_in_dense_gas > 0.1)
    warnings.push_back(
        fmt::format("{:.0f} % of the {:.0f} cells denser than the free stream have fewer than 5 particles: use "
                    "more particles or fewer cells",
                    100 * resolution.few_in_dense_gas, resolution.cells_of_dense_gas));
  if (gas != nullptr && is_hot(*gas, resolution.max_temperature))
    warnings.push_back(
        fmt::format("the hottest cell has {:.0f} K: {}", resolution.max_temperature, missing_when_hot(*gas)));
  return warnings;
}

}  // namespace pamr::dsmc
