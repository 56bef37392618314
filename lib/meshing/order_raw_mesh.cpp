// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/order_raw_mesh.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pamr/base/sorted_order.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/order/hilbert.hpp"

namespace pamr::meshing {
namespace {

/// Old cells along the curve.
std::vector<std::uint32_t> along_curve(const RawMesh& mesh) {
  const order::CurveGrid grid(geometry::box_of(mesh.point));
  std::vector<std::uint64_t> key;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const auto p = mesh.points(c);
    key.push_back(grid.key(geometry::centroid(p)));
  }
  return sorted_order(key);
}

}  // namespace

RawMesh ordered(const RawMesh& mesh) {
  RawMesh result;
  std::vector<std::int32_t> old_to_new_node(mesh.point.size(), -1);
  std::vector<std::int32_t> old_to_new_cell(mesh.cell.size(), -1);
  for (const auto old : along_curve(mesh)) {
    old_to_new_cell[old] = static_cast<std::int32_t>(result.cell.size());
    auto cell = mesh.cell[old];
    for (auto& node : cell) {
      auto& number = old_to_new_node[static_cast<std::size_t>(node)];
      if (number < 0) {
        number = static_cast<std::int32_t>(result.point.size());
        result.point.push_back(mesh.position(node));
        result.binding.push_back(mesh.binding[static_cast<std::size_t>(node)]);
      }
      node = number;
    }
    result.cell.push_back(cell);
    if (!mesh.region.empty()) result.region.push_back(mesh.region[old]);
  }
  result.face = mesh.face;
  result.between = mesh.between;
  for (auto* faces : {&result.face, &result.between}) {
    for (auto& face : *faces) face.cell = old_to_new_cell[static_cast<std::size_t>(face.cell)];
    std::sort(faces->begin(), faces->end(), [](const BoundaryFace& a, const BoundaryFace& b) {
      return std::pair(a.cell, a.slot) < std::pair(b.cell, b.slot);
    });
  }
  return result;
}

}  // namespace pamr::meshing
