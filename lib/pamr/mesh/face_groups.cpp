// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/face_groups.hpp"

namespace pamr::mesh {

FaceGroups::FaceGroups(const DistMesh& mesh) : mesh_(&mesh), offset_(mesh.node_global.size() + 1, 0) {
  const auto n_faces = static_cast<std::uint32_t>(4 * mesh.cell_to_node.size());
  from_.resize(n_faces);
  for (std::uint32_t face = 0; face < n_faces; ++face) ++offset_[static_cast<std::size_t>(key(face)[0])];
  std::size_t end = 0;
  for (auto& offset : offset_) offset = end += offset;
  for (auto face = n_faces; face-- > 0;) from_[--offset_[static_cast<std::size_t>(key(face)[0])]] = face;
}

std::array<LocalId, 3> FaceGroups::key(std::uint32_t from) const {
  const auto& nodes = mesh_->cell_to_node[from / 4];
  const auto& corner = tet::face_to_corner[from % 4];
  std::array<LocalId, 3> result{nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
                                nodes[static_cast<std::size_t>(corner[2])]};
  std::sort(result.begin(), result.end());
  return result;
}

void FaceGroups::collect(std::size_t node, std::vector<FaceAtNode>& faces) const {
  faces.clear();
  for (auto i = offset_[node]; i < offset_[node + 1]; ++i) {
    const auto nodes = key(from_[i]);
    faces.push_back({nodes[1], nodes[2], from_[i]});
  }
  std::sort(faces.begin(), faces.end(), [](const FaceAtNode& a, const FaceAtNode& b) {
    if (a.middle != b.middle) return a.middle < b.middle;
    return a.largest != b.largest ? a.largest < b.largest : a.from < b.from;
  });
}

}  // namespace pamr::mesh
