// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/relink_family.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::refine {

namespace {

/// Old cells in a block of the index of families.
constexpr int block_bits = 3;

/// Number of marks on a face of a cell that is split by a state.
int marks_on(int state, int face) { return n_face_marks[split_pattern[at(state)].mask][at(face)]; }

/// `link >= 0 ? inner : outer` without a branch: which it is follows no order that a processor could foresee.
constexpr LocalId if_inner(std::int8_t link, LocalId inner, LocalId outer) {
  const int is_outer = link >> 7;  // all bits or none
  return (outer & is_outer) | (inner & ~is_outer);
}

}  // namespace

FamilyLinker::FamilyLinker(const NumberedMesh& old, const Children& children, std::vector<mesh::CellNeighbors>& links,
                           std::vector<BorderFace>& border)
    : old_(old.mesh),
      closure_(old.closure),
      numbering_(old.numbering),
      children_(children),
      link_(links),
      border_(border) {
  if (closure_.rebuilt.empty()) return;
  block_to_family_.reserve(at(old_.n_cells() >> block_bits) + 1);
  LocalId family = 0;
  for (LocalId block = 0; block <= old_.n_cells() >> block_bits; ++block) {
    while (at(family) < closure_.rebuilt.size() && closure_.rebuilt[at(family)].first >> block_bits < block) ++family;
    block_to_family_.push_back(family);
  }
}

const RebuiltFamily& FamilyLinker::family_of(LocalId first_member) const {
  auto i = at(block_to_family_[at(first_member >> block_bits)]);
  while (closure_.rebuilt[i].first < first_member) ++i;
  return closure_.rebuilt[i];
}

void FamilyLinker::link(std::size_t i) {
  constexpr std::size_t ahead = 3;
  if (i + 2 * ahead < closure_.rebuilt.size()) prefetch_neighbors(closure_.rebuilt[i + 2 * ahead].first);
  if (i + ahead < closure_.rebuilt.size()) prefetch_children_behind(closure_.rebuilt[i + ahead].first);
  const auto parent = gather(closure_.rebuilt[i]);
  link_siblings(parent);
  for (int face = 0; face < 4; ++face) link_face(parent, face);
}

/// Has what surrounds a family fetched while earlier ones are linked: its neighbors are scattered in memory. To
/// fetch siblings, too, and the first cell where there is none costs less than to tell them apart.
void FamilyLinker::prefetch_neighbors(LocalId first) const {
  const auto end = first + old_.lineage[at(first)].family_size();
  for (auto member = first; member < end; ++member)
    for (const auto slot : old_.cell_to_cell[at(member)]) {
      const auto next = old_.is_own(slot) ? at(slot) : 0;
      prefetch(&old_.lineage[next]);
      prefetch(&old_.cell_to_cell[next]);
      prefetch(&old_.cell_to_node[next]);
      prefetch(&numbering_.first_child[next]);
      prefetch(&closure_.action[next]);
      prefetch(&children_.state[next]);
    }
}

/// Has the links of the children on the other side fetched, the first and the last of each cell: most are written, too.
void FamilyLinker::prefetch_children_behind(LocalId first) const {
  const auto end = first + old_.lineage[at(first)].family_size();
  for (auto member = first; member < end; ++member)
    for (const auto slot : old_.cell_to_cell[at(member)]) {
      const auto next = old_.is_own(slot) ? at(slot) : 0;
      prefetch(link_.data() + numbering_.first_child[next]);
      prefetch(link_.data() + numbering_.first_child[next + 1] - 1);
    }
}

