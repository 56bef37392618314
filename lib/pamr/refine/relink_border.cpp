// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink_border.hpp"

#include <algorithm>
#include <array>

#include "pamr/base/contract.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// A border face as both sides know it.
struct Record {
  std::array<GlobalId, 3> node;  ///< ascending
  GlobalId cell;
};

struct Own {
  Record record;
  BorderFace border;
};

Own describe(const mesh::DistMesh& mesh, const BorderFace& border) {
  Own own{{{}, mesh.cell_global[at(border.face.cell)]}, border};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto corner = mesh::tet::face_to_corner[at(border.face.slot)][i];
    own.record.node[i] = mesh.node_global[at(mesh.cell_to_node[at(border.face.cell)][at(corner)])];
  }
  std::sort(own.record.node.begin(), own.record.node.end());
  return own;
}

}  // namespace

Rank rank_of_ghost(const mesh::DistMesh& mesh, LocalId slot) {
  const auto k = at(slot - mesh.n_cells());
  const auto next = std::upper_bound(mesh.border_offset.begin(), mesh.border_offset.end(), k);
  return mesh.border_rank[at(next - mesh.border_offset.begin() - 1)];
}

void link_border(const par::Comm& comm, const std::vector<BorderFace>& faces, mesh::DistMesh& fine) {
  std::vector<Own> own;
  own.reserve(faces.size());
  for (const auto& face : faces) own.push_back(describe(fine, face));
  std::sort(own.begin(), own.end(), [](const Own& a, const Own& b) {
    return a.border.rank != b.border.rank ? a.border.rank < b.border.rank : a.record.node < b.record.node;
  });

  fine.border_rank.clear();
  fine.border_offset.assign(1, 0);
  fine.border_face.clear();
  std::vector<par::Outgoing<Record>> messages;
  for (const auto& face : own) {
    if (fine.border_rank.empty() || fine.border_rank.back() != face.border.rank) {
      fine.border_rank.push_back(face.border.rank);
      fine.border_offset.push_back(fine.border_face.size());
      messages.push_back({face.border.rank, {}});
    }
    const auto ghost = fine.n_cells() + static_cast<LocalId>(fine.border_face.size());
    fine.cell_to_cell[at(face.border.face.cell)][at(face.border.face.slot)] = ghost;
    fine.border_face.push_back(face.border.face);
    fine.border_offset.back() = fine.border_face.size();
    messages.back().item.push_back(face.record);
  }

  // both sides list the same faces in the same order, so the records of slot k meet in slot k
  const auto received = comm.sparse_exchange(messages);
  PAMR_ENSURES(received.rank == fine.border_rank && received.item.size() == own.size());
  fine.ghost_global.resize(own.size());
  for (std::size_t k = 0; k < own.size(); ++k) {
    PAMR_ENSURES(received.item[k].node == own[k].record.node);
    fine.ghost_global[k] = received.item[k].cell;
  }
}

}  // namespace pamr::refine
