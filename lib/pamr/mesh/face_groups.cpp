// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/face_groups.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "pamr/base/memory.hpp"

namespace pamr::mesh {

namespace {

/// 2^64 over the golden ratio. Source: D. E. Knuth, The Art of Computer Programming 3, section 6.4.
constexpr std::uint64_t hash_factor = 0x9e3779b97f4a7c15U;

std::array<LocalId, 3> nodes_of(const DistMesh& mesh, std::uint32_t from) {
  const auto& nodes = mesh.cell_to_node[from / 4];
  const auto& corner = tet::face_to_corner[from % 4];
  return {nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
          nodes[static_cast<std::size_t>(corner[2])]};
}

/// The two larger of a face's nodes.
std::uint64_t others_of(const DistMesh& mesh, std::uint32_t from) {
  auto [a, b, c] = nodes_of(mesh, from);
  if (b < a) std::swap(a, b);
  if (c < a) std::swap(a, c);
  return static_cast<std::uint64_t>(std::min(b, c)) << 32U | static_cast<std::uint64_t>(std::max(b, c));
}

std::size_t smallest_node(const DistMesh& mesh, std::uint32_t from) {
  const auto [a, b, c] = nodes_of(mesh, from);
  return static_cast<std::size_t>(std::min(a, std::min(b, c)));
}

}  // namespace

FaceGroups::FaceGroups(const DistMesh& mesh) : mesh_(&mesh), offset_(mesh.node_global.size() + 1, 0) {
  const auto n_faces = static_cast<std::uint32_t>(4 * mesh.cell_to_node.size());
  assign_array(from_, n_faces, std::uint32_t{0});
  for (std::uint32_t face = 0; face < n_faces; ++face) ++offset_[smallest_node(mesh, face)];
  std::size_t end = 0;
  for (auto& offset : offset_) offset = end += offset;
  for (auto face = n_faces; face-- > 0;) from_[--offset_[smallest_node(mesh, face)]] = face;
}

void FaceGroups::collect(std::size_t node, AtNode& found) const {
  const auto size = std::bit_ceil(std::max<std::size_t>(2 * (offset_[node + 1] - offset_[node]), 2));
  const auto shift = 64 - std::countr_zero(size);
  found.group.clear();
  found.more.clear();
  found.table.assign(size, 0);
  for (auto i = offset_[node]; i < offset_[node + 1]; ++i) {
    const auto others = others_of(*mesh_, from_[i]);
    auto place = static_cast<std::size_t>((others * hash_factor) >> shift);
    while (found.table[place] != 0 && found.group[found.table[place] - 1].others != others)
      place = (place + 1) & (size - 1);
    if (found.table[place] == 0) {
      found.group.push_back({others, 1, {from_[i], 0}});
      found.table[place] = static_cast<std::uint32_t>(found.group.size());
      continue;
    }
    const auto g = found.table[place] - 1;
    if (++found.group[g].n == 2)
      found.group[g].from[1] = from_[i];
    else
      found.more.push_back({g, from_[i]});
  }
  std::sort(found.more.begin(), found.more.end());
}

}  // namespace pamr::mesh
