// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/cell_resolution.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

const std::vector<double>& values_of(const std::vector<CellQuantity>& fields, std::string_view name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.name == name; });
  PAMR_EXPECTS(found != fields.end());
  return found->value;
}

}  // namespace

CellQuality judge_cells(const par::Comm& comm, const std::vector<CellQuantity>& fields, double free_density) {
  const auto &n = values_of(fields, "n"), &kn = values_of(fields, "Kn_cell"),
             &probability = values_of(fields, "collision_probability"),
             &separation = values_of(fields, "separation_over_lambda"), &particles = values_of(fields, "particles");
  std::array<std::int64_t, 8> count{};
  for (std::size_t c = 0; c < n.size(); ++c) {
    if (!(n[c] > 0)) continue;
    const std::array<bool, 4> good{kn[c] >= 1, probability[c] < 1, separation[c] < 1, particles[c] >= 10};
    ++count[0];
    for (std::size_t k = 0; k < 4; ++k) count[1 + k] += good[k] ? 1 : 0;
    count[5] += std::all_of(good.begin(), good.end(), [](bool one) { return one; }) ? 1 : 0;
    if (n[c] > free_density) {
      ++count[6];
      count[7] += particles[c] < 5 ? 1 : 0;
    }
  }
  comm.sum_in_place(count);
  const auto part = [&](std::size_t k, std::size_t of) {
    return static_cast<double>(count[k]) / static_cast<double>(std::max<std::int64_t>(1, count[of]));
  };
  return {static_cast<double>(count[0]), part(1, 0), part(2, 0), part(3, 0), part(4, 0), part(5, 0),
          static_cast<double>(count[6]), part(7, 6)};
}

nlohmann::json to_json(const CellQuality& q) {
  return {{"cells_with_gas", q.cells_with_gas},
          {"size_below_mean_free_path", q.size},
          {"collision_probability_below_1", q.probability},
          {"separation_below_mean_free_path", q.separation},
          {"at_least_10_particles", q.particles},
          {"all_of_these", q.all},
          {"cells_of_dense_gas", q.cells_of_dense_gas},
          {"dense_gas_below_5_particles", q.few_in_dense_gas}};
}

}  // namespace pamr::dsmc
