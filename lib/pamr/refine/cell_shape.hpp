// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bitset>
#include <optional>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/refine/child_shapes.hpp"
#include "pamr/refine/mapped_points.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// Cuts of faces with two marks that are there already: they stay while their face has the same two marks.
struct OldCuts {
  EdgeMask mask = 0;  ///< marks that the cell has had
  unsigned cuts = 0;  ///< bits as in `mesh::ClosureState`
};

/// Mean ratios are compared by their third powers, which need no roots; two are equal within a factor 1 - 2^-40.
constexpr double cubed(double mean_ratio) { return mean_ratio * mean_ratio * mean_ratio; }
inline constexpr double equal_cubes = 1 - 3 * 0x1p-40;

/// How well a cell can be split. With straight edges that follows from its six squared edges alone, because the squared
/// distances of its corners and midpoints are sums of them; with middles where a map of level 0 puts them from all ten
/// points. Depends on neither ranks nor, but for rounding, the order of the corners. Local. Cost: some twenty operations
/// for each shape that children may have, several at a time; some fifty with mapped middles.
class CellShape {
 public:
  explicit CellShape(const geometry::TetPoints& corner, OldCuts old = {});
  /// Of a base cell with its middles where new nodes would lie; the view has to live as long.
  CellShape(const mesh::Level0View& level0, const BaseCorners& corners, OldCuts old = {});

  double volume() const { return volume_; }
  /// Third power of the smallest mean ratio of the children of a closure state.
  double of_state(int state) const;
  /// The same of 1:8 with the diagonal that `choose_diagonal` takes.
  double of_regular_split() const;
  /// The same of the best state with these marks and their cuts; below all others when there is none. Pre: one to five
  /// marks.
  double of_marks(EdgeMask marks) const;

  /// Cuts of the faces that have two of these marks: the old one, or from the longer edge.
  unsigned cuts(EdgeMask marks) const;
  /// The better of the at most two states with these marks and their cuts; of equal ones that without inner edge, then
  /// the one whose inner edge is first by coordinates. 0: there is none. Pre: one to five marks.
  int best_state(EdgeMask marks) const;
  /// The smallest set that holds these marks and with each of its subsets one that reaches `floor`, a mean ratio, or
  /// what 1:8 reaches: rule 4 of docs/closure.md. Cells that are not positive have no such rule.
  EdgeMask closed_marks(EdgeMask marks, double floor) const;

 private:
  void measure(EdgeMask edges) const;
  bool state_reaches(int state, double limit) const;
  bool marks_reach(EdgeMask marks, double limit) const;
  bool is_longer(int edge, int other) const;
  void compare_lengths(unsigned pairs) const;
  std::uint64_t doubtful_subsets(EdgeMask marks, double limit) const;
  bool is_before(int edge, int other) const;
  EdgeMask smallest_good(EdgeMask marks, double limit) const;
  bool adds_earlier_edges(unsigned added, unsigned other) const;

  geometry::Vec3 middle(int edge) const;

  geometry::TetPoints corner_;
  /// Of bent cells: the points, and what is known of them. Arrays are left as they are until known.
  struct Bent {
    Bent(const mesh::Level0View& level0, const BaseCorners& corners) : points(level0, corners) {}
    double of_child(int shape) { return is_known[at(shape)] ? cubed_ratio[at(shape)] : measure_child(shape); }
    double measure_child(int shape);
    void measure(unsigned codes);

    MappedPoints points;
    unsigned measured = 0;            ///< bits: codes of the points between which distances are known
    std::array<double, 100> squared;  ///< distances by the codes of two points, at ten times the larger one
    std::bitset<max_child_shapes> is_known;
    std::array<double, max_child_shapes> cubed_ratio;  ///< of children by their shapes in the table
  };
  mutable std::optional<Bent> bent_;
  std::array<double, 6> squared_{};
  bool has_old_cuts_ = false;
  /// Bit 4 p + f: of pair p of the edges of face f the one of the larger number is longer, or an old cut says so.
  mutable unsigned longer_ = 0;
  mutable unsigned known_ = 0;  ///< the bits of `longer_` that are known already
  double volume_ = 0;
  double scale_ = 0;
  mutable unsigned measured_ = 0;                       ///< bits: edges of a straight cell
  mutable std::array<double, max_child_shapes> ratio_;  ///< cubed, of the shapes that are measured
};

/// The state with these marks where there is but one, whatever the shape of the cell; else 0. Pre: one to five marks.
int only_state(EdgeMask marks);

/// True when the inner edge of the first of two ways to split comes first by coordinates, from the ends of both.
bool is_earlier_edge(std::array<geometry::Vec3, 2> a, std::array<geometry::Vec3, 2> b);

}  // namespace pamr::refine
