// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/cell_shape.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;
using mesh::tet::edge_to_corner;

/// The pairs of edges of each face, in each pair the one of the smaller number first.
constexpr auto make_pairs_of_faces() {
  std::array<std::array<std::array<int, 2>, 3>, 4> pairs{};
  for (int f = 0; f < 4; ++f) {
    std::size_t n = 0;
    for (int e = 0; e < 6; ++e)
      for (int g = e + 1; g < 6; ++g)
        if ((mesh::tet::face_edge_mask[at(f)] >> e & mesh::tet::face_edge_mask[at(f)] >> g & 1) != 0)
          pairs[at(f)][n++] = {e, g};
  }
  return pairs;
}
constexpr auto pair_of_face = make_pairs_of_faces();

/// `marked_pairs[mask]`: bit 4 p + f for pair p of face f, where just its two edges are marked.
constexpr auto make_marked_pairs() {
  std::array<unsigned, 64> pairs{};
  for (unsigned mask = 0; mask < 64; ++mask)
    for (int f = 0; f < 4; ++f)
      for (int pair = 0; pair < 3; ++pair) {
        const auto [e, g] = pair_of_face[at(f)][at(pair)];
        if ((mask & mesh::tet::face_edge_mask[at(f)]) == (1U << e | 1U << g)) pairs[mask] |= 1U << (4 * pair + f);
      }
  return pairs;
}
constexpr auto marked_pairs = make_marked_pairs();

/// Bit m for each set m: all subsets of a set; all sets with two marks on a face.
constexpr auto make_subsets() {
  std::array<std::uint64_t, 64> subsets{};
  for (unsigned set = 0; set < 64; ++set)
    for (unsigned subset = set; subset != 0; subset = (subset - 1) & set) subsets[set] |= std::uint64_t{1} << subset;
  return subsets;
}
constexpr auto subsets_of = make_subsets();

constexpr std::uint64_t make_sets_with_cuts() {
  std::uint64_t sets = 0;
  for (std::size_t mask = 0; mask < 64; ++mask) sets |= std::uint64_t{marked_pairs[mask] != 0} << mask;
  return sets;
}
constexpr std::uint64_t sets_with_cuts = make_sets_with_cuts();

/// All sets with some number of edges, and all that hold some set.
constexpr auto make_sets_of_size() {
  std::array<std::uint64_t, 7> sets{};
  for (unsigned set = 0; set < 64; ++set) sets[at(std::popcount(set))] |= std::uint64_t{1} << set;
  return sets;
}
constexpr auto sets_of_size = make_sets_of_size();

constexpr auto make_supersets() {
  std::array<std::uint64_t, 64> supersets{};
  for (unsigned set = 0; set < 64; ++set)
    for (unsigned superset = set; superset < 64; ++superset)
      if ((superset & set) == set) supersets[set] |= std::uint64_t{1} << superset;
  return supersets;
}
constexpr auto supersets_of = make_supersets();

/// To 40 significant binary digits, halves up.
double rounded(double length) {
  constexpr std::uint64_t unit = std::uint64_t{1} << 13U;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(length) + unit / 2) & ~(unit - 1));
}

constexpr double none = std::numeric_limits<double>::lowest();  ///< no limit
constexpr unsigned face_bits = 0x111;                           ///< of the three pairs of face 0

std::array<geometry::Vec3, 2> in_order(std::array<geometry::Vec3, 2> ends) {
  if (geometry::lexicographically_less(ends[1], ends[0])) std::swap(ends[0], ends[1]);
  return ends;
}

}  // namespace

bool is_earlier_edge(std::array<geometry::Vec3, 2> a, std::array<geometry::Vec3, 2> b) {
  const auto p = in_order(a), q = in_order(b);
  return p[0] == q[0] ? geometry::lexicographically_less(p[1], q[1]) : geometry::lexicographically_less(p[0], q[0]);
}

CellShape::CellShape(const geometry::TetPoints& corner, OldCuts old) : corner_(corner), has_old_cuts_(old.mask != 0) {
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = edge_to_corner[e];
    squared_[e] = geometry::squared_norm(corner[at(a)] - corner[at(b)]);
  }
  known_ = marked_pairs[old.mask];
  for (unsigned f = 0; f < 4; ++f)
    if ((old.cuts >> f & 1U) != 0) longer_ |= known_ & face_bits << f;
  volume_ = geometry::volume(corner);
  scale_ = cube_of_shape * volume_ * std::abs(volume_);
}

CellShape::CellShape(const mesh::Level0View& level0, const BaseCorners& corners, OldCuts old)
    : CellShape(corners.point, old) {
  if (corners.row < 0) return;
  if (!bent_.emplace(level0, corners).points.is_bent()) bent_.reset();
}

geometry::Vec3 CellShape::middle(int edge) const {
  if (bent_) return bent_->points.points(static_cast<EdgeMask>(1U << edge))[at(4 + edge)];
  return geometry::midpoint(corner_[at(edge_to_corner[at(edge)][0])], corner_[at(edge_to_corner[at(edge)][1])]);
}

