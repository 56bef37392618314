// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "pamr/geometry/plane.hpp"
#include "support/reference_family.hpp"

namespace pamr::test {

namespace {

using geometry::Vec3;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

std::optional<Vec3> common_point(const SurfaceOfPatch& surfaces, Vec3 from) {
  const auto projected = geometry::project_onto_all(surfaces, from);
  return projected.converged ? std::optional(projected.point) : std::nullopt;
}

/// Where the middle of an edge goes that a face of a patch without a surface shares with one of `surface`: if they meet
/// at 40 degrees or more, onto the surface within the plane of that face.
WallTarget target_beside_face(Vec3 a, Vec3 b, Vec3 third, const geometry::Surface& surface) {
  if (geometry::lexicographically_less(b, a)) std::swap(a, b);
  const auto middle = midpoint(a, b), of_face = cross(b - a, third - a);
  const double cosine = std::abs(dot(of_face, surface.normal(middle))) / norm(of_face);
  const geometry::Plane plane(middle, of_face);
  const bool is_sharp = cosine <= std::cos(40 * std::numbers::pi / 180);
  const auto found = common_point(is_sharp ? SurfaceOfPatch{&plane, &surface} : SurfaceOfPatch{&surface}, middle);
  return {found.value_or(middle), of_face, is_sharp};
}

/// Level 0 with what the page says of it: rules 1 to 5 of "What is bent".
class Level0 {
 public:
  Level0(const mesh::BlockMesh& whole, const SurfaceOfPatch& surface_of_patch)
      : whole_(whole), surface_of_patch_(surface_of_patch), cell_(pieces_of(whole)) {
    for (const auto& [edge, faces] : faces_at_edges(cell_)) {
      const auto target = target_in_wall(edge, faces, surface_of_patch, whole.node_position);
      if (!target) continue;
      wall_[edge] = {*target, target->point - middle(edge), {faces.front().patch, faces.back().patch}};
      auto& bulge = wall_[edge].bulge;
      if (!(norm(bulge) > 1e-9 * length(edge))) bulge = {};
    }
    find_bent_nodes();
  }

  std::vector<mesh::Level0Cell> rows() const {
    std::vector<mesh::Level0Cell> rows;
    for (const auto& piece : cell_) {
      if (!has_bent_node(piece)) continue;
      rows.push_back(row_of(piece));
      rows.back().row = static_cast<GlobalId>(rows.size()) - 1;
    }
    return rows;
  }

 private:
  struct WallEdge {
    WallTarget target;
    Vec3 bulge;
    std::array<std::int32_t, 2> patch{};
    bool has_bulge() const { return !(bulge == Vec3{}); }
    bool is_in(const std::set<int>& patches) const {
      return patches.count(patch[0]) != 0 || patches.count(patch[1]) != 0;
    }
  };

  Vec3 point(GlobalId node) const { return whole_.node_position[at(node)]; }
  Vec3 middle(const Edge& edge) const { return midpoint(point(edge.first), point(edge.second)); }
  double length(const Edge& edge) const { return norm(point(edge.second) - point(edge.first)); }
  bool has_bent_node(const Piece& piece) const {
    return std::any_of(piece.corner.begin(), piece.corner.end(), [&](auto n) { return bent_.count(n) != 0; });
  }

  void bend(const std::array<std::int32_t, 2>& patches, std::set<int>& bent_patches) const {
    for (const int patch : patches)
      if (const auto* surface = surface_of_patch_[at(patch)]; surface != nullptr && !surface->is_flat())
        bent_patches.insert(patch);
  }

  void find_bent_nodes() {
    std::set<int> bent_patches;
    for (const auto& [edge, wall] : wall_)
      if (norm(wall.bulge) > length(edge) / 40) {
        bent_.insert({edge.first, edge.second});
        bend(wall.patch, bent_patches);
      }
    for (int layer = 0; layer < 2; ++layer) {
      const auto nearer = bent_;
      for (const auto& piece : cell_)
        if (std::any_of(piece.corner.begin(), piece.corner.end(), [&](auto n) { return nearer.count(n) != 0; }))
          bent_.insert(piece.corner.begin(), piece.corner.end());
    }
    for (std::size_t before = bent_patches.size() + 1; before != bent_patches.size();) {
      before = bent_patches.size();
      for (const auto& [edge, wall] : wall_)
        if (wall.has_bulge() && wall.is_in(bent_patches)) bent_.insert({edge.first, edge.second});
      for (const auto& piece : cell_)
        for (int e = 0; e < 6 && has_bent_node(piece); ++e)
          if (const auto wall = wall_.find(piece.edge(e));
              wall != wall_.end() && wall->second.has_bulge() && !wall->second.is_in(bent_patches))
            bend(wall->second.patch, bent_patches);
    }
  }

