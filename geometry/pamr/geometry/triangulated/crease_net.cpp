// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/crease_net.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::geometry {

namespace {

constexpr double gain = 1 - 1e-12;       // a squared distance must fall below this part to count as nearer
constexpr double min_cosine = 1 - 1e-6;  // of the tangents of two creases that go on smoothly
constexpr int n_samples = 8;             // of each crease
constexpr double max_detour = 1.3;       // of the way along a line between two nodes next to each other
constexpr double piece_detour = 2;       // the same where the triangles beside the chord confirm it
constexpr double on_line = 1e-6;         // distance from a line, of the chord
constexpr double of_bulge = 1.5;         // more of it where nodes may lie on chords

}  // namespace

CreaseNet::CreaseNet(const Triangulation& surface, const Features& features, int only_piece) {
  std::vector<std::array<int, 2>> piece(features.creases.size(), {-1, -1});
  for (std::size_t t = 0; t < features.patch.size(); ++t)
    for (const int crease : features.crease_at[t])
      if (crease >= 0) (piece[at(crease)][0] < 0 ? piece[at(crease)][0] : piece[at(crease)][1]) = features.patch[t];
  std::map<int, int> number_of_point;
  std::vector<std::array<Vec3, 3>> flat;
  for (std::size_t c = 0; c < features.creases.size(); ++c) {
    if (only_piece >= 0 && piece[c][0] != only_piece && piece[c][1] != only_piece) continue;
    const auto& crease = features.creases[c];
    const Vec3 a = surface.points[at(crease.point[0])], b = surface.points[at(crease.point[1])];
    std::array<int, 2> end{};
    for (std::size_t k = 0; k < 2; ++k) {
      const auto next = static_cast<int>(number_of_point.size());
      end[k] = number_of_point.emplace(crease.point[k], next).first->second;
      edges_at_end_.resize(number_of_point.size());
      edges_at_end_[at(end[k])].push_back(static_cast<int>(edges_.size()));
    }
    const CurvedEdge curve({a, inner_point(a, b, crease.tangent[0]), inner_point(b, a, -crease.tangent[1]), b});
    edges_.push_back({curve, end, crease.tangent, piece[c], 0, 0, norm(b - a), true,
                      norm(curve.point(0.5) - midpoint(a, b)), static_cast<int>(c)});
    largest_bulge_ = std::max(largest_bulge_, edges_.back().bulge);
    chord_.push_back({a, b});
    flat.push_back({a, b, b});
  }
  if (flat.empty()) return;
  tree_.emplace(flat);
  chain();
}

bool CreaseNet::is_smooth_at(int end, int one, int other) const {
  const auto tangent = [&](int edge) { return edges_[at(edge)].tangent[edges_[at(edge)].end[0] == end ? 0 : 1]; };
  return std::abs(dot(tangent(one), tangent(other))) > min_cosine;
}

void CreaseNet::chain() {
  const auto next_of = [&](int edge, int end) {  // the crease with which the line goes on, or -1
    const auto& here = edges_at_end_[at(end)];
    if (here.size() != 2) return -1;
    const int other = here[0] == edge ? here[1] : here[0];
    return other != edge && is_smooth_at(end, edge, other) ? other : -1;
  };
  std::vector<bool> is_done(edges_.size(), false);
  for (int start = 0; at(start) < edges_.size(); ++start) {
    if (is_done[at(start)]) continue;
    // back to where the line begins, then on to where it ends
    int edge = start, end = edges_[at(start)].end[0];
    for (int next = next_of(edge, end); next >= 0 && next != start; next = next_of(edge, end)) {
      edge = next;
      end = edges_[at(edge)].end[0] == end ? edges_[at(edge)].end[1] : edges_[at(edge)].end[0];
    }
    Line line;
    while (edge >= 0 && !is_done[at(edge)]) {
      auto& here = edges_[at(edge)];
      is_done[at(edge)] = true;
      here.line = line_.size();
      here.start = line.length;
      here.runs_along = here.end[0] == end;
      line.length += here.length;
      line.edges.push_back(edge);
      end = here.runs_along ? here.end[1] : here.end[0];
      edge = next_of(edge, end);
    }
    line_.push_back(std::move(line));
    sample(line_.back());
  }
}

void CreaseNet::sample(Line& line) {
  CreaseLine result;
  std::vector<std::array<Vec3, 3>> flat;
  for (const int e : line.edges) {
    const auto& edge = edges_[at(e)];
    if (result.polyline.empty()) result.polyline.push_back(chord_[at(e)][edge.runs_along ? 0 : 1]);
    for (int i = 1; i < n_samples; ++i) {
      const double u = static_cast<double>(i) / n_samples;
      result.polyline.push_back(edge.curve.point(edge.runs_along ? u : 1 - u));
    }
    result.polyline.push_back(chord_[at(e)][edge.runs_along ? 1 : 0]);
    flat.push_back({chord_[at(e)][0], chord_[at(e)][1], chord_[at(e)][1]});
  }
  result.piece = edges_[at(line.edges.front())].piece;
  line.tree.emplace(flat);
  lines_.push_back(std::move(result));
}

