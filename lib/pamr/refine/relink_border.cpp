// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink_border.hpp"

#include <algorithm>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
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

/// The faces by old border face, the parts of one by their names. `end[k]`: where those of old face `k` end.
std::vector<Part> in_order(const std::vector<BorderFace>& faces, const mesh::DistMesh& fine,
                           std::vector<std::size_t>& end) {
  for (const auto& face : faces) ++end[at(face.old_face) + 1];
  for (std::size_t k = 1; k < end.size(); ++k) end[k] += end[k - 1];
  std::vector<Part> parts(faces.size());
  for (const auto& face : faces) parts[end[at(face.old_face)]++] = {face.face, mesh::face_name(fine, face.face)};
  const auto comes_first = [&](const Part& a, const Part& b) {
    return a.name != b.name ? a.name < b.name : mesh::face_key(fine, a.face) < mesh::face_key(fine, b.face);
  };
  for (std::size_t k = 0, begin = 0; k + 1 < end.size(); begin = end[k++])
    for (auto i = begin + 1; i < end[k]; ++i) {  // four parts, rarely more
      const auto part = parts[i];
      auto place = i;
      for (; place > begin && comes_first(part, parts[place - 1]); --place) parts[place] = parts[place - 1];
      parts[place] = part;
    }
  return parts;
}

}  // namespace

void link_border(const par::Comm& comm, const mesh::DistMesh& old, const std::vector<BorderFace>& faces,
                 mesh::DistMesh& fine) {
  std::vector<std::size_t> end(old.border_face.size() + 1, 0);
  const auto parts = in_order(faces, fine, end);

  fine.border_rank = old.border_rank;
  fine.border_offset.assign(1, 0);
  fine.border_face.clear();
  fine.border_face.reserve(parts.size());
  std::vector<par::Outgoing<Record>> messages;
  for (std::size_t i = 0; i < old.border_rank.size(); ++i) {
    fine.border_offset.push_back(end[old.border_offset[i + 1] - 1]);
    auto& message = messages.emplace_back(par::Outgoing<Record>{old.border_rank[i], {}});
    message.item.reserve(fine.border_offset[i + 1] - fine.border_offset[i]);
    for (auto k = fine.border_offset[i]; k < fine.border_offset[i + 1]; ++k) {
      const auto& [face, name] = parts[k];
      fine.cell_to_cell[at(face.cell)][at(face.slot)] = fine.n_cells() + static_cast<LocalId>(k);
      fine.border_face.push_back(face);
      message.item.push_back({name, fine.cell_global[at(face.cell)]});
    }
  }

  const auto received = comm.sparse_exchange(messages);
  PAMR_ENSURES(received.rank == fine.border_rank && received.offset == fine.border_offset);
  fine.ghost_global.resize(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    PAMR_ENSURES(received.item[k].name == parts[k].name);
    fine.ghost_global[k] = received.item[k].cell;
  }
}

}  // namespace pamr::refine
