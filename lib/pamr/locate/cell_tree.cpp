// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/cell_tree.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pamr/base/sorted_order.hpp"
#include "pamr/order/hilbert.hpp"

namespace pamr::locate {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

CellBox empty_box() { return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}}; }

void include(CellBox& box, geometry::Vec3 p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
}

}  // namespace

CellTree::CellTree(const mesh::DistMesh& mesh) {
  auto all = empty_box();
  for (const auto p : mesh.node_position) include(all, p);
  if (mesh.cell_to_node.empty()) return;
  const order::CurveGrid grid(all.low, all.high);
  std::vector<std::uint64_t> key;
  key.reserve(mesh.cell_to_node.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c) key.push_back(order::key_of(grid, mesh.points(c)));
  order_ = sorted_order(key);

  std::vector<CellBox> boxes((order_.size() + width - 1) / width, empty_box());
  for (std::size_t i = 0; i < order_.size(); ++i)
    for (const auto p : mesh.points(static_cast<LocalId>(order_[i]))) include(boxes[i / width], p);
  while (boxes.size() > 1) {
    std::vector<CellBox> above((boxes.size() + width - 1) / width, empty_box());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      include(above[i / width], boxes[i].low);
      include(above[i / width], boxes[i].high);
    }
    levels_.push_back(std::move(boxes));
    boxes = std::move(above);
  }
  levels_.push_back(std::move(boxes));
}

CellBox CellTree::box() const { return levels_.empty() ? empty_box() : levels_.back().front(); }

}  // namespace pamr::locate
