// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/uniform_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh {

namespace {

/// A shape: squared lengths of the six edges, opposite ones e and 5 - e. All shapes of one cell are held at the same
/// volume, so the sum tells which is worse.
using Squares = std::array<double, 6>;

constexpr double tied = 0x1p-42;  ///< part of the shortest within which refinement sees two diagonals as equal
constexpr double in_doubt =
    0x1p-30;  ///< parts of the sum of squares within which rounding may decide, and shapes count as equal
constexpr std::size_t max_shapes = 4096;  ///< beyond, which needs a very flat cell, the bound of `reach` is taken

/// The edges, such that edge `d` comes first and its opposite one last, of the tetrahedron with its corners renamed.
constexpr std::array<std::array<std::size_t, 6>, 3> make_turns() {
  constexpr std::array<std::array<std::size_t, 4>, 3> corner{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};
  std::array<std::array<std::size_t, 6>, 3> turn{};
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = tet::edge_to_corner[e];
      turn[d][e] = at(tet::edge_of[corner[d][at(a)]][corner[d][at(b)]]);
    }
  return turn;
}
constexpr auto turns = make_turns();

/// The ways in which the corners can be renamed, as permutations of the edges.
constexpr std::array<std::array<std::size_t, 6>, 24> make_renamings() {
  std::array<std::array<std::size_t, 6>, 24> renaming{};
  std::array<std::size_t, 4> corner{0, 1, 2, 3};
  for (auto& edges : renaming) {
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = tet::edge_to_corner[e];
      edges[e] = at(tet::edge_of[corner[at(a)]][corner[at(b)]]);
    }
    std::next_permutation(corner.begin(), corner.end());
  }
  return renaming;
}
constexpr auto renamings = make_renamings();

double sum(const Squares& s) { return ((s[0] + s[5]) + (s[1] + s[4])) + (s[2] + s[3]); }

/// Four times the squared lengths of the inner diagonals: by the law of the parallelogram, what the four edges that a
/// diagonal does not join have more than the two that it does.
std::array<double, 3> diagonals(const Squares& s) {
  const double a = s[0] + s[5], b = s[1] + s[4], c = s[2] + s[3];
  return {b + c - a, a + c - b, a + b - c};
}

/// Twice the size of an inner cell at diagonal d of that length. It has the diagonal, an edge half as long as edge d or
/// as the one opposite (`far`), and halves of the other four.
Squares inner_cell(const Squares& s, std::size_t d, double diagonal, bool far) {
  const auto& e = turns[d];
  if (far) return {diagonal, s[e[3]], s[e[4]], s[e[2]], s[e[1]], s[e[5]]};
  return {diagonal, s[e[3]], s[e[1]], s[e[2]], s[e[4]], s[e[0]]};
}

/// The diagonals that refinement may choose.
std::array<bool, 3> possible_diagonals(const Squares& s, const std::array<double, 3>& length, double total) {
  const double shortest = std::min({length[0], length[1], length[2]});
  std::array<bool, 3> near{}, equal{};
  for (std::size_t d = 0; d < 3; ++d) {
    near[d] = length[d] <= shortest + in_doubt * total;
    equal[d] = length[d] <= shortest + tied * shortest;
  }
  if (near != equal) return near;
  // of equal ones, that with the better worst cell: the one whose shorter edge, which that cell lacks, is longer
  const auto gain = [&s](std::size_t d) { return std::min(s[d], s[5 - d]); };
  double best = 0;
  for (std::size_t d = 0; d < 3; ++d)
    if (near[d]) best = std::max(best, gain(d));
  for (std::size_t d = 0; d < 3; ++d) near[d] = near[d] && gain(d) >= best - in_doubt * total;
  return near;
}

/// No inner descendant of a shape has a larger sum of squares than this.
///
/// Take cells at the size of their root, so that all volumes are equal. Then all edges are vectors of the lattice of
/// the root's edges a, b, c, and the six edges of a cell lie in six of its seven classes modulo 2: those of a, b, c, b
/// - a, c - b, a - c. The three diagonals, b + c - a and the like, lie in the seventh. An inner cell takes one of them
/// and drops an edge x; and x is a diagonal of that inner cell. So if the shortest diagonal is taken every time, a
/// class never gets a longer vector than it had, and a cell's squares and its shortest diagonal's together never grow.
/// They are at most 4/3 of the squares: the three diagonals' add up to them.
double reach(const Squares& s) {
  const auto length = diagonals(s);
  return sum(s) + std::min({length[0], length[1], length[2]});
}

bool is_close(const Squares& a, const Squares& b, double margin) {
  return std::any_of(renamings.begin(), renamings.end(), [&](const auto& edge) {
    for (std::size_t e = 0; e < 6; ++e)
      if (!(std::abs(a[e] - b[edge[e]]) <= margin)) return false;
    return true;
  });
}

/// Follows the shapes of one cell after another.
class Follower {
 public:
  /// The largest sum of squares among the shapes of a cell.
  double largest_sum(const Squares& root) {
    shapes_.clear();
    sums_.clear();
    largest_ = 0;
    margin_ = in_doubt * sum(root);
    add(root);
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const auto shape = shapes_[i];
      const auto length = diagonals(shape);
      const auto is_possible = possible_diagonals(shape, length, sums_[i]);
      for (std::size_t d = 0; d < 3; ++d)
        if (is_possible[d])
          for (const bool far : {false, true}) add(inner_cell(shape, d, length[d], far));
      if (shapes_.size() > max_shapes) return reach(root);
    }
    return largest_;
  }

 private:
  void add(const Squares& shape) {
    const double total = sum(shape);
    largest_ = std::max(largest_, total);
    if (reach(shape) <= largest_) return;
    for (std::size_t i = 0; i < shapes_.size(); ++i)
      if (std::abs(sums_[i] - total) <= margin_ && is_close(shapes_[i], shape, margin_)) return;
    shapes_.push_back(shape);
    sums_.push_back(total);
  }

  std::vector<Squares> shapes_;  ///< from which larger sums may come
  std::vector<double> sums_;
  double largest_ = 0, margin_ = 0;
};

Squares squares_of(const geometry::TetPoints& corner) {
  Squares s{};
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = tet::edge_to_corner[e];
    s[e] = geometry::squared_norm(corner[at(a)] - corner[at(b)]);
  }
  return s;
}

}  // namespace

double worst_uniform_shape(const geometry::TetPoints& corner, double known) {
  const double volume = geometry::volume(corner);
  const auto s = squares_of(corner);
  const double farthest = reach(s);
  if (!(volume > 0) || !std::isfinite(volume) || !std::isfinite(farthest)) return std::min(known, 0.0);
  const double part = known * farthest / 12;  // to compare cubes
  if (9 * volume * volume > (1 + 1e-9) * part * part * part) return known;
  const double root = std::cbrt(3 * volume);
  return std::min(known, 12 * root * root / Follower().largest_sum(s));
}

}  // namespace pamr::mesh
