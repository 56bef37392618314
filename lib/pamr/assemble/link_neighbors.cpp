// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/link_neighbors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/border_agrees.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/mesh/rank_border.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::assemble {

namespace {

using mesh::FaceRecord;

/// Numbers of this rank's cells by their global numbers.
class OwnCells {
 public:
  explicit OwnCells(const std::vector<GlobalId>& id) : first_(id.empty() ? 0 : id.front()), n_(id.size()) {
    if (id.empty() || id.back() - id.front() == static_cast<GlobalId>(id.size()) - 1) return;
    map_ = std::make_unique<mesh::IdMap>(id.front(), id.back(), id.size());
    for (std::size_t i = 0; i < id.size(); ++i) map_->find_or_insert(id[i], static_cast<LocalId>(i));
  }
  LocalId find(GlobalId id) const {
    if (map_) return map_->find(id);
    const auto place = static_cast<std::uint64_t>(id - first_);
    return place < n_ ? static_cast<LocalId>(place) : invalid_local;
  }

 private:
  GlobalId first_;
  std::size_t n_;
  std::unique_ptr<mesh::IdMap> map_;
};

/// Finds the ranks that hold the other cells. Collective.
void ask_owners(const par::Comm& comm, IdRange cells, const CellOwners& owners, std::vector<mesh::RemoteFace>& faces) {
  if (owners.first.empty()) {
    std::vector<GlobalId> id;
    for (const auto& face : faces) id.push_back(face.other);
    const auto rank = par::fetch_rows<Rank>(comm, cells, owners.of_block, 1, id);
    for (std::size_t i = 0; i < faces.size(); ++i) faces[i].rank = rank[i];
    return;
  }
  for (auto& face : faces) {
    const auto next = std::upper_bound(owners.first.begin(), owners.first.end(), face.other);
    face.rank = static_cast<Rank>(next - owners.first.begin() - 1);
  }
}

/// Own cells become local neighbors, patches slots; the faces to other ranks are returned.
std::vector<mesh::RemoteFace> translate(mesh::DistMesh& mesh, const std::vector<std::array<GlobalId, 4>>& neighbor) {
  const OwnCells own(mesh.cell_global);
  std::vector<mesh::RemoteFace> remote;
  assign_array(mesh.cell_to_cell, neighbor.size(), mesh::CellNeighbors{});
  for (std::size_t c = 0; c < neighbor.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto id = neighbor[c][f];
      const auto local = id < 0 ? static_cast<LocalId>(id) : own.find(id);
      mesh.cell_to_cell[c][f] = local;
      if (local == invalid_local) remote.push_back({{static_cast<LocalId>(c), static_cast<int>(f)}, 0, id});
    }
  return remote;
}

[[noreturn]] void refuse(GlobalId cell, GlobalId neighbor, const par::SharedKey& key) {
  throw Error(fmt::format(
      "cell_to_cell: expected the neighbors of a face to name each other, found cell {} with neighbor {} across the "
      "face of nodes {} {} {}, where cell {} does not name cell {}",
      cell, neighbor, key[0], key[1], key[2], neighbor, cell));
}

bool has_node(const mesh::CellNodes& nodes, LocalId node) {
  return nodes[0] == node || nodes[1] == node || nodes[2] == node || nodes[3] == node;
}

/// True when cell `d` names `c` across the face opposite corner `f` of `c`.
bool is_returned(const mesh::DistMesh& mesh, LocalId c, std::size_t f, LocalId d) {
  const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(c)];
  const auto& other = mesh.cell_to_node[static_cast<std::size_t>(d)];
  for (std::size_t i = 0; i < 4; ++i)
    if (i != f && !has_node(other, nodes[i])) return false;
  for (std::size_t g = 0; g < 4; ++g)
    if (mesh.cell_to_cell[static_cast<std::size_t>(d)][g] == c && (other[g] == nodes[f] || !has_node(nodes, other[g])))
      return true;
  return false;
}