/// Finds the points with these codes and all distances between them and those that were known.
void CellShape::Bent::measure(unsigned codes) {
  const auto& p = points.points(static_cast<EdgeMask>(codes >> 4U));
  for (unsigned rest = codes & ~measured; rest != 0; rest &= rest - 1) {
    const int code = std::countr_zero(rest);
    for (unsigned others = measured; others != 0; others &= others - 1) {
      const int other = std::countr_zero(others);
      squared[pair_of(code, other)] = geometry::squared_norm(p[at(code)] - p[at(other)]);
    }
    measured |= 1U << code;
  }
}

double CellShape::Bent::measure_child(int of_shape) {
  const auto& child = shape_table.shape[at(of_shape)];
  if ((child.codes & ~measured) != 0) measure(child.codes);
  const auto& p = points.points(0);
  const auto& nodes = child.nodes;
  const double volume = geometry::volume({p[at(nodes[0])], p[at(nodes[1])], p[at(nodes[2])], p[at(nodes[3])]});
  double squares = 0;
  for (const auto pair : child.pair) squares += squared[pair];
  is_known[at(of_shape)] = true;
  return cubed_ratio[at(of_shape)] = cube_of_shape * shape(volume, squares);
}

/// Measures all shapes with midpoints on these edges, where that is not done. Pre: straight edges.
void CellShape::measure(EdgeMask edges) const {
  if ((edges & ~measured_) == 0) return;
  measure_child_shapes(edges, squared_, scale_, none, ratio_);
  measured_ = edges;
}

double CellShape::of_state(int state) const {
  const auto& shape = shape_table.of_child[at(state)];
  if (bent_) {
    double worst = bent_->of_child(shape[0]);
    for (int child = 1; child < mesh::family_size_of_state[at(state)]; ++child)
      worst = std::min(worst, bent_->of_child(shape[at(child)]));
    return worst;
  }
  measure(mesh::closure_states[at(state)].mask);
  const auto ratio = [&](std::size_t child) { return ratio_[shape[child]]; };
  return std::min(std::min(std::min(ratio(0), ratio(1)), std::min(ratio(2), ratio(3))),
                  std::min(std::min(ratio(4), ratio(5)), std::min(ratio(6), ratio(7))));
}

/// `of_state(state) >= limit`; of bent cells no child is looked at after one that falls short.
bool CellShape::state_reaches(int state, double limit) const {
  if (!bent_) return of_state(state) >= limit;
  const auto& shape = shape_table.of_child[at(state)];
  return std::all_of(shape.begin(), shape.begin() + mesh::family_size_of_state[at(state)],
                     [&](int s) { return bent_->of_child(s) >= limit; });
}

double CellShape::of_regular_split() const {
  if (bent_) {
    const auto& points = bent_->points.points(all_edges);
    return cube_of_shape * worst_child_shape(points, regular_state + choose_diagonal(points, false));
  }
  double all = 0;
  for (const double square : squared_) all += square;
  std::array<double, 3> length{};  // four times the squares of the diagonals
  for (std::size_t d = 0; d < 3; ++d) length[d] = all - 2 * (squared_[d] + squared_[5 - d]);
  const double shortest = std::min({length[0], length[1], length[2]});
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t d = 0; d < 3; ++d) {
    if (length[d] > (1 + 0x1p-40) * shortest) continue;
    double worst = std::numeric_limits<double>::infinity();
    for (const auto shape : shape_table.of_inner[d]) worst = std::min(worst, cubed_ratio(shape, squared_, scale_));
    best = std::max(best, worst);
  }
  return std::min(best, scale_ / (all * all * all));  // the children at the corners have the cell's own shape
}

double CellShape::of_marks(EdgeMask marks) const {
  const auto& choice = states_of_marks[marks][cuts(marks)].state;
  if (choice[0] == 0) return -std::numeric_limits<double>::infinity();
  const double first = of_state(choice[0]);
  return choice[1] == 0 ? first : std::max(first, of_state(choice[1]));
}

bool CellShape::marks_reach(EdgeMask marks, double limit) const {
  const auto& choice = states_of_marks[marks][cuts(marks)].state;
  if (choice[0] == 0) return false;
  return state_reaches(choice[0], limit) || (choice[1] != 0 && state_reaches(choice[1], limit));
}

bool CellShape::is_before(int edge, int other) const {
  const auto ends = [this](int e) {
    return std::array{corner_[at(edge_to_corner[at(e)][0])], corner_[at(edge_to_corner[at(e)][1])]};
  };
  return is_earlier_edge(ends(edge), ends(other));
}

bool CellShape::is_longer(int edge, int other) const {
  const double mine = rounded(squared_[at(edge)]), theirs = rounded(squared_[at(other)]);
  return mine == theirs ? is_before(edge, other) : mine > theirs;
}

/// Compares the edges of these pairs, bits as in `marked_pairs`.
void CellShape::compare_lengths(unsigned pairs) const {
  known_ |= pairs;
  for (; pairs != 0; pairs &= pairs - 1) {
    const int bit = std::countr_zero(pairs);
    const auto [lower, higher] = pair_of_face[at(bit % 4)][at(bit / 4)];
    if (is_longer(higher, lower)) longer_ |= 1U << bit;
  }
}