FamilyLinker::Parent FamilyLinker::gather(const RebuiltFamily& family) const {
  Parent parent;
  parent.first_member = family.first;
  parent.before = old_.lineage[at(family.first)].state();
  parent.now = family.state;
  auto next = numbering_.first_child[at(family.first)];
  for (int child = 0; child < max_children; ++child) {  // those beyond the last are nobody's
    parent.child[at(child)] = &split_pattern[family.child_state[at(child)]];
    parent.start[at(child)] = next;
    next += parent.child[at(child)]->n_children;
  }
  for (int code = 0; code < 10; ++code) {
    const auto [member, slot] = family_table[at(parent.before)].node[at(code)];
    const auto node = old_.cell_to_node[at(family.first + std::max<int>(member, 0))][at(slot)];
    parent.node[at(code)] = member < 0 ? invalid_local : node;
  }
  return parent;
}

/// Siblings of both generations: first those that are not split once more, which most are, without branches; then the
/// others and both sides of their faces.
void FamilyLinker::link_siblings(const Parent& parent) {
  const auto& pattern = split_pattern[at(parent.now)];
  bool all_are_whole = true;
  for (int c = 0; c < pattern.n_children; ++c) {
    all_are_whole = all_are_whole && parent.child[at(c)]->n_children == 1;
    const auto& sibling = pattern.child_to_child[at(c)];
    auto& link = link_[at(parent.start[at(c)])];
    for (std::size_t face = 0; face < 4; ++face)
      link[face] = if_inner(sibling[face], parent.start[at(sibling[face] & (max_children - 1))], link[face]);
  }
  if (all_are_whole) return;
  for (int c = 0; c < pattern.n_children; ++c)
    if (parent.child[at(c)]->n_children > 1) link_split_child(parent, c);
}

/// Links the children of a child that is split once more to each other and to its siblings.
void FamilyLinker::link_split_child(const Parent& parent, int c) {
  const auto& child = *parent.child[at(c)];
  const auto start = parent.start[at(c)];
  for (int grandchild = 0; grandchild < child.n_children; ++grandchild) {
    const auto& sibling = child.child_to_child[at(grandchild)];
    auto& link = link_[at(start + grandchild)];
    for (std::size_t slot = 0; slot < 4; ++slot)
      link[slot] = if_inner(sibling[slot], start + sibling[slot], link[slot]);
  }
  for (int face = 0; face < 4; ++face) {
    const int sibling = split_pattern[at(parent.now)].child_to_child[at(c)][at(face)];
    if (sibling < 0) continue;
    const auto& seen = sibling_face[at(parent.now)][at(c)][at(face)];
    const auto& there = *parent.child[at(sibling)];
    const auto start_there = parent.start[at(sibling)];
    for (int place = 0; place < n_places; ++place) {
      const int part = child.face_to_child[at(face)][at(place)];
      if (part < 0) continue;
      const auto place_there = at(place < 4 ? seen.corner[at(place)] : place);
      set_both({start + part, child.face_to_slot[at(face)][at(place)]},
               {start_there + there.face_to_child[at(seen.face)][place_there],
                there.face_to_slot[at(seen.face)][place_there]});
    }
  }
}

/// A face that was split and keeps its parts is linked part by part of the old face; any other as one: one rank, patch
/// or cell holds all of its other side, or a family that was taken back too.
void FamilyLinker::link_face(const Parent& parent, int face) {
  const auto& before = split_pattern[at(parent.before)];
  const bool keeps_parts = marks_on(parent.before, face) == marks_on(parent.now, face);
  for (int place = 0; place < n_places; ++place) {
    const int member = before.face_to_child[at(face)][at(place)];
    if (member < 0) continue;
    const mesh::CellFace behind{parent.first_member + member, before.face_to_slot[at(face)][at(place)]};
    if (!keeps_parts || place == whole) {
      link_region(parent, face, all_places, behind);
      return;
    }
    if (link_region(parent, face, place, behind)) return;
  }
}

