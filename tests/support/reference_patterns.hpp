// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "support/edge_set.hpp"

/// Every way to split a cell, found by search: nothing of the library's tables is used but the numbering of edges.
namespace pamr::test {

/// A node of a split cell by code: 0..3 the corners, 4 + e the midpoint of edge e.
using Code = int;

/// Volume of a cell between nodes of a split cell, in eighths of the split cell's: exact.
std::int64_t eighths_of_volume(const std::array<Code, 4>& cell);

/// Of each face with two marks: the edge from whose midpoint it is cut.
using Cuts = std::map<int, int>;

/// Triangulation of a cell by its corners and the midpoints of its marked edges, conforming and without other nodes. A
/// face with three marks is cut as 1:8 cuts it.
struct ReferencePattern {
  EdgeSet marks;  ///< edges
  Cuts cut;
  int inner_edge = -1;                     ///< 0..2: an edge joins the midpoints of this edge and its opposite one
  std::vector<std::array<Code, 4>> child;  ///< positive: codes ascending but for the last two where needed; ascending
};

/// All 275, by search: marks ascending as sets of bits, then cuts (of face 0 first, from the edge of smaller number
/// first), then inner edges.
const std::vector<ReferencePattern>& all_patterns();

/// The states of closure families: 0 none, 1 + e: 1:2 on edge e, 7 + f: 1:4 on face f, both with their children as
/// drawn in pamr/mesh/families.hpp; then the others with 1 to 5 marks in the order of `all_patterns`.
const std::vector<ReferencePattern>& family_patterns();
int state_of(const ReferencePattern& pattern);

/// Those of zero to five marks with the given cuts of its two-mark faces; none where three cuts run around a corner.
const std::vector<ReferencePattern>& patterns_of(EdgeSet marks, const Cuts& cut);

/// Whether it fills the cell: every child positive, volumes that add up, and every face of a child is that of one other
/// child, or part of a face of the cell cut as the marks and cuts say. By whole numbers, exactly.
bool is_conforming(const ReferencePattern& pattern);

}  // namespace pamr::test
