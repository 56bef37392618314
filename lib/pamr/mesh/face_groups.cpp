// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/face_groups.hpp"

#include <algorithm>

#include "pamr/base/memory.hpp"

namespace pamr::mesh {

namespace {

/// Longer lists are rare: nodes with many cells.
constexpr std::size_t short_list = 64;

std::array<LocalId, 3> nodes_of(const DistMesh& mesh, std::uint32_t from) {
  const auto& nodes = mesh.cell_to_node[from / 4];
  const auto& corner = tet::face_to_corner[from % 4];
  return {nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
          nodes[static_cast<std::size_t>(corner[2])]};
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

void FaceGroups::collect(std::size_t node, std::vector<FaceAtNode>& faces) const {
  faces.clear();
  for (auto i = offset_[node]; i < offset_[node + 1]; ++i) {
    const auto [a, b, c] = nodes_of(*mesh_, from_[i]);
    const auto least = std::min(a, std::min(b, c)), most = std::max(a, std::max(b, c));  // no branches to mispredict
    const auto middle = a ^ b ^ c ^ least ^ most;
    faces.push_back({static_cast<std::uint64_t>(middle) << 32U | static_cast<std::uint64_t>(most), from_[i]});
  }
  if (faces.size() > short_list) {
    std::sort(faces.begin(), faces.end(), [](const FaceAtNode& x, const FaceAtNode& y) {
      return x.others != y.others ? x.others < y.others : x.from < y.from;
    });
    return;
  }
  // insertion: `from` ascends as they come and stays so among equals
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const auto face = faces[i];
    auto k = i;
    for (; k > 0 && faces[k - 1].others > face.others; --k) faces[k] = faces[k - 1];
    faces[k] = face;
  }
}

}  // namespace pamr::mesh
