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
using Codes = std::array<std::int8_t, 4>;

/// A cell whose nodes are corners and midpoints of its parent: four times the sum of its squared edges is the sum of
/// the parent's squared edges with these factors; eight times its volume is `volume` times that of the parent.
struct ChildShape {
  std::array<double, 6> factor{};
  double squared_volume = 0;
  Codes nodes{};                       ///< oriented as the parent
  unsigned codes = 0;                  ///< bits of the nodes
  std::array<std::uint8_t, 6> pair{};  ///< the ends of its edges
};

constexpr unsigned codes_of(const Codes& nodes) {
  unsigned codes = 0;
  for (const auto code : nodes) codes |= 1U << code;
  return codes;
}

/// Where the distance of two points by code is among `Bent::squared`.
constexpr std::size_t pair_of(int a, int b) { return at(10 * std::max(a, b) + std::min(a, b)); }

/// Corners that a node lies at: twice its barycentric coordinates.
constexpr std::array<int, 4> barycentric(int code) {
  std::array<int, 4> b{};
  if (code < 4) {
    b[at(code)] = 2;
  } else {
    for (const int corner : edge_to_corner[at(code - 4)]) b[at(corner)] = 1;
  }
  return b;
}

constexpr int determinant(const Codes& nodes) {
  std::array<std::array<int, 3>, 3> d{};
  const auto o = barycentric(nodes[0]);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[at(i)][at(k)] = barycentric(nodes[at(i + 1)])[at(k + 1)] - o[at(k + 1)];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/// The squared length of a vector whose barycentric coordinates u add up to nothing is minus the sum of u_i u_j l_ij^2.
constexpr ChildShape make_shape(const Codes& nodes) {
  ChildShape shape;
  const int volume = determinant(nodes);
  shape.squared_volume = volume * volume;
  shape.nodes = volume > 0 ? nodes : Codes{nodes[0], nodes[1], nodes[3], nodes[2]};
  for (const auto [p, q] : edge_to_corner) {
    const auto a = barycentric(nodes[at(p)]), b = barycentric(nodes[at(q)]);
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = edge_to_corner[at(e)];
      shape.factor[at(e)] -= (a[at(i)] - b[at(i)]) * (a[at(j)] - b[at(j)]);
    }
  }
  shape.codes = codes_of(nodes);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [p, q] = edge_to_corner[e];
    shape.pair[e] = static_cast<std::uint8_t>(pair_of(shape.nodes[at(p)], shape.nodes[at(q)]));
  }
  return shape;
}

/// The shapes of all children, each once, and the shape of each child. Inner cells of 1:8: four for each diagonal.
struct ShapeTable {
  std::array<ChildShape, max_child_shapes> shape{};
  std::array<std::array<std::uint8_t, mesh::max_family_size>, mesh::closure_states.size()> of_child{};
  std::array<std::array<std::uint8_t, 4>, 3> of_inner{};
};

constexpr ShapeTable make_table() {
  ShapeTable table;
  std::array<std::uint8_t, 1024> known{};  // by the bits of the codes: shape + 1
  std::uint8_t n = 0;
  const auto add = [&](const Codes& nodes) {
    auto& entry = known[codes_of(nodes)];
    if (entry == 0) {
      table.shape[n] = make_shape(nodes);
      entry = ++n;
    }
    return static_cast<std::uint8_t>(entry - 1);
  };
  for (std::size_t s = 0; s < mesh::closure_states.size(); ++s)
    for (int c = 0; c < mesh::closure_states[s].family.n_children; ++c)
      table.of_child[s][at(c)] = add(mesh::closure_states[s].family.child_to_node[at(c)]);
  for (int d = 0; d < 3; ++d) {
    std::size_t inner = 0;
    for (int e = 0; e < 6; ++e)
      for (int g = e + 1; g < 6; ++g)
        if (e != d && g != d && e + d != 5 && g + d != 5 && e + g != 5)
          table.of_inner[at(d)][inner++] = add({static_cast<std::int8_t>(4 + d), static_cast<std::int8_t>(9 - d),
                                                static_cast<std::int8_t>(4 + e), static_cast<std::int8_t>(4 + g)});
  }
  return table;
}

constexpr ShapeTable table = make_table();

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

