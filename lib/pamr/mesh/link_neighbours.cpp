// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/assemble_steps.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/mesh/sorted_order.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh::assembly {

namespace {

/// A face whose other cell is on another rank.
struct RemoteFace {
  Rank rank = 0;
  par::SharedKey key{};
  CellFace face;
  GlobalId other = 0;
};

/// What both sides of a rank-border face say of it.
struct FaceCard {
  par::SharedKey key{};
  GlobalId own = 0;
  GlobalId other = 0;
};

/// Numbers of this rank's cells by their global numbers.
class OwnCells {
 public:
  explicit OwnCells(const std::vector<GlobalId>& id) : first_(id.empty() ? 0 : id.front()), n_(id.size()) {
    if (id.empty() || id.back() - id.front() == static_cast<GlobalId>(id.size()) - 1) return;
    map_ = std::make_unique<IdMap>(id.front(), id.back(), id.size());
    for (std::size_t i = 0; i < id.size(); ++i) map_->find_or_insert(id[i], static_cast<LocalId>(i));
  }
  LocalId find(GlobalId id) const {
    if (map_) return map_->find(id);
    const auto at = static_cast<std::uint64_t>(id - first_);
    return at < n_ ? static_cast<LocalId>(at) : invalid_local;
  }

 private:
  GlobalId first_;
  std::size_t n_;
  std::unique_ptr<IdMap> map_;
};

/// The ranks that hold the cells `id` of other ranks. Collective.
std::vector<Rank> ask_owners(const par::Comm& comm, IdRange cells, const CellOwners& owners,
                             std::vector<RemoteFace>& faces) {
  std::vector<GlobalId> id;
  for (const auto& face : faces) id.push_back(face.other);
  if (owners.first.empty()) return par::fetch_rows<Rank>(comm, cells, owners.of_block, 1, id);
  std::vector<Rank> rank;
  for (const auto cell : id)
    rank.push_back(
        static_cast<Rank>(std::upper_bound(owners.first.begin(), owners.first.end(), cell) - owners.first.begin() - 1));
  return rank;
}

/// Own cells become local neighbours, patches slots; the faces to other ranks are returned.
std::vector<RemoteFace> translate(DistMesh& mesh, const std::vector<std::array<GlobalId, 4>>& neighbour) {
  const OwnCells own(mesh.cell_global);
  std::vector<RemoteFace> remote;
  assign_array(mesh.cell_to_cell, neighbour.size(), CellNeighbours{});
  for (std::size_t c = 0; c < neighbour.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto id = neighbour[c][f];
      const auto local = id < 0 ? static_cast<LocalId>(id) : own.find(id);
      mesh.cell_to_cell[c][f] = local;
      if (local == invalid_local) {
        const CellFace face{static_cast<LocalId>(c), static_cast<int>(f)};
        remote.push_back({0, face_key(mesh, face), face, id});
      }
    }
  return remote;
}

/// Fills the rank-border arrays from the faces, which are sorted by rank and key.
void fill_border(DistMesh& mesh, const std::vector<RemoteFace>& faces) {
  mesh.border_face.reserve(faces.size());
  mesh.ghost_global.reserve(faces.size());
  for (const auto& face : faces) {
    if (mesh.border_rank.empty() || mesh.border_rank.back() != face.rank) {
      mesh.border_rank.push_back(face.rank);
      mesh.border_offset.push_back(mesh.border_face.size());
    }
    mesh.cell_to_cell[static_cast<std::size_t>(face.face.cell)][static_cast<std::size_t>(face.face.slot)] =
        mesh.n_cells() + static_cast<LocalId>(mesh.border_face.size());
    mesh.border_face.push_back(face.face);
    mesh.ghost_global.push_back(face.other);
    mesh.border_offset.back() = mesh.border_face.size();
  }
}

[[noreturn]] void refuse(GlobalId cell, GlobalId neighbour, const par::SharedKey& key) {
  throw Error("cell_to_cell: expected the neighbours of a face to name each other, found cell " + std::to_string(cell) +
              " with neighbour " + std::to_string(neighbour) + " across the face of nodes " + std::to_string(key[0]) +
              " " + std::to_string(key[1]) + " " + std::to_string(key[2]) + ", where cell " +
              std::to_string(neighbour) + " does not name cell " + std::to_string(cell));
}

bool has_node(const CellNodes& nodes, LocalId node) {
  return nodes[0] == node || nodes[1] == node || nodes[2] == node || nodes[3] == node;
}

/// True when cell `d` names `c` across the face opposite corner `f` of `c`.
bool is_returned(const DistMesh& mesh, LocalId c, std::size_t f, LocalId d) {
  const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(c)];
  const auto& other = mesh.cell_to_node[static_cast<std::size_t>(d)];
  for (std::size_t i = 0; i < 4; ++i)
    if (i != f && !has_node(other, nodes[i])) return false;
  for (std::size_t g = 0; g < 4; ++g)
    if (mesh.cell_to_cell[static_cast<std::size_t>(d)][g] == c && (other[g] == nodes[f] || !has_node(nodes, other[g])))
      return true;
  return false;
}

