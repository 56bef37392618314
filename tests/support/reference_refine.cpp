// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_refine.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "pamr/geometry/plane.hpp"
#include "support/reference.hpp"
#include "support/reference_close.hpp"
#include "support/reference_split.hpp"

namespace pamr::test {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

std::vector<Piece> pieces_of(const mesh::BlockMesh& whole) {
  std::vector<Piece> pieces(whole.cell_to_node.size());
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    pieces[c].corner = whole.cell_to_node[c];
    if (!whole.lineage.empty()) pieces[c].lineage = whole.lineage[c];
    for (std::size_t f = 0; f < 4; ++f) {
      const auto neighbor = whole.cell_to_cell[c][f];
      if (neighbor < 0) pieces[c].patch[f] = static_cast<int>(-neighbor - 1);
    }
  }
  return pieces;
}

/// First members of the families of which a member is split while the family stays: its other members are broken.
std::set<GlobalId> broken_families(const std::vector<Piece>& cell, const ReferenceClosing& closing) {
  std::set<GlobalId> broken;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto first = static_cast<GlobalId>(c) - cell[c].lineage.child();
    if (cell[c].lineage.is_removable() && closing.family.count(first) == 0 &&
        !edges_within(cell[c], closing.marked).empty())
      broken.insert(first);
  }
  return broken;
}

/// Children of all old cells, in the old order; those of a family that is taken back in the place of its first member.
struct Offspring {
  std::vector<Piece> piece;
  std::vector<GlobalId> from;  ///< old cell, or first member
};

Offspring split_all(const std::vector<Piece>& cell, const ReferenceClosing& closing, const Points& point) {
  const auto broken = broken_families(cell, closing);
  Middles middle;  // of marked edges
  for (const auto& edge : closing.marked) middle[edge] = closing.middle.at(edge);
  Offspring offspring;
  const auto add = [&](const std::vector<Piece>& pieces, GlobalId from) {
    for (const auto& piece : pieces) {
      offspring.piece.push_back(piece);
      offspring.from.push_back(from);
    }
  };
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto id = static_cast<GlobalId>(c), first = id - cell[c].lineage.child();
    if (cell[c].lineage.is_removable() && closing.family.count(first) != 0) {
      if (id == first)
        for (const auto& child : closing.children.at(first)) add(split(child, middle, point, true), first);
      continue;
    }
    bool moved = false;
    for (const int e : edges_within(cell[c], middle)) {
      const auto edge = cell[c].edge(e);
      moved =
          moved || !(point[at(middle.at(edge))] == geometry::midpoint(point[at(edge.first)], point[at(edge.second)]));
    }
    auto children = split(cell[c], middle, point, moved);
    if (children.size() == 1 && cell[c].lineage.is_removable() && broken.count(first) != 0)
      children.front().lineage = cell[c].lineage.broken();
    add(children, id);
  }
  return offspring;
}

/// New numbers of all nodes: old ones keep theirs; new ones by the lowest old cell at their edge, then by the edge's
/// number in it.
std::vector<GlobalId> number_nodes(const std::vector<Piece>& cell, std::size_t n_old, const ReferenceClosing& closing) {
  std::vector<GlobalId> to_final(closing.point.size(), invalid_global);
  GlobalId next = 0;
  for (std::size_t i = 0; i < n_old; ++i) to_final[i] = next++;
  for (const auto& piece : cell)
    for (const int e : edges_within(piece, closing.marked)) {
      auto& number = to_final[at(closing.middle.at(piece.edge(e)))];
      if (number == invalid_global) number = next++;
    }
  if (next != static_cast<GlobalId>(to_final.size())) throw std::logic_error("a new node lies on no old cell's edge");
  return to_final;
}

/// A boundary face at an edge: its patch and its third corner.
struct FaceAtEdge {
  int patch = 0;
  GlobalId third = 0;
};

/// Where the middle of an edge goes that a face of a patch without a surface shares with one of `surface`: if they meet
/// at 40 degrees or more, onto the surface within the plane of that face.
geometry::Vec3 target_beside_face(geometry::Vec3 a, geometry::Vec3 b, geometry::Vec3 third,
                                  const geometry::Surface& surface) {
  if (geometry::lexicographically_less(b, a)) std::swap(a, b);
  const auto middle = midpoint(a, b), of_face = cross(b - a, third - a);
  const double cosine = std::abs(dot(of_face, surface.normal(middle))) / norm(of_face);
  const geometry::Plane plane(middle, of_face);
  std::vector<const geometry::Surface*> surfaces{&plane, &surface};
  if (cosine > std::cos(40 * std::numbers::pi / 180)) surfaces.erase(surfaces.begin());
  return geometry::project_onto_all(surfaces, middle).point;
}

