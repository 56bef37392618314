// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/relink_border.hpp"

namespace pamr::refine {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

class Linker {
 public:
  Linker(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering, const Children& children,
         mesh::DistMesh& fine)
      : old_(old), closure_(closure), numbering_(numbering), children_(children), fine_(fine) {}

  void link_all() {
    constexpr mesh::CellNeighbours open{invalid_local, invalid_local, invalid_local, invalid_local};
    assign_array(fine_.cell_to_cell, fine_.cell_to_node.size(), open);
    auto family = closure_.rebuilt.begin();
    for (LocalId c = 0; c < old_.n_cells(); ++c) {
      if (closure_.action[at(c)] == Action::split) link_split(c);
      if (closure_.action[at(c)] == Action::rebuild) {
        if (closure_.rebuilt.end() - family > 4) prefetch_neighbours(family[4].first);
        link_family(*family++);
      }
    }
  }

  /// New faces on the rank border and the rank on their other side.
  const std::vector<BorderFace>& border() const { return border_; }

 private:
  void set(mesh::CellFace face, LocalId neighbour) { fine_.cell_to_cell[at(face.cell)][at(face.slot)] = neighbour; }

  Rank rank_of_ghost(LocalId slot) const {
    const auto k = at(slot - old_.n_cells());
    const auto next = std::upper_bound(old_.border_offset.begin(), old_.border_offset.end(), k);
    return old_.border_rank[at(next - old_.border_offset.begin() - 1)];
  }

  /// Has what stands round a family fetched while earlier ones are linked: its neighbours are scattered in memory.
  void prefetch_neighbours(LocalId first) const {
    for (int member = 0; member < old_.lineage[at(first)].family_size(); ++member)
      for (const auto next : old_.cell_to_cell[at(first + member)]) {
        if (!old_.is_own(next)) continue;
        __builtin_prefetch(&old_.cell_to_cell[at(next)]);
        __builtin_prefetch(&old_.cell_to_node[at(next)]);
        __builtin_prefetch(&numbering_.first_child[at(next)]);
        __builtin_prefetch(&closure_.action[at(next)]);
        __builtin_prefetch(&children_.state[at(next)]);
      }
  }

  /// Links the children of one cell: siblings by table, the rest face by face.
  void link_split(LocalId c) {
    const auto& pattern = split_pattern[children_.state[at(c)]];
    const auto first = numbering_.first_child[at(c)];
    for (int child = 0; child < pattern.n_children; ++child)
      for (int slot = 0; slot < 4; ++slot) {
        const int link = pattern.child_to_child[at(child)][at(slot)];
        if (link >= 0) fine_.cell_to_cell[at(first + child)][at(slot)] = first + link;
      }
    for (int face = 0; face < 4; ++face) link_face(c, face, pattern, first);
  }

  void link_face(LocalId c, int face, const SplitPattern& pattern, LocalId first) {
    const auto next = old_.cell_to_cell[at(c)][at(face)];
    const auto& child_at = pattern.face_to_child[at(face)];
    const auto& slot_at = pattern.face_to_slot[at(face)];
    if (old_.is_own(next)) {
      // a family that is taken back links its outside itself, to both sides
      if (closure_.action[at(next)] == Action::split) link_by_table(c, next, child_at, slot_at, first);
      return;
    }
    const Rank rank = next >= 0 ? rank_of_ghost(next) : -1;
    for (int place = 0; place < n_places; ++place) {
      if (child_at[at(place)] < 0) continue;
      const mesh::CellFace mine{first + child_at[at(place)], slot_at[at(place)]};
      if (next < 0)
        set(mine, next);
      else
        border_.push_back({mine, rank});
    }
  }

  void link_by_table(LocalId c, LocalId next, const std::array<std::int8_t, n_places>& child_at,
                     const std::array<std::int8_t, n_places>& slot_at, LocalId first) {
    const int there = slot_towards(next, c);
    const auto& child_there = split_pattern[children_.state[at(next)]].face_to_child[at(there)];
    const auto first_there = numbering_.first_child[at(next)];
    if (child_at[whole] >= 0) {
      set({first + child_at[whole], slot_at[whole]}, first_there + child_there[whole]);
      return;
    }
    const auto& corner = old_.cell_to_node[at(c)];
    const auto& corner_there = old_.cell_to_node[at(next)];
    for (int place = 0; place < 4; ++place)
      if (child_at[at(place)] >= 0)
        set({first + child_at[at(place)], slot_at[at(place)]},
            first_there + child_there[at(mesh::slot_of(corner_there, corner[at(place)]))]);
    if (child_at[centre] >= 0) set({first + child_at[centre], slot_at[centre]}, first_there + child_there[centre]);
  }

  /// Siblings by table, generation by generation; then the outside, face by face.
  void link_family(const RebuiltFamily& family) {
    const auto& pattern = split_pattern[at(family.state)];
    std::array<LocalId, max_children + 1> start{numbering_.first_child[at(family.first)]};
    for (int child = 0; child < pattern.n_children; ++child)
      start[at(child) + 1] = start[at(child)] + split_pattern[at(state_of_child(family, child))].n_children;
    for_each_grandchild(family, [&](int child, int state, int grandchild) {
      const auto cell = start[at(child)] + grandchild;
      for (int slot = 0; slot < 4; ++slot) {
        const int inner = split_pattern[at(state)].child_to_child[at(grandchild)][at(slot)];
        if (inner >= 0) {
          set({cell, slot}, start[at(child)] + inner);
          continue;
        }
        const int link = pattern.child_to_child[at(child)][at(outer_face(inner))];
        if (link >= 0)
          set({cell, slot}, start[at(link)] + facing(family, child, link, outer_place(inner)));
        else
          link_outside({cell, slot}, old_face(family.first, outer_face(link), outer_place(link)),
                       outer_place(inner) == whole ? outer_place(link) : outer_place(inner));
      }
    });
  }

