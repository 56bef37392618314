// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "pamr/refine/options.hpp"
#include "support/reference_split.hpp"

/// The marking part of `reference_refine`: every rule of docs/refinement.md applied to every cell, again and again,
/// until nothing changes.
namespace pamr::test {

/// A closure family read from its members: which corners they share tells the parent.
struct ReferenceFamily {
  GlobalId first = 0;
  std::vector<Piece> member;
  Piece parent;
  Middles middle;  ///< of the parent's split edges

  bool is_hit(const std::set<Edge>& marked) const;
};

/// Throws `std::logic_error` when the cells do not form a family.
ReferenceFamily read_family(GlobalId first, const std::vector<Piece>& member);

struct ReferenceClosing {
  std::set<Edge> marked;                            ///< existing edges that get a node
  Middles middle;                                   ///< their nodes, and those of the families that are taken back
  Points point;                                     ///< old nodes, then new ones in no particular order
  std::map<GlobalId, ReferenceFamily> family;       ///< those that are taken back, by first member
  std::map<GlobalId, std::vector<Piece>> children;  ///< of their parents
  std::int64_t families_kept = 0;                   ///< hit, but their parent cannot be rebuilt
};

/// `cell`: all cells with patches and lineage; `point`: all nodes. Throws `std::logic_error` where a rule would mark an
/// edge that does not exist yet: docs/refinement.md says that none does.
ReferenceClosing reference_close(const std::vector<Piece>& cell, const Points& point,
                                 const std::vector<std::uint8_t>& flags, refine::QualityControl policy);

}  // namespace pamr::test
