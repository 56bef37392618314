// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Whether a code has done the work that it was given, from the corners of its cells alone: their volume, faces that
/// have no cell on the other side though they are not of the boundary, cells that are gone, shapes, nodes of a curved
/// wall that are off it. assess.py has the same for Python.
namespace peer {

using Point = std::array<double, 3>;
using Corners = std::array<Point, 4>;

constexpr double front_start = 0.4, front_shift = 0.01, front_radius = 0.3;  ///< the sphere that moves along x
constexpr Point hole_center{0, 0, 0};
constexpr double hole_radius = 1, hole_box = 2;  ///< a ball is cut out of the box [-hole_box, hole_box]^3
/// Times the radius: the nodes of the wall of the hole are nearer than that, those of a facet are inside the ball.
constexpr double on_wall = 1 + 1e-6;
constexpr std::size_t max_cells_for_faces = 3000000;  ///< of larger meshes the faces are not looked at

inline double distance(const Point& p, const Point& q) { return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); }

inline Point centroid(const Corners& p) {
  Point sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] = 0.25 * (p[0][axis] + p[1][axis] + p[2][axis] + p[3][axis]);
  return sum;
}

/// Of the nearest and of the farthest corner.
inline std::pair<double, double> distances(const Corners& p, const Point& center) {
  double nearest = 1e300, farthest = 0;
  for (const auto& corner : p) {
    nearest = std::min(nearest, distance(corner, center));
    farthest = std::max(farthest, distance(corner, center));
  }
  return {nearest, farthest};
}

inline double longest_edge(const Corners& p) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, distance(p[i], p[j]));
  return longest;
}

inline double volume(const Corners& p) {
  std::array<Point, 3> d{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) d[i][axis] = p[i + 1][axis] - p[0][axis];
  return std::abs(d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                  d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                  d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0])) /
         6;
}

/// 12 (3V)^(2/3) / sum of squared edges, 1 for a regular tetrahedron.
inline double mean_ratio(const Corners& p) {
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) squares += std::pow(distance(p[i], p[j]), 2);
  return 12 * std::pow(3 * volume(p), 2.0 / 3) / squares;
}

enum class Domain { cube, hole, any };

/// The unit cube of `kuhn:N`, the box with a hole of a file of that name, or one that nothing is known of.
inline Domain domain_of(const std::string& mesh_name) {
  if (mesh_name.rfind("kuhn:", 0) == 0) return Domain::cube;
  return mesh_name.find("hole") != std::string::npos ? Domain::hole : Domain::any;
}

/// Whether a face with these corners lies on the boundary.
inline bool is_outer(const std::array<Point, 3>& face, Domain domain) {
  const double low = domain == Domain::cube ? 0 : -hole_box, high = domain == Domain::cube ? 1 : hole_box;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {low, high})
      if (std::all_of(face.begin(), face.end(), [&](const Point& p) { return std::abs(p[axis] - side) < 1e-9; }))
        return true;
  return domain == Domain::hole && std::all_of(face.begin(), face.end(), [](const Point& p) {
           return distance(p, hole_center) <= on_wall * hole_radius;
         });
}

/// A number for a point, the same for the same coordinates only.
inline std::uint64_t key_of(const Point& p) {
  std::uint64_t key = 0x9e3779b97f4a7c15U;
  for (const double x : p) {
    key ^= std::bit_cast<std::uint64_t>(x + 0.0);  // -0 becomes 0
    key = (key ^ (key >> 33)) * 0xff51afd7ed558ccdU;
    key = (key ^ (key >> 33)) * 0xc4ceb9fe1a85ec53U;
    key ^= key >> 33;
  }
  return key;
}

struct Assessment {
  double volume = 0;
  double worst = 1, low = 1, mean = 0;     ///< low: one cell of a thousand is below
  std::int64_t split = -1;                 ///< cells of the mesh before that are gone; -1: there was none
  std::int64_t open = -1;                  ///< faces of one cell that are not of the boundary; -1: not looked for
  std::int64_t wall_nodes = -1, off = -1;  ///< nodes of the wall of the hole, and those off it; -1: no hole
  double farthest = 0;                     ///< of the nodes of the wall from it
  std::vector<std::uint64_t> cells;        ///< a key for each cell, ascending
};