  /// Links a face on the outside of a family, part `place` of the old face `behind`, to what is there now.
  void link_outside(mesh::CellFace face, mesh::CellFace behind, int place) {
    const auto next = old_.cell_to_cell[at(behind.cell)][at(behind.slot)];
    if (next < 0) {
      set(face, next);
    } else if (old_.is_ghost(next)) {
      border_.push_back({face, rank_of_ghost(next)});
    } else if (closure_.action[at(next)] == Action::split) {
      const auto twin = part_of(next, slot_towards(next, behind.cell), face, place);
      set(face, twin.cell);
      set(twin, face.cell);
    } else {
      // two families that were both taken back: the second to come finds the open face of the first
      const auto first_there = next - old_.lineage[at(next)].child();
      if (numbering_.first_child[at(first_there)] > face.cell) return;
      const auto twin = find_open(first_there, face);
      set(face, twin.cell);
      set(twin, face.cell);
    }
  }

  /// The face without neighbour, in the children of the family of that first member, that coincides with `face`.
  mesh::CellFace find_open(LocalId first_member, mesh::CellFace face) const {
    const auto corners = [this](mesh::CellFace f) {
      auto nodes = fine_.cell_to_node[at(f.cell)];
      std::swap(nodes[at(f.slot)], nodes[3]);
      return nodes;
    };
    const auto wanted = corners(face);
    const auto begin = numbering_.first_child[at(first_member)];
    const auto end = numbering_.first_child[at(first_member + old_.lineage[at(first_member)].family_size())];
    for (auto cell = begin; cell < end; ++cell)
      for (int slot = 0; slot < 4; ++slot) {
        if (fine_.cell_to_cell[at(cell)][at(slot)] != invalid_local) continue;
        const auto found = corners({cell, slot});
        if (std::is_permutation(wanted.begin(), wanted.begin() + 3, found.begin())) return {cell, slot};
      }
    contract_violated("postcondition", "families side by side show each other the same faces", __FILE__, __LINE__);
  }

  /// The part of face `there` of old cell `next`, split by its own pattern, that coincides with `face`. A kept corner
  /// stays in its slot, so the corner that names the part is found in the new cell.
  mesh::CellFace part_of(LocalId next, int there, mesh::CellFace face, int place) const {
    const auto& pattern = split_pattern[children_.state[at(next)]];
    int part = place;
    if (pattern.face_to_child[at(there)][whole] >= 0)
      part = whole;
    else if (place < 4)
      part = mesh::slot_of(old_.cell_to_node[at(next)], fine_.cell_to_node[at(face.cell)][at(place)]);
    return {numbering_.first_child[at(next)] + pattern.face_to_child[at(there)][at(part)],
            pattern.face_to_slot[at(there)][at(part)]};
  }

  /// Slot of an old cell in which its neighbour `other` stands.
  int slot_towards(LocalId cell, LocalId other) const {
    const auto& next = old_.cell_to_cell[at(cell)];
    return static_cast<int>(next[1] == other) + 2 * static_cast<int>(next[2] == other) +
           3 * static_cast<int>(next[3] == other);
  }

  static int state_of_child(const RebuiltFamily& family, int child) {
    return state_of_mask[family.child_marks[at(child)]];
  }

  /// The grandchild of `sibling` behind the part `place` of the face that `child` shares with it.
  static int facing(const RebuiltFamily& family, int child, int sibling, int place) {
    const auto& pattern = split_pattern[at(family.state)];
    const auto& back = pattern.child_to_child[at(sibling)];
    const auto face = std::find(back.begin(), back.end(), child) - back.begin();
    if (place < 4) {
      const auto& codes = pattern.child_to_node[at(sibling)];
      const auto corner = pattern.child_to_node[at(child)][at(place)];
      place = static_cast<int>(std::find(codes.begin(), codes.end(), corner) - codes.begin());
    }
    return split_pattern[at(state_of_child(family, sibling))].face_to_child[at(face)][at(place)];
  }

  /// The member that showed this part of the parent's face; of a face that had no such part, any member there: one
  /// rank, patch or cell holds all of its other side, or a family that was taken back too.
  mesh::CellFace old_face(LocalId first, int face, int place) const {
    const auto& pattern = split_pattern[at(state_of_family(old_.lineage[at(first)]))];
    for (const int p : {place, 0, 1, 2, 3, centre, whole}) {
      const int member = pattern.face_to_child[at(face)][at(p)];
      if (member >= 0) return {first + member, pattern.face_to_slot[at(face)][at(p)]};
    }
    contract_violated("postcondition", "every face of a parent is shown by a member", __FILE__, __LINE__);
  }

  const mesh::DistMesh& old_;
  const Closure& closure_;
  const Numbering& numbering_;
  const Children& children_;
  mesh::DistMesh& fine_;
  std::vector<BorderFace> border_;
};

}  // namespace

void relink(const par::Comm& comm, const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
            const Children& children, mesh::DistMesh& fine) {
  Linker linker(old, closure, numbering, children, fine);
  linker.link_all();
  link_border(comm, linker.border(), fine);
}

}  // namespace pamr::refine
