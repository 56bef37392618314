// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/order.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr int n_bits = 21;

Vec3 centroid(const RawMesh& mesh, std::size_t cell) {
  const auto p = mesh.points(cell);
  return 0.25 * (p[0] + p[1] + p[2] + p[3]);
}

/// (key, old cell) of every cell, along the curve.
std::vector<std::pair<std::uint64_t, std::size_t>> along_curve(const RawMesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low{infinity, infinity, infinity}, high = -low;
  for (const auto& p : mesh.point) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 extent = high - low;
  const double scale = ((1U << n_bits) - 1) / std::max({extent.x, extent.y, extent.z});
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const Vec3 q = scale * (centroid(mesh, c) - low);
    order.emplace_back(hilbert_key({static_cast<std::uint32_t>(q.x), static_cast<std::uint32_t>(q.y),
                                    static_cast<std::uint32_t>(q.z)}),
                       c);
  }
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace

std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x) {
  // Skilling's AxestoTranspose: undo the excess work of the curve's inverse, bit by bit, then Gray encode.
  constexpr std::uint32_t top = 1U << (n_bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1U) {
    const std::uint32_t below = q - 1;
    for (auto& coordinate : x) {
      if ((coordinate & q) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t t = (x[0] ^ coordinate) & below;
        x[0] ^= t;
        coordinate ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1U)
    if ((x[2] & q) != 0) t ^= q - 1;
  for (auto& coordinate : x) coordinate ^= t;

  std::uint64_t key = 0;
  for (int bit = n_bits - 1; bit >= 0; --bit)
    for (const auto coordinate : x) key = key << 1U | (coordinate >> static_cast<unsigned>(bit) & 1U);
  return key;
}

RawMesh ordered(const RawMesh& mesh) {
  RawMesh result;
  std::vector<std::int32_t> old_to_new_node(mesh.point.size(), -1);
  std::vector<std::int32_t> old_to_new_cell(mesh.cell.size(), -1);
  for (const auto& [key, old] : along_curve(mesh)) {
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
  }
  result.face = mesh.face;
  for (auto& face : result.face) face.cell = old_to_new_cell[static_cast<std::size_t>(face.cell)];
  std::sort(result.face.begin(), result.face.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
    return std::pair(a.cell, a.slot) < std::pair(b.cell, b.slot);
  });
  return result;
}

}  // namespace pamr::meshing
