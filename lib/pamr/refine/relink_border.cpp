// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink_border.hpp"

#include <span>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/insertion_sort.hpp"
#include "pamr/mesh/face_groups.hpp"

namespace pamr::refine {

namespace {

/// A border face as both sides know it.
struct Record {
  std::uint64_t name;  ///< `mesh::face_name`
  GlobalId cell;
};

/// A border face of this side.
struct Part {
  mesh::CellFace face;
  std::uint64_t name = 0;
};

/// The border faces in the order that both sides share.
struct Parts {
  std::vector<Part> part;
  std::vector<std::size_t> end;  ///< those of old border face `k` end at `end[k]`
};

/// Sorted by old border face, the parts of one by their names.
Parts in_order(const std::vector<BorderFace>& faces, std::size_t n_old_faces, const Children& children,
               const std::vector<GlobalId>& node_global) {
  Parts parts;
  auto& end = parts.end;
  end.assign(n_old_faces + 1, 0);
  for (const auto& face : faces) ++end[at(face.old_face) + 1];
  for (std::size_t k = 1; k < end.size(); ++k) end[k] += end[k - 1];
  parts.part.resize(faces.size());
  for (const auto& [face, old_face] : faces)
    parts.part[end[at(old_face)]++] = {face,
                                       mesh::face_name(children.cell_to_node[at(face.cell)], face.slot, node_global)};
  const auto key = [&](const Part& part) {
    return mesh::face_key(children.cell_to_node[at(part.face.cell)], part.face.slot, node_global);
  };
  const auto comes_first = [&](const Part& a, const Part& b) {
    return a.name != b.name ? a.name < b.name : key(a) < key(b);
  };
  for (std::size_t k = 0, begin = 0; k + 1 < end.size(); begin = end[k++])
    insertion_sort(std::span(parts.part).subspan(begin, end[k] - begin), comes_first);  // four parts, rarely more
  return parts;
}

}  // namespace

BorderLinks link_border(const par::Comm& comm, const mesh::DistMesh& old, const std::vector<BorderFace>& faces,
                        const Children& children, const std::vector<GlobalId>& node_global) {
  const auto [parts, end] = in_order(faces, old.border_face.size(), children, node_global);

  BorderLinks border{old.border_rank, {0}, {}, {}};
  border.border_face.reserve(parts.size());
  std::vector<par::Outgoing<Record>> messages;
  for (std::size_t i = 0; i < old.border_rank.size(); ++i) {
    border.border_offset.push_back(end[old.border_offset[i + 1] - 1]);
    auto& message = messages.emplace_back(par::Outgoing<Record>{old.border_rank[i], {}});
    message.item.reserve(border.border_offset[i + 1] - border.border_offset[i]);
    for (auto k = border.border_offset[i]; k < border.border_offset[i + 1]; ++k) {
      const auto& [face, name] = parts[k];
      border.border_face.push_back(face);
      message.item.push_back({name, children.cell_global[at(face.cell)]});
    }
  }

  const auto received = comm.sparse_exchange(messages);
  PAMR_ENSURES(received.rank == border.border_rank && received.offset == border.border_offset);
  border.ghost_global.resize(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    PAMR_ENSURES(received.item[k].name == parts[k].name);
    border.ghost_global[k] = received.item[k].cell;
  }
  return border;
}

}  // namespace pamr::refine
