// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_level0.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "pamr/geometry/plane.hpp"
#include "support/reference_family.hpp"

namespace pamr::test {

namespace {

using geometry::Vec3;
using mesh::tet::edge_to_corner;
using Corners = std::set<int>;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Begins with its first term.
struct Sum {
  std::optional<Vec3> value;
  void add(Vec3 term) { value = value ? *value + term : term; }
};

Corners corners_with_weight(const std::array<double, 4>& w) {
  Corners corners;
  for (int i = 0; i < 4; ++i)
    if (w[at(i)] > 0) corners.insert(i);
  return corners;
}

/// The edge between two corners, the face of three: its number.
int edge_of(const Corners& corners) { return mesh::tet::edge_of[at(*corners.begin())][at(*corners.rbegin())]; }
int face_of(const Corners& corners) {
  int face = 0;
  while (corners.count(face) != 0) ++face;
  return face;
}

bool has_bit(unsigned bits, int i) { return (bits >> i & 1U) != 0; }
bool holds(const Corners& large, const Corners& small) {
  return std::includes(large.begin(), large.end(), small.begin(), small.end());
}

/// Faces and edges of a cell in lexicographic order.
const std::vector<Corners>& faces() {
  static const std::vector<Corners> all{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  return all;
}
const std::vector<Corners>& edges() {
  static const std::vector<Corners> all{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  return all;
}

}  // namespace

Barycentric halfway(const Barycentric& a, const Barycentric& b) {
  if (a.empty() || b.empty()) return {};
  Barycentric middle;
  for (const auto& key : {a, b})
    for (const auto& [node, weight] : key) middle[node] += weight / 2;
  return middle;
}

std::optional<Vec3> ReferenceMap::place(int row, const Barycentric& key) const {
  const auto& cell = cells_.at(at(row));
  Weights w{};
  std::size_t n_found = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (const auto found = key.find(cell.node[i]); found != key.end()) {
      w[i] = found->second;
      ++n_found;
    }
  if (n_found == 0 || n_found != key.size()) throw std::logic_error("level 0: a node outside the cell of its row");
  const auto support = corners_with_weight(w);
  if (support.size() == 1) return cell.corner[at(*support.begin())];
  if (std::none_of(support.begin(), support.end(), [&](int i) { return has_bit(cell.bent_corners, i); })) return {};
  const auto q = quadratic(cell, w);
  if (is_in_wall(cell, support)) return onto_wall(cell, support, w);
  const auto r = rest(cell, w);
  return r ? q + *r : q;
}

Vec3 ReferenceMap::quadratic(const mesh::Level0Cell& cell, const Weights& w) const {
  const auto support = corners_with_weight(w);
  Sum sum;
  for (const int i : support) sum.add(w[at(i)] * cell.corner[at(i)]);
  for (const auto& edge : edges()) {
    const auto& bulge = cell.bulge[at(edge_of(edge))];
    if (holds(support, edge) && !(bulge == Vec3{})) sum.add(4 * w[at(*edge.begin())] * w[at(*edge.rbegin())] * bulge);
  }
  return *sum.value;
}

std::optional<Vec3> ReferenceMap::rest(const mesh::Level0Cell& cell, const Weights& w) const {
  const auto support = corners_with_weight(w);
  const auto wants = [&](const Corners& side) { return holds(support, side) && is_in_wall(cell, side); };
  const auto wanted = [&](const Corners& side) {  // u^2 (S(Q) - Q)
    double u = 0;
    for (const int i : side) u += w[at(i)];
    Weights on_side{};
    for (const int i : side) on_side[at(i)] = w[at(i)] / u;
    return u * u * (onto_wall(cell, side, on_side) - quadratic(cell, on_side));
  };
  Sum sum;
  for (const auto& face : faces())
    if (wants(face)) sum.add(wanted(face));
  for (const auto& edge : edges()) {
    if (!wants(edge)) continue;
    int c = 1;
    for (const auto& face : faces())
      if (wants(face) && holds(face, edge)) --c;
    if (c != 0) sum.add(c * wanted(edge));
  }
  return sum.value;
}

bool ReferenceMap::is_in_wall(const mesh::Level0Cell& cell, const Corners& support) const {
  if (support.size() == 2) return cell.edge_patch[at(edge_of(support))][0] >= 0;
  return support.size() == 3 && cell.face_patch[at(face_of(support))] >= 0;
}

Vec3 ReferenceMap::onto_wall(const mesh::Level0Cell& cell, const Corners& support, const Weights& w) const {
  auto from = quadratic(cell, w);
  if (support.size() == 2) return onto_edge(cell, edge_of(support), from);
  Sum bounds;
  for (const auto& edge : edges()) {
    if (!holds(support, edge) || !is_on_curve(cell, edge_of(edge))) continue;
    const double u = w[at(*edge.begin())] + w[at(*edge.rbegin())];
    Weights on_edge{};
    for (const int i : edge) on_edge[at(i)] = w[at(i)] / u;
    const auto q = quadratic(cell, on_edge);
    bounds.add(u * u * (onto_edge(cell, edge_of(edge), q) - q));
  }
  if (bounds.value) from = from + *bounds.value;
  const std::array surfaces{surface_of_patch_.at(at(cell.face_patch[at(face_of(support))]))};
  const auto placed = geometry::project_onto_all(surfaces, from);
  return placed.converged ? placed.point : from;
}

bool ReferenceMap::is_on_curve(const mesh::Level0Cell& cell, int edge) {
  return cell.edge_patch[at(edge)][0] != cell.edge_patch[at(edge)][1] || has_bit(cell.creases, edge) ||
         has_bit(cell.sharp_edges, edge);
}

/// As everywhere else: on a sharp edge of the surface; beside a face of a patch without a surface on the surface within
/// the plane of that face (through the edge's first corner), if they meet in a sharp edge; between two patches of one
/// surface on its seam; else on all surfaces. Where they have no common point near by: where it was.
Vec3 ReferenceMap::onto_edge(const mesh::Level0Cell& cell, int edge, Vec3 from) const {
  std::vector<const geometry::Surface*> surfaces;
  for (const auto patch : std::set<std::int32_t>(cell.edge_patch[at(edge)].begin(), cell.edge_patch[at(edge)].end()))
    if (const auto* surface = surface_of_patch_.at(at(patch)); surface != nullptr) surfaces.push_back(surface);
  const bool is_seam = surfaces.size() == 2 && surfaces[0] == surfaces[1];
  if (has_bit(cell.creases, edge) || is_seam) return surfaces.front()->project_to_seam(from);
  std::optional<geometry::Plane> plane;
  if (has_bit(cell.sharp_edges, edge))
    surfaces.insert(surfaces.begin(),
                    &plane.emplace(cell.corner[at(edge_to_corner[at(edge)][0])], cell.beside[at(edge)]));
  const auto placed = geometry::project_onto_all(surfaces, from);
  return placed.converged ? placed.point : from;
}

std::optional<Vec3> ReferenceLevel0::mapped_middle(int row_of_cell, const Edge& edge) const {
  if (row_of_cell < 0) return {};
  return map->place(row_of_cell, halfway(key.at(at(edge.first)), key.at(at(edge.second))));
}

Vec3 ReferenceLevel0::middle(int row_of_cell, const Edge& edge, const Points& point) const {
  const auto mapped = mapped_middle(row_of_cell, edge);
  return mapped ? *mapped : geometry::midpoint(point[at(edge.first)], point[at(edge.second)]);
}

void ReferenceLevel0::add_middle(const Edge& edge) {
  if (map != nullptr) key.push_back(halfway(key.at(at(edge.first)), key.at(at(edge.second))));
}

std::optional<std::array<Vec3, 6>> ReferenceLevel0::middles(const Piece& piece, const Points& point) const {
  if (piece.row < 0) return {};
  std::array<Vec3, 6> all;
  for (int e = 0; e < 6; ++e) all[at(e)] = middle(piece.row, piece.edge(e), point);
  return all;
}

ReferenceLevel0 look_at_level0(const mesh::BlockMesh& whole, const ReferenceMap& map) {
  ReferenceLevel0 level0{&map, {}, std::vector<Barycentric>(whole.node_position.size())};
  std::map<std::set<GlobalId>, int> row_of;
  for (const auto& cell : map.cells()) {
    const auto row = static_cast<int>(row_of.size());
    row_of[{cell.node.begin(), cell.node.end()}] = row;
    for (const auto node : cell.node) level0.key.at(at(node)) = {{node, 1.0}};
  }
  for (const auto& nodes : whole.cell_to_node) {
    const auto found = row_of.find({nodes.begin(), nodes.end()});
    level0.row.push_back(found == row_of.end() ? -1 : found->second);
  }
  return level0;
}

std::vector<Piece> pieces_of(const mesh::BlockMesh& whole, const ReferenceLevel0& level0) {
  auto pieces = pieces_of(whole);
  for (std::size_t c = 0; c < level0.row.size(); ++c) pieces.at(c).row = level0.row[c];
  return pieces;
}

}  // namespace pamr::test