/// True when every own neighbour names its cell in turn: links up (to a cell with a larger number) are returned by as
/// many different links down, and there are no more of these. Of a sound mesh this takes half of looking at both.
bool all_returned(const DistMesh& mesh) {
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

void check_own(const DistMesh& mesh) {
  if (all_returned(mesh)) return;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto d = mesh.cell_to_cell[static_cast<std::size_t>(c)][f];
      if (mesh.is_own(d) && !is_returned(mesh, c, f, d))
        refuse(mesh.cell_global[static_cast<std::size_t>(c)], mesh.cell_global[static_cast<std::size_t>(d)],
               face_key(mesh, {c, static_cast<int>(f)}));
    }
}

/// Both lists are in the same order when they hold the same faces.
void check_side(std::span<const FaceCard> mine, std::span<const FaceCard> theirs) {
  const auto same = [](const FaceCard& a, const FaceCard& b) {
    return a.key == b.key && a.own == b.other && a.other == b.own;
  };
  const auto [here, there] = std::mismatch(mine.begin(), mine.end(), theirs.begin(), theirs.end(), same);
  if (here != mine.end() && (there == theirs.end() || here->key <= there->key))
    refuse(here->own, here->other, here->key);
  if (there != theirs.end()) refuse(there->own, there->other, there->key);
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

void link_neighbours(const par::Comm& comm, DistMesh& mesh, std::vector<std::array<GlobalId, 4>> neighbour,
                     const CellOwners& owners) {
  auto remote = translate(mesh, neighbour);
  neighbour = {};
  const auto rank = ask_owners(comm, mesh.info.cell_ids(), owners, remote);
  std::vector<par::SharedKey> key(remote.size());
  for (std::size_t i = 0; i < remote.size(); ++i) {
    remote[i].rank = rank[i];
    key[i] = remote[i].key;
  }
  {
    std::vector<RemoteFace> sorted;
    sorted.reserve(remote.size());
    for (const auto i : border_order(rank, key)) sorted.push_back(remote[i]);
    remote = std::move(sorted);
  }
  fill_border(mesh, remote);

  std::vector<par::Outgoing<FaceCard>> messages;
  for (const auto& face : remote) {
    if (messages.empty() || messages.back().to != face.rank) messages.push_back({face.rank, {}});
    messages.back().item.push_back({face.key, mesh.cell_global[static_cast<std::size_t>(face.face.cell)], face.other});
  }
  const auto arrived = comm.sparse_exchange(messages);
  par::agree(comm, [&] {
    check_own(mesh);
    for (std::size_t r = 0; r < arrived.rank.size(); ++r) {
      const auto mine = std::find_if(messages.begin(), messages.end(),
                                     [&](const auto& message) { return message.to == arrived.rank[r]; });
      check_side(mine == messages.end() ? std::span<const FaceCard>{} : std::span<const FaceCard>(mine->item),
                 arrived.from(r));
    }
    for (const auto& message : messages)
      if (std::find(arrived.rank.begin(), arrived.rank.end(), message.to) == arrived.rank.end())
        check_side(message.item, {});
  });
}

}  // namespace pamr::mesh::assembly