/// The first of the rank-border faces that a face of the parent was in the old mesh: the other side finds the same.
LocalId FamilyLinker::lowest_border_face(const Parent& parent, int face) const {
  const auto& before = split_pattern[at(parent.before)];
  LocalId lowest = old_.n_cells() + static_cast<LocalId>(old_.border_face.size());
  for (int place = 0; place < n_places; ++place) {
    const int member = before.face_to_child[at(face)][at(place)];
    if (member < 0) continue;
    const auto slot = before.face_to_slot[at(face)][at(place)];
    lowest = std::min(lowest, old_.cell_to_cell[at(parent.first_member + member)][at(slot)]);
  }
  return lowest - old_.n_cells();
}

/// Links the part `place` of a face, or all of it, to what is behind the old face `behind`. True when that is all of
/// the parent's face already.
bool FamilyLinker::link_region(const Parent& parent, int face, int place, mesh::CellFace behind) {
  const auto next = old_.cell_to_cell[at(behind.cell)][at(behind.slot)];
  if (next < 0) {
    for_each_part(parent, face, place, [&](mesh::CellFace part, Name, Name) { set(part, next); });
    return false;
  }
  if (old_.is_ghost(next)) {
    const auto old_face = place == all_places ? lowest_border_face(parent, face) : next - old_.n_cells();
    for_each_part(parent, face, place, [&](mesh::CellFace part, Name, Name) { border_.push_back({part, old_face}); });
    return false;
  }
  const int there = mesh::slot_of(old_.cell_to_cell[at(next)], behind.cell);
  if (closure_.action[at(next)] != Action::split) return link_to_family(parent, face, place, next, there);

  const auto& pattern = split_pattern[children_.state[at(next)]];
  const auto& child_there = pattern.face_to_child[at(there)];
  const auto& slot_there = pattern.face_to_slot[at(there)];
  const auto start_there = numbering_.first_child[at(next)];
  const auto& corner_there = old_.cell_to_node[at(next)];
  if (Quarters mine; place == all_places && find_quarters(parent, face, mine)) {
    for (int i = 0; i < 3; ++i) {
      const int twin = mesh::slot_of(corner_there, mine.name[at(i)]);
      set_both(mine.part[at(i)], {start_there + child_there[at(twin)], slot_there[at(twin)]});
    }
    set_both(mine.part[3], {start_there + child_there[center], slot_there[center]});
    return false;
  }
  for_each_part(parent, face, place, [&](mesh::CellFace part, Name name, Name) {
    const int twin = child_there[whole] >= 0 ? whole : name == name_center ? center : mesh::slot_of(corner_there, name);
    set_both(part, {start_there + child_there[at(twin)], slot_there[at(twin)]});
  });
  return false;
}

/// The other side was taken back as well. Where both parents show the same number of marks, they have the whole face in
/// common; otherwise a face of the one is a quarter of a face of the other.
bool FamilyLinker::link_to_family(const Parent& parent, int face, int place, LocalId next, int face_there) {
  const auto lineage = old_.lineage[at(next)];
  const auto first = next - lineage.child();
  const int before = lineage.state();
  const int link = split_pattern[at(before)].child_to_child[at(lineage.child())][at(face_there)];
  const bool is_common = marks_on(parent.before, face) == marks_on(before, outer_face(link));
  if (first > parent.first_member) return is_common;  // which links both
  const auto other = gather(family_of(first));
  if (Quarters mine, theirs;
      is_common && find_quarters(parent, face, mine) && find_quarters(other, outer_face(link), theirs)) {
    for (int i = 0; i < 3; ++i) {
      const int twin = (theirs.name[1] == mine.name[at(i)] ? 1 : 0) + (theirs.name[2] == mine.name[at(i)] ? 2 : 0);
      set_both(mine.part[at(i)], theirs.part[at(twin)]);
    }
    set_both(mine.part[3], theirs.part[3]);
    return is_common;
  }
  const int place_there = is_common || outer_place(link) == whole ? all_places : outer_place(link);
  for_each_part(parent, face, is_common ? all_places : place, [&](mesh::CellFace part, Name first_name, Name second) {
    set_both(part, find(other, outer_face(link), place_there, first_name, second));
  });
  return is_common;
}

