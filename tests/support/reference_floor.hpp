// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <optional>

#include "support/reference_family.hpp"

/// The shape floor of `reference_refine`: how good a set of marks can be closed, and which sets it implies.
namespace pamr::test {

/// The middles of a cell's edges.
using MiddlePoints = std::array<geometry::Vec3, 6>;

/// A base cell as the rules see it: its corners, the middles of its edges, and the marks and cuts that its family has,
/// if it is the parent of one.
class ReferenceFloor {
 public:
  /// `floor`: the smallest mean ratio that is good enough, 0: none. `family`: null for a cell that is no parent.
  /// `middle`: where the map of level 0 puts the middles; not given: its edges are straight.
  ReferenceFloor(const geometry::TetPoints& corner, double floor, const ReferenceFamily* family,
                 const std::optional<MiddlePoints>& middle = {});

  /// The smallest set that holds the marks and, for each of its subsets M, all of P(M). The marks themselves where the
  /// cell is not positive.
  EdgeSet enlarge(EdgeSet marks);

  /// How the faces with two marks are cut: as now where they have the same two, else from the midpoint of the longer
  /// edge.
  Cuts cuts_of(EdgeSet marks) const;

 private:
  double mean_ratio_of(const std::array<Code, 4>& codes) const;
  double quality(EdgeSet marks);
  double quality_of_eight() const;
  bool is_good(EdgeSet marks);
  EdgeSet implied(EdgeSet marks);
  bool added_comes_first(EdgeSet a, EdgeSet b, EdgeSet marks) const;

  geometry::TetPoints corner_;
  std::optional<MiddlePoints> middle_;
  double floor_;
  EdgeSet family_marks_;
  Cuts family_cuts_;
  std::map<EdgeSet, double> quality_;    // known ones; -2 where there is no triangulation
  std::map<EdgeSet, EdgeSet> implied_;   // known ones
  std::map<EdgeSet, EdgeSet> enlarged_;  // known ones
};

/// Edge `e` of the cell is longer than `f`, or as long to 40 binary digits and first by coordinates.
bool is_longer(const geometry::TetPoints& corner, int e, int f);

/// The best triangulation of a cell whose split edges have a middle, with the given cuts: the largest smallest mean
/// ratio; of equal ones that without inner edge, else the one whose inner edge comes first by coordinates. Shapes are
/// those between straight edges; of a cell that descends from a bent one those where the nodes lie.
/// `gone_back`: if given, of those whose cells are all positive by exact arithmetic at these points as well, and with
/// shapes where the nodes lie; there may be none.
std::optional<ReferencePattern> best_pattern(const Piece& piece, const Middles& middle, const Cuts& cut,
                                             const Points& point, const Points* gone_back);

}  // namespace pamr::test