/// `marked_pair[mask][face]`: the pair of edges that is marked, where just two are; else -1.
constexpr auto make_marked_pairs() {
  std::array<std::array<std::int8_t, 4>, 64> faces{};
  for (unsigned mask = 0; mask < 64; ++mask)
    for (int f = 0; f < 4; ++f) {
      faces[mask][at(f)] = -1;
      for (int pair = 0; pair < 3; ++pair) {
        const auto [e, g] = pair_of_face[at(f)][at(pair)];
        if ((mask & mesh::tet::face_edge_mask[at(f)]) == (1U << e | 1U << g))
          faces[mask][at(f)] = static_cast<std::int8_t>(pair);
      }
    }
  return faces;
}
constexpr auto marked_pair = make_marked_pairs();

constexpr auto make_two_mark_faces() {
  std::array<bool, 64> faces{};
  for (std::size_t mask = 0; mask < 64; ++mask)
    for (const int pair : marked_pair[mask]) faces[mask] = faces[mask] || pair >= 0;
  return faces;
}
constexpr auto has_two_mark_face = make_two_mark_faces();

/// Four times the sum of a child's squared edges.
double sum_of_squares(const std::array<double, 6>& factor, const std::array<double, 6>& squared) {
  return (factor[0] * squared[0] + factor[1] * squared[1]) + (factor[2] * squared[2] + factor[3] * squared[3]) +
         (factor[4] * squared[4] + factor[5] * squared[5]);
}

/// Sets of one to four edges by the number of edges, and where those of each number begin.
struct SetsBySize {
  std::array<EdgeMask, 56> set{};
  std::array<std::size_t, 6> begin{};
};

constexpr SetsBySize make_sets_by_size() {
  SetsBySize sets;
  std::size_t n = 0;
  for (int size = 1; size <= 4; ++size) {
    sets.begin[at(size)] = n;
    for (unsigned set = 1; set < all_edges; ++set)
      if (std::popcount(set) == size) sets.set[n++] = static_cast<EdgeMask>(set);
  }
  sets.begin[5] = n;
  return sets;
}
constexpr SetsBySize sets_by_size = make_sets_by_size();

/// To 40 significant binary digits, halves up.
double rounded(double length) {
  constexpr std::uint64_t unit = std::uint64_t{1} << 13U;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(length) + unit / 2) & ~(unit - 1));
}

std::array<geometry::Vec3, 2> in_order(std::array<geometry::Vec3, 2> ends) {
  if (geometry::lexicographically_less(ends[1], ends[0])) std::swap(ends[0], ends[1]);
  return ends;
}

}  // namespace

bool is_earlier_edge(std::array<geometry::Vec3, 2> a, std::array<geometry::Vec3, 2> b) {
  const auto p = in_order(a), q = in_order(b);
  return p[0] == q[0] ? geometry::lexicographically_less(p[1], q[1]) : geometry::lexicographically_less(p[0], q[0]);
}

CellShape::CellShape(const geometry::TetPoints& corner, OldCuts old) : corner_(corner), old_(old) {
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = edge_to_corner[e];
    squared_[e] = geometry::squared_norm(corner[at(a)] - corner[at(b)]);
  }
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
  const auto& child = table.shape[at(of_shape)];
  if ((child.codes & ~measured) != 0) measure(child.codes);
  const auto& p = points.points(0);
  const auto& nodes = child.nodes;
  const double volume = geometry::volume({p[at(nodes[0])], p[at(nodes[1])], p[at(nodes[2])], p[at(nodes[3])]});
  double squares = 0;
  for (const auto pair : child.pair) squares += squared[pair];
  is_known[at(of_shape)] = true;
  return cubed_ratio[at(of_shape)] = cube_of_shape * shape(volume, squares);
}

double CellShape::of_child(int of_shape) const {
  if (bent_) return bent_->of_child(of_shape);
  const auto& of_table = table.shape[at(of_shape)];
  const double sum = sum_of_squares(of_table.factor, squared_);
  return scale_ * of_table.squared_volume / (sum * sum * sum);
}

/// `of_state(state) >= limit` for positive limits, without divisions.
bool CellShape::state_reaches(int state, double limit) const {
  const auto& shapes = table.of_child[at(state)];
  const int n = mesh::family_size_of_state[at(state)];
  if (bent_) return std::all_of(shapes.begin(), shapes.begin() + n, [&](int s) { return bent_->of_child(s) >= limit; });
  for (int child = 0; child < n; ++child) {
    const auto& of_table = table.shape[shapes[at(child)]];
    const double sum = sum_of_squares(of_table.factor, squared_);
    if (!(scale_ * of_table.squared_volume >= limit * (sum * sum * sum))) return false;
  }
  return true;
}