/// Puts new nodes on edges in the boundary onto their surfaces. Returns the largest move over its edge's length.
double project(const std::vector<Piece>& cell, const std::vector<const geometry::Surface*>& surface_of_patch,
               const ReferenceClosing& closing, Points& point) {
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
  double largest = 0;
  for (const auto& edge : closing.marked) {
    std::vector<const geometry::Surface*> surfaces;
    std::optional<GlobalId> third;  // of a face without surface
    auto at_edge = faces[edge];
    std::sort(at_edge.begin(), at_edge.end(), [](const auto& a, const auto& b) { return a.patch < b.patch; });
    for (const auto& face : at_edge) {
      const auto* surface = surface_of_patch[at(face.patch)];
      if (surface == nullptr)
        third = face.third;
      else if (std::find(surfaces.begin(), surfaces.end(), surface) == surfaces.end())
        surfaces.push_back(surface);
    }
    if (surfaces.empty()) continue;
    auto& p = point[at(closing.middle.at(edge))];
    const auto a = point[at(edge.first)], b = point[at(edge.second)];
    const auto target = third ? target_beside_face(a, b, point[at(*third)], *surfaces.front())
                              : geometry::project_onto_all(surfaces, p).point;
    const double length = norm(a - b);
    largest = std::max(largest, norm(target - p) / length);
    p = target;
  }
  return largest;
}

/// Smallest barycentric coordinate of a point in a cell.
double depth_in(const geometry::TetPoints& p, geometry::Vec3 x) {
  double least = 1;
  for (std::size_t i = 0; i < 4; ++i) {
    auto q = p;
    q[i] = x;
    least = std::min(least, geometry::volume(q) / geometry::volume(p));
  }
  return least;
}

/// The old cell that holds the centroid of each new one: to rounding, and the first of several.
std::vector<GlobalId> find_parents(const Offspring& offspring, const ReferenceClosing& closing) {
  std::vector<GlobalId> parents;
  for (std::size_t c = 0; c < offspring.piece.size(); ++c) {
    GlobalId parent = offspring.from[c];
    if (const auto found = closing.family.find(parent); found != closing.family.end()) {
      const auto p = points_of(offspring.piece[c], closing.point);
      const auto centroid = 0.25 * (p[0] + p[1] + p[2] + p[3]);
      const auto& members = found->second.member;
      std::vector<double> depth;
      for (const auto& member : members) depth.push_back(depth_in(points_of(member, closing.point), centroid));
      auto holds = std::find_if(depth.begin(), depth.end(), [](double d) { return d >= -0x1p-40; });
      if (holds == depth.end()) holds = std::max_element(depth.begin(), depth.end());
      parent += holds - depth.begin();
    }
    parents.push_back(parent);
  }
  return parents;
}

/// Neighbors by a map of faces; a face of one cell has the patch that it inherited, and no other face has one.
void link(const std::vector<Piece>& piece, mesh::BlockMesh& mesh) {
  mesh.cell_to_cell = reference_neighbors(mesh.cell_to_node);
  for (std::size_t c = 0; c < piece.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const bool is_outside = mesh.cell_to_cell[c][f] < 0;
      if (is_outside != (piece[c].patch[f] >= 0)) throw std::logic_error("a hanging node, or a patch inside the mesh");
      if (is_outside) mesh.cell_to_cell[c][f] = -(piece[c].patch[f] + 1);
    }
}

}  // namespace

ReferenceRefinement reference_refine(const mesh::BlockMesh& whole, const std::vector<std::uint8_t>& flags,
                                     refine::QualityControl policy,
                                     const std::vector<const geometry::Surface*>& surface_of_patch) {
  const auto cell = pieces_of(whole);
  const auto closing = reference_close(cell, whole.node_position, flags, policy);
  auto point = closing.point;
  ReferenceRefinement result;
  if (!surface_of_patch.empty()) result.largest_move = project(cell, surface_of_patch, closing, point);
  auto offspring = split_all(cell, closing, point);
  result.is_positive = all_positive(offspring.piece, point);
  result.families_rebuilt = static_cast<std::int64_t>(closing.family.size());
  result.families_kept = closing.families_kept;
  result.parent = find_parents(offspring, closing);

  const auto to_final = number_nodes(cell, whole.node_position.size(), closing);
  auto& mesh = result.mesh;
  mesh.info = whole.info;
  mesh.node_position.resize(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) mesh.node_position[at(to_final[i])] = point[i];
  for (auto& piece : offspring.piece) {
    for (auto& node : piece.corner) node = to_final[at(node)];
    mesh.cell_to_node.push_back(piece.corner);
    mesh.lineage.push_back(piece.lineage);
  }
  mesh.info.n_global_nodes = static_cast<GlobalId>(point.size());
  mesh.info.n_global_cells = static_cast<GlobalId>(mesh.cell_to_node.size());
  link(offspring.piece, mesh);
  return result;
}

}  // namespace pamr::test
