// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/contract.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/face_table.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/relink_border.hpp"

namespace pamr::refine {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

class Linker {
 public:
  Linker(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering, const Children& children,
         mesh::DistMesh& fine)
      : old_(old),
        closure_(closure),
        numbering_(numbering),
        children_(children),
        fine_(fine),
        table_(fine.cell_to_node, count_rebuilt_faces(closure)) {}

  void link_all() {
    fine_.cell_to_cell.resize(fine_.cell_to_node.size());
    for (const auto& family : closure_.rebuilt) link_inside(family);
    for (LocalId c = 0; c < old_.n_cells(); ++c)
      if (closure_.action[at(c)] == Action::split) link_split(c);
    for (const auto& family : closure_.rebuilt) link_outside(family);
  }

  /// New faces on the rank border and the rank on their other side.
  const std::vector<BorderFace>& border() const { return border_; }

 private:
  static std::size_t count_rebuilt_faces(const Closure& closure) {
    std::size_t n = 0;
    for (const auto& family : closure.rebuilt) n += 4 * at(family.n_children);
    return n;
  }

  void set(mesh::CellFace face, LocalId neighbour) { fine_.cell_to_cell[at(face.cell)][at(face.slot)] = neighbour; }

  Rank rank_of_ghost(LocalId slot) const {
    const auto k = at(slot - old_.n_cells());
    const auto next = std::upper_bound(old_.border_offset.begin(), old_.border_offset.end(), k);
    return old_.border_rank[at(next - old_.border_offset.begin() - 1)];
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
    const bool is_own = old_.is_own(next);
    if (is_own && closure_.action[at(next)] == Action::split) {
      link_by_table(c, next, child_at, slot_at, first);
      return;
    }
    const Rank rank = old_.is_ghost(next) ? rank_of_ghost(next) : -1;
    for (int place = 0; place < n_places; ++place) {
      if (child_at[at(place)] < 0) continue;
      const mesh::CellFace mine{first + child_at[at(place)], slot_at[at(place)]};
      if (next < 0)
        set(mine, next);
      else if (rank >= 0)
        border_.push_back({mine, rank});
      else
        match(mine);
    }
  }

  void link_by_table(LocalId c, LocalId next, const std::array<std::int8_t, n_places>& child_at,
                     const std::array<std::int8_t, n_places>& slot_at, LocalId first) {
    const auto& back = old_.cell_to_cell[at(next)];
    const int there =
        static_cast<int>(back[1] == c) + 2 * static_cast<int>(back[2] == c) + 3 * static_cast<int>(back[3] == c);
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

  /// Links a face with its twin if that has been seen already.
  void match(mesh::CellFace face) {
    const auto twin = table_.find_or_insert(face);
    if (twin == face) return;
    set(face, twin.cell);
    set(twin, face.cell);
  }

  void link_inside(const RebuiltFamily& family) {
    const auto first = numbering_.first_child[at(family.first)];
    for (int n = 0; n < family.n_children; ++n)
      for (int slot = 0; slot < 4; ++slot) {
        set({first + n, slot}, invalid_local);
        match({first + n, slot});
      }
  }

  /// What is still open of a family lies on the boundary or on a rank border: as the old face there did.
  void link_outside(const RebuiltFamily& family) {
    LocalId cell = numbering_.first_child[at(family.first)];
    for_each_grandchild(family, [&](int child, int state, int grandchild) {
      for (int slot = 0; slot < 4; ++slot) {
        if (fine_.cell_to_cell[at(cell)][at(slot)] != invalid_local) continue;
        const int inner = split_pattern[at(state)].child_to_child[at(grandchild)][at(slot)];
        PAMR_ENSURES(inner < 0);
        const int link = split_pattern[at(family.state)].child_to_child[at(child)][at(outer_face(inner))];
        PAMR_ENSURES(link < 0);
        const auto next = old_neighbour(family.first, outer_face(link), outer_place(link));
        PAMR_ENSURES(!old_.is_own(next));
        if (next < 0)
          set({cell, slot}, next);
        else
          border_.push_back({{cell, slot}, rank_of_ghost(next)});
      }
      ++cell;
    });
  }

  /// Neighbour slot of the member that showed this part of the parent's face; of a face that had no such part, any
  /// member's there: one rank or patch holds all of its other side.
  LocalId old_neighbour(LocalId first, int face, int place) const {
    const auto& pattern = split_pattern[at(state_of_family(old_.lineage[at(first)]))];
    for (const int p : {place, 0, 1, 2, 3, centre, whole}) {
      const int member = pattern.face_to_child[at(face)][at(p)];
      if (member >= 0) return old_.cell_to_cell[at(first + member)][at(pattern.face_to_slot[at(face)][at(p)])];
    }
    contract_violated("postcondition", "every face of a parent is shown by a member", __FILE__, __LINE__);
  }

  const mesh::DistMesh& old_;
  const Closure& closure_;
  const Numbering& numbering_;
  const Children& children_;
  mesh::DistMesh& fine_;
  FaceTable table_;
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
