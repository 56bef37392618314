// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <vector>

#include "support/reference_split.hpp"

/// Closure families of `reference_refine`: what their parents were, and which have to stay.
namespace pamr::test {

/// A closure family read from its members.
struct ReferenceFamily {
  GlobalId first = 0;
  std::vector<Piece> member;
  ReferencePattern pattern;  ///< by which the parent was split
  Piece parent;
  Middles middle;  ///< of the parent's split edges

  bool is_hit(const std::set<Edge>& marked) const;
  /// A middle that does not lie where the straight edge has it.
  bool has_moved(const Points& point) const;
};

/// Throws `std::logic_error` when the cells do not share their nodes as a family does.
ReferenceFamily read_family(GlobalId first, const std::vector<Piece>& member);

/// All families that are whole, by first member.
std::map<GlobalId, ReferenceFamily> read_families(const std::vector<Piece>& cell);

/// The cells of a whole mesh.
std::vector<Piece> pieces_of(const mesh::BlockMesh& whole);

/// The nodes of a cell, whatever their order.
using CornerSet = std::set<GlobalId>;
inline CornerSet corners_of(const Piece& piece) { return {piece.corner.begin(), piece.corner.end()}; }

/// The base cell of each cell by its corners: the parent, if the cell belongs to a whole family.
std::vector<CornerSet> base_cells_of(const std::vector<Piece>& cell);

/// Families of which a part of a cut face (one or two marks) is the face of a cell too that is no member of a whole
/// family with that part: it needs the part, so the family cannot be taken back. And those that share a part with one.
std::set<GlobalId> families_to_keep(const std::vector<Piece>& cell,
                                    const std::map<GlobalId, ReferenceFamily>& families);

/// Adds the families that share a part of a cut face with one that is kept, until there are no more.
void spread(const std::map<GlobalId, ReferenceFamily>& families, std::set<GlobalId>& kept);

}  // namespace pamr::test