inline std::string text_of(const Assessment& a) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(),
                ", \"volume\": %.12g, \"worst\": %.6f, \"low\": %.6f, \"mean\": %.6f, \"split\": %ld, \"open\": %ld, "
                "\"wall_nodes\": %ld, \"off\": %ld, \"farthest\": %.3g",
                a.volume, a.worst, a.low, a.mean, static_cast<long>(a.split), static_cast<long>(a.open),
                static_cast<long>(a.wall_nodes), static_cast<long>(a.off), a.farthest);
  return text.data();
}

/// Faces of one cell that are not of the boundary; those of more than two cells count too. A face with all nodes on a
/// curved wall may be an inner one.
template <class Peer>
std::int64_t open_faces(Peer& peer, Domain domain) {
  struct Face {
    std::uint64_t key;
    bool is_outer;
  };
  constexpr std::array<std::array<std::size_t, 3>, 4> face_to_corner{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<Face> faces;
  faces.reserve(4 * peer.n_cells());
  peer.corners([&](const Corners& p) {
    for (const auto& f : face_to_corner)
      faces.push_back(
          {key_of(p[f[0]]) + key_of(p[f[1]]) + key_of(p[f[2]]), is_outer({p[f[0]], p[f[1]], p[f[2]]}, domain)});
  });
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key < b.key; });
  std::int64_t open = 0;
  for (auto first = faces.begin(); first != faces.end();) {
    const auto last = std::find_if(first, faces.end(), [&](const Face& face) { return face.key != first->key; });
    const auto n = std::distance(first, last);
    if (n != 2 && !(n == 1 && first->is_outer)) ++open;
    first = last;
  }
  return open;
}

template <class Peer>
void assess_wall(Peer& peer, Assessment& found) {
  std::vector<std::pair<std::uint64_t, double>> nodes;
  peer.corners([&](const Corners& p) {
    for (const auto& corner : p) {
      const double r = distance(corner, hole_center);
      if (r <= on_wall * hole_radius) nodes.emplace_back(key_of(corner), std::abs(r - hole_radius));
    }
  });
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  found.wall_nodes = static_cast<std::int64_t>(nodes.size());
  found.off = std::count_if(nodes.begin(), nodes.end(), [](const auto& node) { return node.second > 1e-9; });
  for (const auto& node : nodes) found.farthest = std::max(found.farthest, node.second);
}

template <class Peer>
Assessment assess(Peer& peer, Domain domain, const std::optional<Assessment>& before) {
  Assessment found;
  std::vector<double> ratio;
  ratio.reserve(peer.n_cells());
  found.cells.reserve(peer.n_cells());
  peer.corners([&](const Corners& p) {
    found.volume += volume(p);
    ratio.push_back(mean_ratio(p));
    found.cells.push_back(key_of(p[0]) + key_of(p[1]) + key_of(p[2]) + key_of(p[3]));
  });
  for (const double r : ratio) found.mean += r / static_cast<double>(ratio.size());
  const auto low = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 1000);
  std::nth_element(ratio.begin(), low, ratio.end());
  found.low = *low;
  found.worst = *std::min_element(ratio.begin(), low + 1);
  std::sort(found.cells.begin(), found.cells.end());
  if (before) {
    std::vector<std::uint64_t> gone;
    std::set_difference(before->cells.begin(), before->cells.end(), found.cells.begin(), found.cells.end(),
                        std::back_inserter(gone));
    found.split = static_cast<std::int64_t>(gone.size());
  }
  if (domain != Domain::any && peer.n_cells() <= max_cells_for_faces) found.open = open_faces(peer, domain);
  if (domain == Domain::hole) assess_wall(peer, found);
  return found;
}

}  // namespace peer
