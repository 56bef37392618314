// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/coarse_links.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/rank_border.hpp"

namespace pamr::coarsen {

namespace {

using mesh::CellFace;

/// Faces that wait for the one on their other side, by their nodes.
class WaitingFaces {
 public:
  explicit WaitingFaces(std::size_t n_expected) : table_(std::bit_ceil(2 * n_expected + 16)) {}

  /// The face with the same nodes that came before; nothing: this one waits now.
  std::optional<CellFace> match(const mesh::CellNodes& nodes, CellFace face) {
    const auto& corner = mesh::tet::face_to_corner[at(face.slot)];
    std::array<LocalId, 3> key{nodes[at(corner[0])], nodes[at(corner[1])], nodes[at(corner[2])]};
    std::sort(key.begin(), key.end());
    if (2 * ++n_ > table_.size()) grow();
    auto& entry = place_of(key);
    if (entry.key[0] != invalid_local) return entry.face;
    entry = {key, face};
    return {};
  }

 private:
  struct Entry {
    std::array<LocalId, 3> key{invalid_local, invalid_local, invalid_local};
    CellFace face;
  };

  Entry& place_of(const std::array<LocalId, 3>& key) {
    auto i = combine(static_cast<std::uint64_t>(key[0]) << 32U | static_cast<std::uint64_t>(key[1]),
                     static_cast<std::uint64_t>(key[2])) &
             (table_.size() - 1);
    while (table_[i].key[0] != invalid_local && table_[i].key != key) i = (i + 1) & (table_.size() - 1);
    return table_[i];
  }
  void grow() {
    const auto before = std::exchange(table_, std::vector<Entry>(2 * table_.size()));
    for (const auto& entry : before)
      if (entry.key[0] != invalid_local) place_of(entry.key) = entry;
  }

  std::vector<Entry> table_;
  std::size_t n_ = 0;
};

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
      : old_(old), groups_(groups), places_(places), coarse_(coarse), waiting_(3 * groups.size()) {
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

  void match(CellFace face) {
    if (const auto other = waiting_.match(coarse_.cell_to_node[at(face.cell)], face)) {
      link(face) = other->cell;
      link(*other) = face.cell;
    }
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
      else if (places_.is_in_group(next))
        match(face);
      else
        link(face) = places_.cell[at(next)];
    }
  }

  /// What lies behind the faces of a group's parent.
  struct Behind {
    LocalId patch = 0;  ///< slot of a patch, or 0
    bool is_own = false;
    std::vector<Rank> ranks;
  };

  void look_behind(const Group& group, std::array<Behind, 4>& behind) const {
    for (auto& b : behind) {
      b.patch = 0;
      b.is_own = false;
      b.ranks.clear();
    }
    for_each_outer_face(old_, group, [&](LocalId cell, int slot, int face) {
      auto& b = behind[at(face)];
      const auto next = old_.cell_to_cell[at(cell)][at(slot)];
      if (next < 0) {
        b.patch = next;
      } else if (old_.is_own(next)) {
        b.is_own = true;
      } else {
        const auto rank = rank_of_face_[at(next - old_.n_cells())];
        if (std::find(b.ranks.begin(), b.ranks.end(), rank) == b.ranks.end()) b.ranks.push_back(rank);
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
        if (b.is_own) match(face);
        if (link(face) != invalid_local) continue;
        for (const auto rank : b.ranks) add_remote(face, rank);
      }
  }

  const mesh::DistMesh& old_;
  std::span<const Group> groups_;
  const NewPlaces& places_;
  mesh::DistMesh& coarse_;
  WaitingFaces waiting_;
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