std::pair<int, Foot> CreaseNet::nearest_edge(Vec3 point, const TriangleTree::Hit& chord) const {
  std::pair best(chord.triangle,
                 edges_[at(chord.triangle)].curve.nearest(point, std::clamp(chord.u + chord.v, 0.0, 1.0)));
  for (const int end : edges_[at(chord.triangle)].end)
    for (const int other : edges_at_end_[at(end)]) {
      if (other == chord.triangle) continue;
      const Foot foot = edges_[at(other)].curve.nearest(point, edges_[at(other)].end[0] == end ? 0 : 1);
      if (foot.squared_distance < gain * best.second.squared_distance) best = {other, foot};
    }
  return best;
}

Vec3 CreaseNet::nearest(Vec3 point) const { return nearest_edge(point, tree_->nearest(point)).second.point; }

std::optional<CreaseNet::Hit> CreaseNet::nearest_within(Vec3 point, double distance) const {
  if (is_empty()) return std::nullopt;
  const auto chord = tree_->nearest(point, distance + largest_bulge_);
  if (chord.triangle < 0) return std::nullopt;
  const auto [edge, foot] = nearest_edge(point, chord);
  return Hit{edges_[at(edge)].number, foot.u};
}

CreaseNet::Place CreaseNet::place_on(const Line& line, Vec3 point) const {
  const auto hit = line.tree->nearest(point);
  const auto try_edge = [&](int e, double u) {
    const auto& edge = edges_[at(e)];
    const Foot foot = edge.curve.nearest(point, u);
    return std::pair(foot.squared_distance,
                     Place{foot.point, edge.start + edge.length * (edge.runs_along ? foot.u : 1 - foot.u), edge.bulge});
  };
  const int nearest = line.edges[at(hit.triangle)];
  auto best = try_edge(nearest, std::clamp(hit.u + hit.v, 0.0, 1.0));
  for (const int end : edges_[at(nearest)].end)
    for (const int other : edges_at_end_[at(end)]) {
      if (other == nearest || edges_[at(other)].line != edges_[at(nearest)].line) continue;
      const auto found = try_edge(other, edges_[at(other)].end[0] == end ? 0 : 1);
      if (found.first < gain * best.first) best = found;
    }
  return best.second;
}

Vec3 CreaseNet::nearest_on_line(std::size_t line, Vec3 point) const { return place_on(line_[line], point).point; }

bool CreaseNet::is_near(Vec3 a, Vec3 b) const {
  if (is_empty()) return false;
  const double least = on_line * norm(b - a);
  const auto is_on = [&](Vec3 p) {
    const double bulge = edges_[at(tree_->nearest(p).triangle)].bulge;
    return norm(nearest(p) - p) <= least + of_bulge * bulge;
  };
  return is_on(a) && is_on(b);
}

std::optional<Vec3> CreaseNet::between_on(std::size_t number, Vec3 a, Vec3 b, std::array<int, 2> sides) const {
  const auto& piece = lines_[number].piece;
  const bool is_inner = piece[0] == piece[1];
  if (!is_inner && piece != sides && piece != std::array{sides[1], sides[0]}) return std::nullopt;
  const auto& line = line_[number];
  const auto from = place_on(line, a), to = place_on(line, b);
  const double chord = norm(b - a), more = is_inner ? 0 : of_bulge;
  if (!(norm(from.point - a) <= on_line * chord + more * from.bulge)) return std::nullopt;
  if (!(norm(to.point - b) <= on_line * chord + more * to.bulge)) return std::nullopt;
  double way = std::abs(to.way - from.way);
  if (lines_[number].is_closed()) way = std::min(way, line.length - way);
  if (!(way <= (is_inner ? max_detour : piece_detour) * chord)) return std::nullopt;
  return place_on(line, midpoint(a, b)).point;
}

std::optional<Vec3> CreaseNet::between(Vec3 a, Vec3 b, std::array<int, 2> sides) const {
  if (is_empty()) return std::nullopt;
  if (lexicographically_less(b, a)) std::swap(a, b);
  // Beside corners a node lies on several lines.
  for (const auto& end : {a, b})
    for (const int known : edges_[at(tree_->nearest(end).triangle)].end)
      for (const int candidate : edges_at_end_[at(known)])
        if (const auto middle = between_on(edges_[at(candidate)].line, a, b, sides)) return middle;
  return std::nullopt;
}

}  // namespace pamr::geometry
