// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_patterns.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <tuple>

#include "pamr/mesh/tet.hpp"

namespace pamr::test {

namespace {

using mesh::tet::edge_to_corner;
using Whole = std::array<std::int64_t, 3>;
using Cell = std::array<Code, 4>;
using Triangle = std::array<Code, 3>;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Twice the position in a cell with corners at the origin and the unit vectors.
Whole place(Code code) {
  Whole p{};
  const auto add = [&p](int corner, std::int64_t weight) {
    if (corner > 0) p[at(corner - 1)] += weight;
  };
  add(code < 4 ? code : edge_to_corner[at(code - 4)][0], 1);
  add(code < 4 ? code : edge_to_corner[at(code - 4)][1], 1);
  return p;
}

Whole minus(const Whole& a, const Whole& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Whole cross(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t dot(const Whole& a, const Whole& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Cell ascending(Cell c) {
  std::sort(c.begin(), c.end());
  return c;
}

/// The same oriented triangle, its smallest code first.
Triangle turned(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}
Triangle reversed(const Triangle& t) { return turned({t[0], t[2], t[1]}); }

/// Seen from outside.
std::set<Triangle> faces_of(const Cell& c) {
  std::set<Triangle> faces;
  for (const auto& f : mesh::tet::face_to_corner) faces.insert(turned({c[at(f[0])], c[at(f[1])], c[at(f[2])]}));
  return faces;
}

/// A plane between two cells, parallel to a face of one or to an edge of each: their interiors have no common point.
bool are_apart(const Cell& p, const Cell& q) {
  std::vector<Whole> normals;
  for (const auto& c : {p, q})
    for (const auto& f : mesh::tet::face_to_corner)
      normals.push_back(
          cross(minus(place(c[at(f[1])]), place(c[at(f[0])])), minus(place(c[at(f[2])]), place(c[at(f[0])]))));
  for (const auto& [a, b] : edge_to_corner)
    for (const auto& [c, d] : edge_to_corner)
      normals.push_back(cross(minus(place(p[at(b)]), place(p[at(a)])), minus(place(q[at(d)]), place(q[at(c)]))));
  return std::any_of(normals.begin(), normals.end(), [&](const Whole& normal) {
    if (normal == Whole{}) return false;
    std::array<std::int64_t, 4> of_p{}, of_q{};
    for (std::size_t i = 0; i < 4; ++i) {
      of_p[i] = dot(normal, place(p[i]));
      of_q[i] = dot(normal, place(q[i]));
    }
    const auto [p_min, p_max] = std::minmax_element(of_p.begin(), of_p.end());
    const auto [q_min, q_max] = std::minmax_element(of_q.begin(), of_q.end());
    return *p_max <= *q_min || *q_max <= *p_min;
  });
}

/// Triangles of a face of the cell, seen from outside.
std::vector<Triangle> cut_face(int face, EdgeSet marks, const Cuts& cut) {
  auto corner = mesh::tet::face_to_corner[at(face)];
  const auto edge = [&](std::size_t i) { return mesh::tet::edge_of[at(corner[i])][at(corner[(i + 1) % 3])]; };
  const auto is_marked = [&](std::size_t i) { return marks.count(edge(i)) != 0; };
  const int n_marked = static_cast<int>(is_marked(0)) + static_cast<int>(is_marked(1)) + static_cast<int>(is_marked(2));
  // turned so that the one marked edge, or the corner between two of them, comes first
  while ((n_marked == 1 && !is_marked(0)) || (n_marked == 2 && is_marked(1)))
    std::rotate(corner.begin(), corner.begin() + 1, corner.end());
  const auto [a, b, c] = corner;
  const Code ab = 4 + edge(0), bc = 4 + edge(1), ca = 4 + edge(2);
  if (n_marked == 0) return {{a, b, c}};
  if (n_marked == 1) return {{a, ab, c}, {ab, b, c}};
  if (n_marked == 3) return {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}};
  if (4 + cut.at(face) == ab) return {{a, ab, ca}, {ab, b, c}, {ab, c, ca}};
  return {{a, ab, ca}, {ab, b, ca}, {b, c, ca}};
}

std::set<Triangle> cut_boundary(EdgeSet marks, const Cuts& cut) {
  std::set<Triangle> triangles;
  for (int face = 0; face < 4; ++face)
    for (const auto& t : cut_face(face, marks, cut)) triangles.insert(turned(t));
  return triangles;
}

/// All positive cells of the given nodes.
std::vector<Cell> candidates(const std::vector<Code>& node) {
  std::vector<Cell> cells;
  for (std::size_t a = 0; a < node.size(); ++a)
    for (std::size_t b = a + 1; b < node.size(); ++b)
      for (std::size_t c = b + 1; c < node.size(); ++c)
        for (std::size_t d = c + 1; d < node.size(); ++d) {
          Cell cell{node[a], node[b], node[c], node[d]};
          if (eighths_of_volume(cell) < 0) std::swap(cell[2], cell[3]);
          if (eighths_of_volume(cell) > 0) cells.push_back(cell);
        }
  return cells;
}

/// Fills the space behind the triangles of the front, which are seen from outside, in every way.
void fill(const std::set<Triangle>& front, std::vector<Cell>& chosen, const std::vector<Cell>& cells,
          std::vector<std::vector<Cell>>& found) {
  if (front.empty()) {
    found.push_back(chosen);
    std::sort(found.back().begin(), found.back().end(),
              [](const Cell& a, const Cell& b) { return ascending(a) < ascending(b); });
    return;
  }
  for (const auto& cell : cells) {
    const auto faces = faces_of(cell);
    if (faces.count(*front.begin()) == 0) continue;
    if (!std::all_of(chosen.begin(), chosen.end(), [&](const Cell& other) { return are_apart(cell, other); })) continue;
    auto next = front;
    for (const auto& face : faces)
      if (next.erase(face) == 0) next.insert(reversed(face));
    chosen.push_back(cell);
    fill(next, chosen, cells, found);
    chosen.pop_back();
  }
}

std::vector<Cuts> all_cuts(EdgeSet marks) {
  std::vector<Cuts> cuts{{}};
  for (int face = 0; face < 4; ++face) {
    std::vector<int> marked;
    for (const int e : marks)
      if (edge_to_corner[at(e)][0] != face && edge_to_corner[at(e)][1] != face) marked.push_back(e);
    if (marked.size() != 2) continue;
    std::vector<Cuts> more;
    for (const auto& cut : cuts)
      for (const int e : marked) {
        more.push_back(cut);
        more.back()[face] = e;
      }
    cuts = more;
  }
  return cuts;
}

int inner_edge_of(const std::vector<Cell>& children) {
  for (int e = 0; e < 3; ++e)
    for (const auto& c : children)
      if (std::count(c.begin(), c.end(), 4 + e) + std::count(c.begin(), c.end(), 9 - e) == 2) return e;
  return -1;
}

std::vector<ReferencePattern> search() {
  std::vector<ReferencePattern> patterns;
  for (int mask = 0; mask < 64; ++mask) {
    EdgeSet marks;
    std::vector<Code> node{0, 1, 2, 3};
    for (int e = 0; e < 6; ++e)
      if ((mask >> e & 1) != 0) {
        marks.insert(e);
        node.push_back(4 + e);
      }
    const auto cells = candidates(node);
    for (const auto& cut : all_cuts(marks)) {
      std::vector<std::vector<Cell>> found;
      std::vector<Cell> chosen;
      fill(cut_boundary(marks, cut), chosen, cells, found);
      std::map<int, ReferencePattern> by_inner_edge;
      for (const auto& children : found) {
        const int inner = inner_edge_of(children);
        if (!by_inner_edge.emplace(inner, ReferencePattern{marks, cut, inner, children}).second)
          throw std::logic_error("two triangulations with the same marks, cuts and inner edge");
      }
      for (const auto& [inner, pattern] : by_inner_edge) patterns.push_back(pattern);
    }
  }
  return patterns;
}

EdgeSet edges_of(int face) {
  EdgeSet edges;
  for (int e = 0; e < 6; ++e)
    if (edge_to_corner[at(e)][0] != face && edge_to_corner[at(e)][1] != face) edges.insert(e);
  return edges;
}

/// The two children of 1:2: the second end of the edge gives way to the midpoint, then the first.
ReferencePattern halves(int edge) {
  ReferencePattern pattern{{edge}, {}, -1, {{0, 1, 2, 3}, {0, 1, 2, 3}}};
  pattern.child[0][at(edge_to_corner[at(edge)][1])] = pattern.child[1][at(edge_to_corner[at(edge)][0])] = 4 + edge;
  return pattern;
}

/// The four children of 1:4: the corners of the face in turn keep theirs, the two others give way to the midpoints
/// towards it; the last cell stands on the triangle of the midpoints, each in the place of the corner opposite to it.
ReferencePattern quarters(int face) {
  ReferencePattern pattern{edges_of(face), {}, -1, {}};
  Cell central{0, 1, 2, 3};
  for (int kept = 0; kept < 4; ++kept) {
    if (kept == face) continue;
    Cell child{0, 1, 2, 3};
    for (int slot = 0; slot < 4; ++slot)
      if (slot != kept && slot != face) child[at(slot)] = 4 + mesh::tet::edge_of[at(kept)][at(slot)];
    for (const int e : edges_of(face))
      if (edge_to_corner[at(e)][0] != kept && edge_to_corner[at(e)][1] != kept) central[at(kept)] = 4 + e;
    pattern.child.push_back(child);
  }
  pattern.child.push_back(central);
  return pattern;
}

std::vector<ReferencePattern> list_families() {
  std::vector<ReferencePattern> patterns{{{}, {}, -1, {{0, 1, 2, 3}}}};
  for (int e = 0; e < 6; ++e) patterns.push_back(halves(e));
  for (int f = 0; f < 4; ++f) patterns.push_back(quarters(f));
  const auto is_listed = [&patterns](const ReferencePattern& p) {
    return std::any_of(patterns.begin(), patterns.begin() + 11,
                       [&](const ReferencePattern& known) { return known.marks == p.marks; });
  };
  for (const auto& pattern : all_patterns())
    if (pattern.marks.size() < 6 && !is_listed(pattern)) patterns.push_back(pattern);
  return patterns;
}

}  // namespace

std::int64_t eighths_of_volume(const Cell& c) {
  const auto o = place(c[0]);
  return dot(cross(minus(place(c[1]), o), minus(place(c[2]), o)), minus(place(c[3]), o));
}

const std::vector<ReferencePattern>& all_patterns() {
  static const auto patterns = search();
  return patterns;
}

const std::vector<ReferencePattern>& patterns_of(EdgeSet marks, const Cuts& cut) {
  static const auto by_marks_and_cuts = [] {
    std::map<std::pair<EdgeSet, Cuts>, std::vector<ReferencePattern>> index;
    for (const auto& pattern : family_patterns()) index[{pattern.marks, pattern.cut}].push_back(pattern);
    return index;
  }();
  static const std::vector<ReferencePattern> none;
  const auto found = by_marks_and_cuts.find({marks, cut});
  return found == by_marks_and_cuts.end() ? none : found->second;
}

const std::vector<ReferencePattern>& family_patterns() {
  static const auto patterns = list_families();
  return patterns;
}

int state_of(const ReferencePattern& pattern) {
  static const auto by_content = [] {
    std::map<std::tuple<EdgeSet, Cuts, int>, int> index;
    for (const auto& known : family_patterns())
      index.emplace(std::tuple(known.marks, known.cut, known.inner_edge), static_cast<int>(index.size()));
    return index;
  }();
  return by_content.at({pattern.marks, pattern.cut, pattern.inner_edge});
}

bool is_conforming(const ReferencePattern& pattern) {
  std::int64_t sum = 0;
  std::map<Triangle, int> inside;  // as each child shows it to the outside
  for (const auto& child : pattern.child) {
    if (eighths_of_volume(child) <= 0) return false;
    sum += eighths_of_volume(child);
    for (const auto& face : faces_of(child)) ++inside[face];
  }
  if (sum != eighths_of_volume({0, 1, 2, 3})) return false;
  auto boundary = cut_boundary(pattern.marks, pattern.cut);
  for (const auto& [face, times] : inside) {
    const bool is_outer = boundary.erase(face) == 1;
    if (times != 1 || is_outer == (inside.count(reversed(face)) != 0)) return false;
  }
  return boundary.empty();
}

}  // namespace pamr::test
