// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/split_pattern.hpp"

/// Taking splits back. The eight cells of a regular split (some of them, maybe, replaced by closure families) are an
/// *octet*; together they can be their parent again.
namespace pamr::coarsen {

/// Flag of a cell that may be coarsened: it may become a part of its parent again.
inline constexpr std::int8_t may_go = -1;

/// Cells that are coarsened together: an octet, or a closure family, and what takes their place.
struct Group {
  LocalId first = invalid_local;   ///< its first cell; the others follow it
  LocalId end = invalid_local;     ///< behind the last one
  refine::SplitState before = 0;   ///< how the parent was split: 1:8, or the state of the family
  refine::SplitState now = 0;      ///< how it is split from now on; 0: the parent is a cell again
  std::array<LocalId, 10> node{};  ///< by code; `invalid_local` where there is none

  bool is_octet() const { return refine::is_regular_split(before); }
  refine::EdgeMask mask_before() const { return refine::split_pattern[before].mask; }
};

/// The lineage of a group's parent.
mesh::Lineage parent_lineage(const mesh::DistMesh& mesh, const Group& group);

/// First cell behind the base cell that begins with `first`: the cell itself, or its whole family.
inline LocalId end_of_base_cell(const mesh::DistMesh& mesh, LocalId first) {
  const auto lineage = mesh.lineage[at(first)];
  return first + (lineage.is_removable() ? lineage.family_size() : 1);
}

/// True if all cells of a base cell may be coarsened.
bool base_cell_may_go(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, LocalId first);

/// The family that begins with `first`, as a group that is left as it is. Local.
Group family_group(const mesh::DistMesh& mesh, LocalId first);

/// What was asked for, counts of this rank.
struct Asked {
  std::int64_t n_flagged = 0;         ///< cells with the flag `may_go`
  std::int64_t n_without_parent = 0;  ///< of them, those that know no parent: level 0, broken families, old files
  std::int64_t n_in_octets = 0;       ///< of them, those in octets whose cells all may be coarsened
};

struct Candidates {
  std::vector<Group> octets;  ///< all of whose cells may be coarsened, ascending
  Asked asked;
};

/// The octets of this rank all of whose cells may be coarsened. Octets lie in consecutive numbers; those that lie on
/// several ranks are not found (`gather_siblings.hpp`). Numbers and lineage find them, nodes prove them: cells that
/// were put in another order may look like siblings. Local. Cost: one pass over the cells.
Candidates find_octets(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags);

/// Calls `visit(cell, slot, face)` for each face of a group's cells that is part of face `face` of the parent.
template <class Visit>
void for_each_outer_face(const mesh::DistMesh& mesh, const Group& group, Visit&& visit) {
  const auto& whole = refine::split_pattern[group.before];
  const auto visit_pattern = [&](LocalId first, const refine::SplitPattern& pattern, const auto& face_of) {
    for (int child = 0; child < pattern.n_children; ++child)
      for (int slot = 0; slot < 4; ++slot)
        if (const int code = pattern.child_to_child[at(child)][at(slot)]; code < 0)
          if (const int face = face_of(refine::outer_face(code)); face >= 0) visit(first + child, slot, face);
  };
  if (!group.is_octet()) return visit_pattern(group.first, whole, [](int face) { return face; });
  auto first = group.first;
  for (int child = 0; child < whole.n_children; ++child) {
    const auto& pattern = refine::split_pattern[at(mesh.lineage[at(first)].state())];
    visit_pattern(first, pattern, [&](int face) {
      const int code = whole.child_to_child[at(child)][at(face)];
      return code < 0 ? refine::outer_face(code) : -1;
    });
    first += pattern.n_children;
  }
}

}  // namespace pamr::coarsen