double CellShape::of_state(int state) const {
  const auto& shape = table.of_child[at(state)];
  double worst = of_child(shape[0]);
  for (int child = 1; child < mesh::family_size_of_state[at(state)]; ++child)
    worst = std::min(worst, of_child(shape[at(child)]));
  return worst;
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
    for (const auto shape : table.of_inner[d]) worst = std::min(worst, of_child(shape));
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

bool CellShape::is_higher_longer(int face, int pair) const {
  const unsigned bit = 1U << (3 * face + pair);
  if ((known_ & bit) == 0) {
    known_ |= bit;
    const auto [lower, higher] = pair_of_face[at(face)][at(pair)];
    if (is_longer(higher, lower)) longer_ |= bit;
  }
  return (longer_ & bit) != 0;
}

unsigned CellShape::cuts(EdgeMask marks) const {
  if (!has_two_mark_face[marks]) return 0;
  unsigned cuts = 0;
  for (int f = 0; f < 4; ++f) {
    const int pair = marked_pair[marks][at(f)];
    if (pair < 0) continue;
    const auto face = mesh::tet::face_edge_mask[at(f)];
    const bool is_higher =
        (old_.mask & face) == (marks & face) ? (old_.cuts >> f & 1U) != 0 : is_higher_longer(f, pair);
    cuts |= (is_higher ? 1U : 0U) << f;
  }
  return cuts;
}

int only_state(EdgeMask marks) {
  const auto& choice = states_of_marks[marks][0].state;
  return has_two_mark_face[marks] || choice[1] != 0 ? 0 : choice[0];
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

bool CellShape::adds_earlier_edges(EdgeMask added, EdgeMask other) const {
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
  const auto& [sets, begin] = sets_by_size;
  for (std::size_t n_added = 1; n_added <= 4; ++n_added) {
    std::array<double, 64> quality{};
    double best = limit;
    for (std::size_t i = begin[n_added]; i < begin[n_added + 1]; ++i) {
      const auto added = sets[i];
      if ((added & marks) != 0 || (added | marks) == all_edges) continue;
      quality[added] = of_marks(static_cast<EdgeMask>(added | marks));
      best = std::max(best, quality[added]);
    }
    EdgeMask found = 0;
    for (std::size_t i = begin[n_added]; i < begin[n_added + 1]; ++i) {
      const auto added = sets[i];
      if ((added & marks) != 0 || (added | marks) == all_edges) continue;
      if (!(quality[added] >= limit) || quality[added] < equal_cubes * best) continue;
      if (found == 0 || adds_earlier_edges(added, found)) found = added;
    }
    if (found != 0) return static_cast<EdgeMask>(found | marks);
  }
  return all_edges;
}

EdgeMask CellShape::closed_marks(EdgeMask marks, double floor) const {
  const bool has_floor = volume_ > 0 && floor > 0;
  if (!has_floor && old_.mask == 0) return marks;  // only old cuts can leave no way at all
  double limit = has_floor ? equal_cubes * cubed(floor) : std::numeric_limits<double>::lowest();
  bool is_reachable = !has_floor;  // what 1:8 reaches is asked for where something falls short of the floor
  unsigned set = marks;
  std::uint64_t is_checked = 0;
  for (unsigned rest = set; rest != 0 && set != all_edges;) {
    const unsigned before = set;
    const auto some = static_cast<EdgeMask>(rest);
    if ((is_checked >> rest & 1U) == 0 && !marks_reach(some, limit)) {
      if (!is_reachable) {
        is_reachable = true;
        const double reachable = of_regular_split();
        limit = reachable > 0 ? std::min(limit, equal_cubes * reachable) : std::numeric_limits<double>::lowest();
      }
      if (!marks_reach(some, limit)) set |= smallest_good(some, limit);
    }
    is_checked |= std::uint64_t{1} << rest;
    rest = set != before ? set : (rest - 1) & set;
  }
  return static_cast<EdgeMask>(set);
}

}  // namespace pamr::refine
