// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/mesh/tet.hpp"
#include "support/reference_patterns.hpp"

/// Cells and their children by the names of their nodes: the splitting part of `reference_refine`. Nothing of the
/// library's tables is used but the numbering of a cell's edges and the layout of the lineage word.
namespace pamr::test {

/// Two nodes, the smaller number first.
using Edge = std::pair<GlobalId, GlobalId>;
inline Edge edge_between(GlobalId a, GlobalId b) { return a < b ? Edge{a, b} : Edge{b, a}; }

/// The node in the middle of each split edge.
using Middles = std::map<Edge, GlobalId>;
using Points = std::vector<geometry::Vec3>;

/// A cell with its corners in order, the patch of each face on the boundary (-1: not on it), its lineage and the row of
/// the bent level-0 cell that it descends from (-1: none).
struct Piece {
  std::array<GlobalId, 4> corner{};
  std::array<int, 4> patch{-1, -1, -1, -1};
  mesh::Lineage lineage;
  int row = -1;

  Edge edge(int number) const;
  std::array<GlobalId, 4> with(std::size_t slot, GlobalId node) const;
};

/// Its points.
geometry::TetPoints points_of(const std::array<GlobalId, 4>& corner, const Points& point);
inline geometry::TetPoints points_of(const Piece& piece, const Points& point) { return points_of(piece.corner, point); }

/// Nodes on the face opposite corner `face`: its corners and the middles of its split edges.
std::set<GlobalId> nodes_on_face(const Piece& piece, const Middles& middle, std::size_t face);

/// The numbers (0..5) of the cell's edges that are in a set or have a middle.
template <class Edges>
EdgeSet edges_within(const Piece& piece, const Edges& edges) {
  EdgeSet found;
  for (int e = 0; e < 6; ++e)
    if (edges.count(piece.edge(e)) != 0) found.insert(e);
  return found;
}

/// The edges of the face opposite corner `face`, and all edges.
EdgeSet edges_of_face(int face);
inline const EdgeSet all_six{0, 1, 2, 3, 4, 5};

/// The children of a cell by a pattern of 0 to 5 marks (without marks: the cell itself). Lineage and patches are those
/// of children.
std::vector<Piece> split_as(const Piece& parent, const Middles& middle, const ReferencePattern& pattern);

/// The eight children of a cell. `only_positive`: an inner diagonal that would invert a cell is taken only where all
/// three would.
std::vector<Piece> split_in_eight(const Piece& parent, const Middles& middle, const Points& point, bool only_positive);

/// The children by the templates 1:2, 1:4 and 1:8 alone: 1, 2, 4 or 8; a cell with another set of split edges throws
/// `std::logic_error`.
std::vector<Piece> split_by_templates(const Piece& parent, const Middles& middle, const Points& point,
                                      bool only_positive);

/// A cell alone: its corners are points 0 to 3, then come the middles of the given edges, where straight edges have
/// them.
struct LoneCell {
  Piece piece{{0, 1, 2, 3}, {-1, -1, -1, -1}, {}, -1};
  Points point;
  Middles middle;
};
LoneCell halve(const geometry::TetPoints& corner, EdgeSet edges);

double worst_mean_ratio(const std::vector<Piece>& pieces, const Points& point);

/// Two numbers within this factor are equal to rounding.
inline constexpr double rounding = 1 + 0x1p-40;

/// True when all are positive by exact arithmetic.
bool all_positive(const std::vector<Piece>& pieces, const Points& point);

}  // namespace pamr::test
