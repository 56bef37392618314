// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "pamr/refine/options.hpp"
#include "support/reference_family.hpp"
#include "support/reference_level0.hpp"

/// The marking part of `reference_refine`: every rule of docs/closure.md applied to every cell, again and again,
/// until nothing changes.
namespace pamr::test {

struct ReferenceClosing {
  std::set<Edge> marked;  ///< existing edges that get a node
  Middles middle;         ///< their nodes, and those of the families that are taken back
  /// Old nodes, then new ones in no particular order: where the map of level 0 puts them, else in the middle.
  Points point;
  Points gone_back;  ///< the same with new nodes in the middle of their edges, where others can make them go back to
  std::map<GlobalId, ReferenceFamily> family;  ///< those that are taken back, by first member
  /// What becomes of cells and of families that are taken back, by (first) cell; of cells with six marks it is decided
  /// when nodes lie on their surfaces, and nothing is here.
  std::map<GlobalId, std::vector<Piece>> children;
  std::set<GlobalId> inverted;     ///< families whose parent cannot be rebuilt without an inverted cell
  std::int64_t families_kept = 0;  ///< those of them that have marks
  /// Parents that become eight, of whose children one has marks that the floor enlarges: to be split first.
  std::set<CornerSet> early;
};

/// What is asked of a closing.
struct ReferenceRequest {
  std::vector<std::uint8_t> flags;  ///< of each cell: it is to be split
  std::set<CornerSet> assess;       ///< parents of families to which the floor applies although no mark is new
};

/// `cell`: all cells with patches, lineage and rows; `point`: all nodes. Only for the policy `removable`.
ReferenceClosing close_removable(const std::vector<Piece>& cell, const Points& point, const ReferenceLevel0& level0,
                                 const ReferenceRequest& request, double shape_floor);

/// The other policies: no family is taken back, and only the templates 1:2, 1:4 and 1:8 are used. New nodes lie in the
/// middle.
ReferenceClosing close_by_templates(const std::vector<Piece>& cell, const Points& point,
                                    const std::vector<std::uint8_t>& flags, refine::QualityControl policy);

}  // namespace pamr::test
