// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink_border.hpp"

#include <algorithm>
#include <array>

#include "pamr/base/contract.hpp"
#include "pamr/mesh/sorted_order.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// A border face as both sides know it.
struct Record {
  par::SharedKey node;  ///< ascending
  GlobalId cell;
};

par::SharedKey nodes_of(const mesh::DistMesh& mesh, mesh::CellFace face) {
  std::array<GlobalId, 3> id{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto corner = mesh::tet::face_to_corner[at(face.slot)][i];
    id[i] = mesh.node_global[at(mesh.cell_to_node[at(face.cell)][at(corner)])];
  }
  const auto least = std::min({id[0], id[1], id[2]}), most = std::max({id[0], id[1], id[2]});
  return {least, id[0] ^ id[1] ^ id[2] ^ least ^ most, most};
}

}  // namespace

Rank rank_of_ghost(const mesh::DistMesh& mesh, LocalId slot) {
  const auto k = at(slot - mesh.n_cells());
  const auto next = std::upper_bound(mesh.border_offset.begin(), mesh.border_offset.end(), k);
  return mesh.border_rank[at(next - mesh.border_offset.begin() - 1)];
}

void link_border(const par::Comm& comm, const std::vector<BorderFace>& faces, mesh::DistMesh& fine) {
  std::vector<Rank> rank(faces.size());
  std::vector<par::SharedKey> key(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    rank[i] = faces[i].rank;
    key[i] = nodes_of(fine, faces[i].face);
  }
  const auto order = mesh::border_order(rank, key);

  fine.border_rank.clear();
  fine.border_offset.assign(1, 0);
  fine.border_face.clear();
  fine.border_face.reserve(faces.size());
  std::vector<par::Outgoing<Record>> messages;
  for (std::size_t k = 0, end = 0; k < order.size(); ++k) {
    const auto i = order[k];
    if (k == end) {
      while (end < order.size() && rank[order[end]] == rank[i]) ++end;
      fine.border_rank.push_back(rank[i]);
      fine.border_offset.push_back(k);
      messages.push_back({rank[i], {}});
      messages.back().item.reserve(end - k);
    }
    const auto face = faces[i].face;
    const auto ghost = fine.n_cells() + static_cast<LocalId>(fine.border_face.size());
    fine.cell_to_cell[at(face.cell)][at(face.slot)] = ghost;
    fine.border_face.push_back(face);
    fine.border_offset.back() = fine.border_face.size();
    messages.back().item.push_back({key[i], fine.cell_global[at(face.cell)]});
  }

  // both sides list the same faces in the same order, so the records of slot k meet in slot k
  const auto received = comm.sparse_exchange(messages);
  PAMR_ENSURES(received.rank == fine.border_rank && received.item.size() == order.size());
  fine.ghost_global.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    PAMR_ENSURES(received.item[k].node == key[order[k]]);
    fine.ghost_global[k] = received.item[k].cell;
  }
}

}  // namespace pamr::refine