/// True when every own neighbor names its cell in turn: links up (to a cell with a larger number) are returned by as
/// many different links down, and there are no more of these. Of a sound mesh this takes half of looking at both.
bool all_returned(const mesh::DistMesh& mesh) {
  std::int64_t n_up = 0, n_down = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto d = mesh.cell_to_cell[static_cast<std::size_t>(c)][f];
      if (!mesh.is_own(d)) continue;
      if (d > c && !is_returned(mesh, c, f, d)) return false;
      (d > c ? n_up : n_down) += 1;
    }
  return n_up == n_down;
}

void check_own(const mesh::DistMesh& mesh) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto d = mesh.cell_to_cell[static_cast<std::size_t>(c)][f];
      if (mesh.is_own(d) && !is_returned(mesh, c, f, d))
        refuse(mesh.cell_global[static_cast<std::size_t>(c)], mesh.cell_global[static_cast<std::size_t>(d)],
               mesh::face_key(mesh, {c, static_cast<int>(f)}));
    }
}

/// Both lists are in the same order when they hold the same faces.
void check_side(std::span<const FaceRecord> mine, std::span<const FaceRecord> theirs) {
  const auto same = [](const FaceRecord& a, const FaceRecord& b) {
    return a.key == b.key && a.own == b.other && a.other == b.own;
  };
  const auto [here, there] = std::mismatch(mine.begin(), mine.end(), theirs.begin(), theirs.end(), same);
  if (here != mine.end() && (there == theirs.end() || here->key <= there->key))
    refuse(here->own, here->other, here->key);
  if (there != theirs.end()) refuse(there->own, there->other, there->key);
}

/// Says which neighbors do not name each other. Collective: one sparse exchange.
void refuse_neighbors(const par::Comm& comm, const mesh::DistMesh& mesh) {
  auto messages = mesh::for_each_border_face<FaceRecord>(mesh, [&](std::size_t k) {
    const auto face = mesh.border_face[k];
    return FaceRecord{mesh::face_key(mesh, face), mesh.cell_global[at(face.cell)], mesh.ghost_global[k]};
  });
  for (auto& message : messages)
    std::sort(message.item.begin(), message.item.end(),
              [](const FaceRecord& a, const FaceRecord& b) { return a.key < b.key; });
  const auto arrived = comm.sparse_exchange(messages);
  par::agree(comm, [&] {
    check_own(mesh);
    for (std::size_t r = 0; r < arrived.rank.size(); ++r) {
      const auto mine = std::find_if(messages.begin(), messages.end(),
                                     [&](const auto& message) { return message.to == arrived.rank[r]; });
      check_side(mine == messages.end() ? std::span<const FaceRecord>{} : std::span<const FaceRecord>(mine->item),
                 arrived.from(r));
    }
    for (const auto& message : messages)
      if (std::find(arrived.rank.begin(), arrived.rank.end(), message.to) == arrived.rank.end())
        check_side(message.item, {});
  });
  unreachable("neighbors that are not returned have been refused");
}

}  // namespace

CellOwners find_owners(const par::Comm& comm, IdRange cells, const std::vector<GlobalId>& id,
                       const Contents& contents) {
  CellOwners owners;
  if (contents.has_destinations) {
    const std::vector<Rank> me(id.size(), comm.rank());
    owners.of_block = par::scatter_rows<Rank>(comm, cells, me, 1, id);
    return owners;
  }
  owners.first = comm.all_gather(id.empty() ? -1 : id.front());
  GlobalId next = cells.end();
  for (auto first = owners.first.rbegin(); first != owners.first.rend(); ++first) {
    if (*first < 0) *first = next;
    next = *first;
  }
  return owners;
}

void link_neighbors(const par::Comm& comm, mesh::DistMesh& mesh, std::vector<std::array<GlobalId, 4>> neighbor,
                    const CellOwners& owners) {
  auto remote = translate(mesh, neighbor);
  free_array(neighbor);
  ask_owners(comm, mesh.info.cell_ids(), owners, remote);
  mesh::fill_border(comm.rank(), mesh, remote);
  const bool on_border = mesh::border_agrees(
      comm, mesh, [&](std::size_t k, bool is_lower) { return mesh::border_word(mesh, k, is_lower); });
  if (comm.any(!on_border || !all_returned(mesh))) refuse_neighbors(comm, mesh);
}

}  // namespace pamr::assemble
