// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/cell_tree.hpp"

#include <utility>

#include "pamr/base/sorted_order.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/order/hilbert.hpp"

namespace pamr::locate {

CellTree::CellTree(const mesh::DistMesh& mesh) {
  if (mesh.cell_to_node.empty()) return;
  const order::CurveGrid grid(geometry::box_of(mesh.node_position));
  std::vector<std::uint64_t> key;
  key.reserve(mesh.cell_to_node.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c) key.push_back(order::key_of(grid, mesh.points(c)));
  order_ = sorted_order(key);

  std::vector<geometry::Box> boxes((order_.size() + width - 1) / width);
  for (std::size_t i = 0; i < order_.size(); ++i)
    boxes[i / width].merge(geometry::box_of(mesh.points(static_cast<LocalId>(order_[i]))));
  while (boxes.size() > 1) {
    std::vector<geometry::Box> above((boxes.size() + width - 1) / width);
    for (std::size_t i = 0; i < boxes.size(); ++i) above[i / width].merge(boxes[i]);
    levels_.push_back(std::move(boxes));
    boxes = std::move(above);
  }
  levels_.push_back(std::move(boxes));
}

geometry::Box CellTree::box() const { return levels_.empty() ? geometry::Box{} : levels_.back().front(); }

}  // namespace pamr::locate
