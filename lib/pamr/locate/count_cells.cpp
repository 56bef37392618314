// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/count_cells.hpp"

#include <numeric>
#include <optional>

#include "pamr/locate/ask_ranks.hpp"

namespace pamr::locate {

std::vector<std::int64_t> count_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const CellTree& tree,
                                      std::span<const geometry::Vec3> points) {
  const auto count_here = [&](geometry::Vec3 point) {
    std::int64_t n = 0;
    tree.for_each_near(point, [&](LocalId cell) { n += side_of_cell(mesh, cell, point) >= 0 ? 1 : 0; });
    return n;
  };
  std::vector<std::int64_t> count;
  count.reserve(points.size());
  for (const auto point : points) count.push_back(count_here(point));
  std::vector<std::size_t> rows(points.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto find = [&](geometry::Vec3 point) -> std::optional<std::int64_t> {
    const auto n = count_here(point);
    return n > 0 ? std::optional(n) : std::nullopt;
  };
  for (const auto& answer : ask_ranks<std::int64_t>(comm, tree.box(), points, rows, find).item)
    count[at(answer.row)] += answer.value;
  return count;
}

}  // namespace pamr::locate
