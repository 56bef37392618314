// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/locate_points.hpp"

#include <fmt/format.h>

#include <optional>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/locate/ask_ranks.hpp"

namespace pamr::locate {

PointLocations locate_points(const par::Comm& comm, const mesh::DistMesh& mesh, const Locator& locator,
                             std::span<const geometry::Vec3> points, std::span<const LocalId> near) {
  par::agree(comm, [&] {
    if (!near.empty() && near.size() != points.size())
      throw Error(fmt::format("locate: expected a cell to begin at for each of {} points, found {} (rank {})",
                              points.size(), near.size(), comm.rank()));
  });
  PointLocations result;
  result.cell.assign(points.size(), invalid_global);
  result.rank.assign(points.size(), -1);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto own = locator.find(points[i], near.empty() ? invalid_local : near[i]);
    if (own != invalid_local) {
      result.cell[i] = mesh.cell_global[at(own)];
      result.rank[i] = comm.rank();
      if (side_of_cell(mesh, own, points[i]) > 0) continue;
    }
    open.push_back(i);
  }
  const auto find = [&](geometry::Vec3 point) -> std::optional<GlobalId> {
    const auto cell = locator.find(point);
    return cell == invalid_local ? std::nullopt : std::optional(mesh.cell_global[at(cell)]);
  };
  const auto answered = ask_ranks<GlobalId>(comm, locator.tree().box(), points, open, find);
  for (std::size_t r = 0; r < answered.rank.size(); ++r)
    for (const auto& answer : answered.from(r)) {
      auto& cell = result.cell[at(answer.row)];
      if (cell != invalid_global && cell < answer.value) continue;
      cell = answer.value;
      result.rank[at(answer.row)] = answered.rank[r];
    }
  return result;
}

}  // namespace pamr::locate
