// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink.hpp"

#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/relink_border.hpp"
#include "pamr/refine/relink_family.hpp"

namespace pamr::refine {

namespace {

class Linker {
 public:
  Linker(const NumberedMesh& old, const Children& children)
      : old_(old.mesh), closure_(old.closure), numbering_(old.numbering), children_(children) {
    constexpr mesh::CellNeighbors open{invalid_local, invalid_local, invalid_local, invalid_local};
    assign_array(link_, children.cell_to_node.size(), open);
    border_.reserve(4 * old_.border_face.size());
    FamilyLinker families(old, children, link_, border_);
    std::size_t family = 0;
    for (LocalId c = 0; c < old_.n_cells(); ++c) {
      if (closure_.action[at(c)] == Action::split) link_split(c);
      if (closure_.action[at(c)] == Action::rebuild) families.link(family++);
    }
  }

  /// The links of the children, those over the rank border still open.
  std::vector<mesh::CellNeighbors> take_links() && { return std::move(link_); }
  /// New faces on the rank border.
  const std::vector<BorderFace>& border() const { return border_; }

 private:
  void set(mesh::CellFace face, LocalId neighbor) { link_[at(face.cell)][at(face.slot)] = neighbor; }

  /// Links the children of one cell: siblings by table, the rest face by face.
  void link_split(LocalId c) {
    const auto& pattern = split_pattern[children_.state[at(c)]];
    const auto first = numbering_.first_child[at(c)];
    for (int child = 0; child < pattern.n_children; ++child)
      for (int slot = 0; slot < 4; ++slot) {
        const int link = pattern.child_to_child[at(child)][at(slot)];
        if (link >= 0) link_[at(first + child)][at(slot)] = first + link;
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
    for (int place = 0; place < n_places; ++place) {
      if (child_at[at(place)] < 0) continue;
      const mesh::CellFace mine{first + child_at[at(place)], slot_at[at(place)]};
      if (next < 0)
        set(mine, next);
      else
        border_.push_back({mine, next - old_.n_cells()});
    }
  }

  void link_by_table(LocalId c, LocalId next, const std::array<std::int8_t, n_places>& child_at,
                     const std::array<std::int8_t, n_places>& slot_at, LocalId first) {
    const auto first_there = numbering_.first_child[at(next)];
    if (child_at[whole] >= 0 && children_.state[at(next)] == 0) {  // most faces of a cell that is not split
      set({first + child_at[whole], slot_at[whole]}, first_there);
      return;
    }
    const int there = mesh::slot_of(old_.cell_to_cell[at(next)], c);
    const auto& child_there = split_pattern[children_.state[at(next)]].face_to_child[at(there)];
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
    if (child_at[center] >= 0) set({first + child_at[center], slot_at[center]}, first_there + child_there[center]);
  }

  const mesh::DistMesh& old_;
  const Closure& closure_;
  const Numbering& numbering_;
  const Children& children_;
  std::vector<mesh::CellNeighbors> link_;  ///< of each child
  std::vector<BorderFace> border_;
};

}  // namespace

Links relink(const par::Comm& comm, const NumberedMesh& old, const Children& children,
             const std::vector<GlobalId>& node_global) {
  Linker linker(old, children);
  Links links;
  links.border = link_border(comm, old.mesh, linker.border(), children, node_global);
  links.cell_to_cell = std::move(linker).take_links();
  const auto n_cells = static_cast<LocalId>(children.cell_to_node.size());
  for (LocalId k = 0; const auto face : links.border.border_face)
    links.cell_to_cell[at(face.cell)][at(face.slot)] = n_cells + k++;
  return links;
}

}  // namespace pamr::refine