/// The parts of a face in four, none of them split once more, as most are. False: the face is not of that kind.
bool FamilyLinker::find_quarters(const Parent& parent, int face, Quarters& quarters) const {
  const auto& pattern = split_pattern[at(parent.now)];
  if (pattern.face_to_child[at(face)][center] < 0) return false;
  int all = 0;
  for (int i = 0; i < 4; ++i) {
    const int place = i < 3 ? mesh::tet::face_to_corner[at(face)][at(i)] : center;
    const int c = pattern.face_to_child[at(face)][at(place)], slot = pattern.face_to_slot[at(face)][at(place)];
    const int part = parent.child[at(c)]->face_to_child[at(slot)][whole];
    quarters.part[at(i)] = {parent.start[at(c)] + part, parent.child[at(c)]->face_to_slot[at(slot)][whole]};
    if (i < 3) quarters.name[at(i)] = parent.node[at(place)];
    all |= part;
  }
  return all >= 0;
}

/// The part of a face that bears these names: of the face when `place` is `all_places`, then of the child's face there;
/// otherwise of the child's face at `place`.
mesh::CellFace FamilyLinker::find(const Parent& parent, int face, int place, Name first, Name second) const {
  const auto& pattern = split_pattern[at(parent.now)];
  const auto& faces = pattern.face_to_child[at(face)];
  if (place == all_places) {
    place = whole;
    if (faces[whole] < 0) {
      place = center;
      for (int corner = 0; corner < 4; ++corner)
        if (parent.node[at(corner)] == first) place = corner;
    }
    first = second;
  }
  const int c = faces[at(place)];
  const int slot = pattern.face_to_slot[at(face)][at(place)];
  const auto& child = *parent.child[at(c)];
  int part = whole;
  if (child.face_to_child[at(slot)][whole] < 0) {
    part = center;
    for (int corner = 0; corner < 4; ++corner)
      if (parent.node[at(pattern.child_to_node[at(c)][at(corner)])] == first) part = corner;
  }
  return {parent.start[at(c)] + child.face_to_child[at(slot)][at(part)], child.face_to_slot[at(slot)][at(part)]};
}

/// Visits the new faces in a part of a parent's face, or in all of it: `visit(face, first, second)`, the names of the
/// part: of the face and of the child's face when `place` is `all_places`; otherwise of the child's face.
template <class Visit>
void FamilyLinker::for_each_part(const Parent& parent, int face, int place, Visit&& visit) const {
  const auto& pattern = split_pattern[at(parent.now)];
  const auto& faces = pattern.face_to_child[at(face)];
  const int begin = place == all_places ? 0 : place, end = place == all_places ? n_places : place + 1;
  for (int p = begin; p < end; ++p) {
    const int c = faces[at(p)];
    if (c < 0) continue;
    const int slot = pattern.face_to_slot[at(face)][at(p)];
    const auto& child = *parent.child[at(c)];
    const auto& child_at = child.face_to_child[at(slot)];
    const auto& slot_at = child.face_to_slot[at(slot)];
    const Name outer = p < 4 ? parent.node[at(p)] : p == center ? name_center : name_whole;
    const auto visit_part = [&](int q, Name inner) {
      const mesh::CellFace part{parent.start[at(c)] + child_at[at(q)], slot_at[at(q)]};
      if (place == all_places)
        visit(part, outer, inner);
      else
        visit(part, inner, name_whole);
    };
    if (child_at[whole] >= 0) {
      visit_part(whole, name_whole);
      continue;
    }
    for (int corner = 0; corner < 4; ++corner)
      if (child_at[at(corner)] >= 0) visit_part(corner, parent.node[at(pattern.child_to_node[at(c)][at(corner)])]);
    if (child_at[center] >= 0) visit_part(center, name_center);
  }
}

}  // namespace pamr::refine
