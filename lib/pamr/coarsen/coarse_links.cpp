// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/coarse_links.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/rank_border.hpp"

namespace pamr::coarsen {

namespace {

using mesh::CellFace;

/// The slot of the face with these nodes; below 0: the cell has no such face.
int face_with(const mesh::CellNodes& cell, const std::array<LocalId, 3>& nodes) {
  int rest = 0 + 1 + 2 + 3;  // a face has the slot of the corner that it does not have
  for (const auto node : nodes) {
    const auto found = std::find(cell.begin(), cell.end(), node);
    if (found == cell.end()) return -1;
    rest -= static_cast<int>(found - cell.begin());
  }
  return rest;
}

/// A face of the coarse mesh whose other side may lie on that rank.
struct MaybeRemote {
  Rank rank = 0;
  par::SharedKey key{};
  CellFace face;
};

struct Record {
  par::SharedKey key;
  GlobalId cell;
};

class Linker {
 public:
  Linker(const mesh::DistMesh& old, std::span<const Group> groups, const NewPlaces& places, mesh::DistMesh& coarse)
      : old_(old), groups_(groups), places_(places), coarse_(coarse) {
    constexpr mesh::CellNeighbors open{invalid_local, invalid_local, invalid_local, invalid_local};
    assign_array(coarse_.cell_to_cell, coarse_.cell_to_node.size(), open);
    for (std::size_t i = 0; i < old_.border_rank.size(); ++i)
      rank_of_face_.insert(rank_of_face_.end(), old_.border_offset[i + 1] - old_.border_offset[i], old_.border_rank[i]);
    for (LocalId c = 0; c < old_.n_cells(); ++c)
      if (!places_.is_in_group(c)) link_cell(c);
    for (std::size_t g = 0; g < groups_.size(); ++g) link_group(g);
    // faces whose other side was found here after all
    std::erase_if(remote_, [&](const MaybeRemote& r) { return link(r.face) != invalid_local; });
  }

  const std::vector<MaybeRemote>& remote() const { return remote_; }

 private:
  LocalId& link(CellFace face) { return coarse_.cell_to_cell[at(face.cell)][at(face.slot)]; }

  void add_remote(CellFace face, Rank rank) { remote_.push_back({rank, mesh::face_key(coarse_, face), face}); }

  std::array<LocalId, 3> nodes_of(CellFace face) const {
    const auto& nodes = coarse_.cell_to_node[at(face.cell)];
    const auto& corner = mesh::tet::face_to_corner[at(face.slot)];
    return {nodes[at(corner[0])], nodes[at(corner[1])], nodes[at(corner[2])]};
  }

  /// Links a face with that of the same nodes of another cell, if that has it.
  bool link_to_cell(CellFace face, const std::array<LocalId, 3>& nodes, LocalId cell) {
    const int slot = face_with(coarse_.cell_to_node[at(cell)], nodes);
    if (slot < 0) return false;
    link(face) = cell;
    link({cell, slot}) = face.cell;
    return true;
  }

  /// The same for the cells that take a group's place.
  bool link_to_group(CellFace face, const std::array<LocalId, 3>& nodes, std::size_t g) {
    const auto first = places_.first_of_group[g];
    for (auto cell = first; cell < first + refine::split_pattern[groups_[g].now].n_children; ++cell)
      if (link_to_cell(face, nodes, cell)) return true;
    return false;
  }

  void link_cell(LocalId c) {
    const auto cell = places_.cell[at(c)];
    for (int slot = 0; slot < 4; ++slot) {
      const CellFace face{cell, slot};
      const auto next = old_.cell_to_cell[at(c)][at(slot)];
      if (next < 0)
        link(face) = next;
      else if (!old_.is_own(next))
        add_remote(face, rank_of_face_[at(next - old_.n_cells())]);
      else if (!places_.is_in_group(next))  // else the group finds this face
        link(face) = places_.cell[at(next)];
    }
  }

  template <class T>
  static void add_once(T item, std::vector<T>& items) {
    if (std::find(items.begin(), items.end(), item) == items.end()) items.push_back(item);
  }

  /// What lies behind the faces of a group's parent.
  struct Behind {
    LocalId patch = 0;                ///< slot of a patch, or 0
    std::vector<LocalId> cells;       ///< of this rank that stay, by their new numbers
    std::vector<std::size_t> groups;  ///< of this rank
    std::vector<Rank> ranks;
  };