unsigned CellShape::cuts(EdgeMask marks) const {
  const unsigned pairs = marked_pairs[marks];
  if ((pairs & ~known_) != 0) compare_lengths(pairs & ~known_);
  const unsigned higher = longer_ & pairs;
  return (higher | higher >> 4U | higher >> 8U) & 0xfU;
}

int only_state(EdgeMask marks) {
  const auto& choice = states_of_marks[marks][0].state;
  return marked_pairs[marks] != 0 || choice[1] != 0 ? 0 : choice[0];
}

int CellShape::best_state(EdgeMask marks) const {
  const auto& choice = states_of_marks[marks][cuts(marks)].state;
  if (choice[1] == 0) return choice[0];
  const double first = of_state(choice[0]), second = of_state(choice[1]);
  if (second < equal_cubes * first) return choice[0];
  if (first < equal_cubes * second) return choice[1];
  const int d = mesh::closure_states[choice[0]].inner_edge, g = mesh::closure_states[choice[1]].inner_edge;
  if (d < 0) return choice[0];
  return is_earlier_edge({middle(d), middle(5 - d)}, {middle(g), middle(5 - g)}) ? choice[0] : choice[1];
}

bool CellShape::adds_earlier_edges(unsigned added, unsigned other) const {
  if (std::has_single_bit(added)) return is_before(std::countr_zero(added), std::countr_zero(other));
  const auto in_order = [this](unsigned mask) {
    std::array<int, 6> edge{};
    std::size_t n = 0;
    for (; mask != 0; mask &= mask - 1) edge[n++] = std::countr_zero(mask);
    std::sort(edge.begin(), edge.begin() + static_cast<std::ptrdiff_t>(n),
              [this](int a, int b) { return is_before(a, b); });
    return edge;
  };
  const auto mine = in_order(added), theirs = in_order(other);
  for (std::size_t i = 0; i < mine.size(); ++i)
    if (mine[i] != theirs[i]) return is_before(mine[i], theirs[i]);
  return false;
}

/// The good set with the fewest edges that holds a set which is not good.
EdgeMask CellShape::smallest_good(EdgeMask marks, double limit) const {
  if (!bent_) measure(all_edges);
  for (int size = std::popcount(marks) + 1; size < 6; ++size) {
    std::array<double, 64> quality;
    double best = limit;
    const auto sets = supersets_of[marks] & sets_of_size[at(size)];
    for (auto rest = sets; rest != 0; rest &= rest - 1) {
      const int set = std::countr_zero(rest);
      quality[at(set)] = of_marks(static_cast<EdgeMask>(set));
      best = std::max(best, quality[at(set)]);
    }
    EdgeMask found = 0;
    for (auto rest = sets; rest != 0; rest &= rest - 1) {
      const auto set = static_cast<EdgeMask>(std::countr_zero(rest));
      if (!(quality[set] >= limit) || quality[set] < equal_cubes * best) continue;
      if (found == 0 || adds_earlier_edges(set & ~marks, found & ~marks)) found = set;
    }
    if (found != 0) return found;
  }
  return all_edges;
}

/// Sets of marks, bit m for the set m, of which `marks_reach` has to be asked: the others reach the limit.
std::uint64_t CellShape::doubtful_subsets(EdgeMask marks, double limit) const {
  if (bent_) return subsets_of[marks];
  measured_ = std::popcount(marks) < 4 ? marks : all_edges;  // all are needed where something falls short
  const auto below = measure_child_shapes(static_cast<EdgeMask>(measured_), squared_, scale_, limit, ratio_);
  return (below | (has_old_cuts_ ? sets_with_cuts : 0)) & subsets_of[marks];  // old cuts can leave no way at all
}

EdgeMask CellShape::closed_marks(EdgeMask marks, double floor) const {
  const bool has_floor = volume_ > 0 && floor > 0;
  if (!has_floor && !has_old_cuts_) return marks;
  double limit = has_floor ? equal_cubes * cubed(floor) : none;
  bool is_reachable = !has_floor;  // what 1:8 reaches is asked for where something falls short of the floor
  auto set = marks;
  auto doubtful = doubtful_subsets(set, limit);
  for (std::uint64_t is_checked = 0; (doubtful & ~is_checked) != 0 && set != all_edges;) {
    const auto some = static_cast<EdgeMask>(std::countr_zero(doubtful & ~is_checked));
    is_checked |= std::uint64_t{1} << some;
    if (marks_reach(some, limit)) continue;
    if (!is_reachable) {
      is_reachable = true;
      const double reachable = of_regular_split();
      limit = reachable > 0 ? std::min(limit, equal_cubes * reachable) : none;
      if (marks_reach(some, limit)) continue;
    }
    const auto grown = static_cast<EdgeMask>(set | smallest_good(some, limit));
    if (grown != set) doubtful = doubtful_subsets(grown, limit);
    set = grown;
  }
  return set;
}

}  // namespace pamr::refine