  mesh::Level0Cell row_of(const Piece& piece) const {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::sort(order.begin(), order.end(), [&](auto i, auto j) {
      return geometry::lexicographically_less(point(piece.corner[i]), point(piece.corner[j]));
    });
    mesh::Level0Cell row;
    for (std::size_t i = 0; i < 4; ++i) {
      row.node[i] = piece.corner[order[i]];
      row.corner[i] = point(row.node[i]);
      if (bent_.count(row.node[i]) != 0) row.bent_corners = static_cast<std::uint8_t>(row.bent_corners | 1U << i);
      const int patch = piece.patch[order[i]];
      const auto* surface = patch < 0 ? nullptr : surface_of_patch_[at(patch)];
      if (surface != nullptr && !surface->is_flat()) row.face_patch[i] = patch;
    }
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = mesh::tet::edge_to_corner[e];
      const auto found = wall_.find(edge_between(row.node[at(a)], row.node[at(b)]));
      if (found == wall_.end()) continue;
      const auto& [target, bulge, patch] = found->second;
      row.bulge[e] = bulge;
      row.edge_patch[e] = patch;
      row.beside[e] = target.beside;
      if (target.is_sharp) row.sharp_edges = static_cast<std::uint8_t>(row.sharp_edges | 1U << e);
    }
    return row;
  }

  const mesh::BlockMesh& whole_;
  const SurfaceOfPatch& surface_of_patch_;
  std::vector<Piece> cell_;
  std::map<Edge, WallEdge> wall_;  // those in curved walls
  std::set<GlobalId> bent_;
};

}  // namespace

std::map<Edge, std::vector<FaceAtEdge>> faces_at_edges(const std::vector<Piece>& cell) {
  std::map<Edge, std::vector<FaceAtEdge>> faces;
  for (const auto& piece : cell)
    for (int f = 0; f < 4; ++f)
      if (piece.patch[at(f)] >= 0)
        for (const int e : edges_of_face(f)) {
          const auto edge = piece.edge(e);
          for (int i = 0; i < 4; ++i)
            if (i != f && piece.corner[at(i)] != edge.first && piece.corner[at(i)] != edge.second)
              faces[edge].push_back({piece.patch[at(f)], piece.corner[at(i)]});
        }
  for (auto& [edge, at_edge] : faces)
    std::sort(at_edge.begin(), at_edge.end(), [](const auto& f, const auto& g) { return f.patch < g.patch; });
  return faces;
}

std::optional<WallTarget> target_in_wall(const Edge& edge, const std::vector<FaceAtEdge>& faces,
                                         const SurfaceOfPatch& surface_of_patch, const Points& point) {
  const auto a = point[at(edge.first)], b = point[at(edge.second)];
  SurfaceOfPatch surfaces;
  std::optional<GlobalId> third;  // of a face without surface
  for (const auto& face : faces) {
    const auto* surface = surface_of_patch[at(face.patch)];
    if (surface == nullptr)
      third = face.third;
    else if (std::find(surfaces.begin(), surfaces.end(), surface) == surfaces.end())
      surfaces.push_back(surface);
  }
  if (std::all_of(surfaces.begin(), surfaces.end(), [](const auto* s) { return s->is_flat(); })) return {};
  if (third) return target_beside_face(a, b, point[at(*third)], *surfaces.front());
  return WallTarget{common_point(surfaces, midpoint(a, b)).value_or(midpoint(a, b))};
}

std::vector<mesh::Level0Cell> reference_rows(const mesh::BlockMesh& whole, const SurfaceOfPatch& surface_of_patch) {
  return Level0(whole, surface_of_patch).rows();
}

}  // namespace pamr::test