  void look_behind(const Group& group, std::array<Behind, 4>& behind) const {
    for (auto& b : behind) {
      b.patch = 0;
      b.cells.clear();
      b.groups.clear();
      b.ranks.clear();
    }
    for_each_outer_face(old_, group, [&](LocalId cell, int slot, int face) {
      auto& b = behind[at(face)];
      const auto next = old_.cell_to_cell[at(cell)][at(slot)];
      if (next < 0) {
        b.patch = next;
      } else if (old_.is_own(next)) {
        if (places_.is_in_group(next))
          add_once(places_.group_of(next), b.groups);
        else
          b.cells.push_back(places_.cell[at(next)]);
      } else {
        add_once(rank_of_face_[at(next - old_.n_cells())], b.ranks);
      }
    });
  }

  void link_group(std::size_t g) {
    const auto& group = groups_[g];
    look_behind(group, behind_);
    const auto& pattern = refine::split_pattern[group.now];
    const auto first = places_.first_of_group[g];
    for (int child = 0; child < pattern.n_children; ++child)
      for (int slot = 0; slot < 4; ++slot) {
        const CellFace face{first + child, slot};
        const int code = pattern.child_to_child[at(child)][at(slot)];
        if (code >= 0) {
          link(face) = first + code;
          continue;
        }
        const auto& b = behind_[at(refine::outer_face(code))];
        if (b.patch < 0) {
          link(face) = b.patch;
          continue;
        }
        if (link(face) != invalid_local) continue;  // by the group behind it
        const auto nodes = nodes_of(face);
        const auto links_cell = [&](LocalId cell) { return link_to_cell(face, nodes, cell); };
        const auto links_group = [&](std::size_t other) { return link_to_group(face, nodes, other); };
        if (std::any_of(b.cells.begin(), b.cells.end(), links_cell) ||
            std::any_of(b.groups.begin(), b.groups.end(), links_group))
          continue;
        for (const auto rank : b.ranks) add_remote(face, rank);
      }
  }

  const mesh::DistMesh& old_;
  std::span<const Group> groups_;
  const NewPlaces& places_;
  mesh::DistMesh& coarse_;
  std::vector<Rank> rank_of_face_;  ///< of each old border face
  std::array<Behind, 4> behind_;
  std::vector<MaybeRemote> remote_;
};

/// Which of these faces are on a rank border, and the cells behind them. Collective.
std::vector<mesh::RemoteFace> find_remote(const par::Comm& comm, const mesh::DistMesh& mesh,
                                          std::vector<MaybeRemote> mine) {
  std::sort(mine.begin(), mine.end(), [](const MaybeRemote& a, const MaybeRemote& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.key < b.key;
  });
  std::vector<par::Outgoing<Record>> messages;
  for (const auto& face : mine) {
    if (messages.empty() || messages.back().to != face.rank) messages.push_back({face.rank, {}});
    messages.back().item.push_back({face.key, mesh.cell_global[at(face.face.cell)]});
  }
  const auto received = comm.sparse_exchange(messages);
  std::vector<mesh::RemoteFace> found;
  auto own = mine.begin();
  for (std::size_t i = 0; i < received.rank.size(); ++i) {
    while (own != mine.end() && own->rank < received.rank[i]) ++own;
    for (const auto& record : received.from(i)) {  // both sides have sorted theirs
      while (own != mine.end() && own->rank == received.rank[i] && own->key < record.key) ++own;
      if (own != mine.end() && own->rank == received.rank[i] && own->key == record.key)
        found.push_back({own->face, own->rank, record.cell});
    }
  }
  return found;
}

}  // namespace

void link_coarse(const par::Comm& comm, const mesh::DistMesh& old, std::span<const Group> groups,
                 const NewPlaces& places, mesh::DistMesh& coarse) {
  std::vector<MaybeRemote> maybe;
  {
    const Linker linker(old, groups, places, coarse);
    maybe = linker.remote();
  }
  mesh::fill_border(comm.rank(), coarse, find_remote(comm, coarse, std::move(maybe)));
  par::agree(comm, [&] {
    for (std::size_t c = 0; c < coarse.cell_to_cell.size(); ++c)
      for (const auto slot : coarse.cell_to_cell[c])
        if (slot == invalid_local)
          throw Error(
              fmt::format("lineage: expected cells whose history is that of their neighbors, found cell {} of the "
                          "coarse mesh with a face that has no other side",
                          coarse.cell_global[c]));
  });
}

}  // namespace pamr::coarsen
