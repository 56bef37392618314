// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/find_wall_ears.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "meshing/repair/split_cells.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;
using Edge = std::array<GlobalId, 2>;
using Face = std::array<GlobalId, 3>;

constexpr double look_ahead = 0.01;  ///< where along an edge the wall's normal is asked for
constexpr double min_cosine = 0.95;  ///< between the normals along two edges of one smooth wall

/// The curved surfaces of a mesh, and which of them each patch lies on.
struct Walls {
  std::vector<const geometry::Surface*> curved;
  std::vector<int> of_patch;              ///< entry of `curved`, -1: none
  std::vector<std::uint8_t> is_periodic;  ///< by patch

  /// Of a patch, or of `inner_face`: none.
  int wall_of(int patch) const { return patch == inner_face ? -1 : of_patch[at(patch)]; }
  /// True when a new node in a face of this patch, between its nodes, changes neither the shape nor the match of sides.
  bool takes_nodes(int patch) const { return of_patch[at(patch)] < 0 && is_periodic[at(patch)] == 0; }
};

Walls curved_walls(const mesh::MeshInfo& info) {
  Walls walls;
  for (const auto& patch : info.patches) {
    walls.is_periodic.push_back(patch.kind == mesh::periodic_kind ? 1 : 0);
    const auto* surface = info.surfaces->get(patch.surface);
    if (surface == nullptr || surface->is_flat()) {
      walls.of_patch.push_back(-1);
      continue;
    }
    const auto known = std::find(walls.curved.begin(), walls.curved.end(), surface);
    walls.of_patch.push_back(static_cast<int>(known - walls.curved.begin()));
    if (known == walls.curved.end()) walls.curved.push_back(surface);
  }
  return walls;
}

Edge edge_of(GlobalId a, GlobalId b) { return {std::min(a, b), std::max(a, b)}; }

std::array<LocalId, 3> nodes_of_face(const mesh::DistMesh& mesh, LocalId cell, std::size_t slot) {
  const auto& corner = mesh::tet::face_to_corner[slot];
  const auto& node = mesh.cell_to_node[at(cell)];
  return {node[at(corner[0])], node[at(corner[1])], node[at(corner[2])]};
}

/// Calls `visit(cell, slot, patch)` for each face with a patch, in the boundary or inside, once on all ranks; or for
/// each one without, once on this rank, `patch` being `inner_face`.
template <class Visit>
void for_each_face(const mesh::DistMesh& mesh, bool has_patch, Visit&& visit) {
  const mesh::InnerPatches inner(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto next = mesh.cell_to_cell[at(c)][slot];
      const mesh::CellFace face{c, static_cast<int>(slot)};
      const int patch = inner.of_any(face);
      if (has_patch != (patch != inner_face)) continue;
      if (next < 0 || (has_patch ? inner.is_first_side(face) : next > c)) visit(c, slot, patch);
    }
}

/// The walls that each node lies on, as bits (walls beyond 64 share bits: this is a first filter). Collective.
std::vector<std::uint64_t> walls_of_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const Walls& walls) {
  std::vector<std::uint64_t> bits(at(mesh.n_nodes()), 0);
  for_each_face(mesh, true, [&](LocalId c, std::size_t slot, int patch) {
    const int wall = walls.of_patch[at(patch)];
    if (wall < 0) return;
    for (const auto node : nodes_of_face(mesh, c, slot)) bits[at(node)] |= std::uint64_t{1} << (at(wall) % 64);
  });
  const auto borders = mesh::find_borders(comm, mesh);
  par::fold_shared(par::Exchange(comm, borders.nodes), bits,
                   [](std::uint64_t& mine, std::uint64_t theirs) { mine |= theirs; });
  return bits;
}

/// For the edges asked about: whether they lie in a patch, whether one of its faces takes no new nodes, and in which
/// walls they lie.
class EdgeTable {
 public:
  EdgeTable(const par::Comm& comm, const mesh::DistMesh& mesh, const Walls& walls, std::vector<Edge> asked)
      : edge_(std::move(asked)), width_(first_wall + walls.curved.size()), flag_(edge_.size() * width_, 0) {
    std::vector<GlobalId> ends;
    for (const auto& edge : edge_) ends.insert(ends.end(), edge.begin(), edge.end());
    std::sort(ends.begin(), ends.end());
    std::vector<std::uint8_t> is_end;
    for (const auto id : mesh.node_global) is_end.push_back(std::binary_search(ends.begin(), ends.end(), id) ? 1 : 0);
    for_each_face(mesh, true, [&](LocalId c, std::size_t slot, int patch) {
      const auto wall = walls.of_patch[at(patch)];
      const auto node = nodes_of_face(mesh, c, slot);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = node[k], b = node[(k + 1) % 3];
        if (is_end[at(a)] == 0 || is_end[at(b)] == 0) continue;
        const auto row = find(edge_of(mesh.node_global[at(a)], mesh.node_global[at(b)]));
        if (!row) continue;
        flag_[*row * width_] = 1;
        if (!walls.takes_nodes(patch)) flag_[*row * width_ + 1] = 1;
        if (wall >= 0) flag_[*row * width_ + first_wall + at(wall)] = 1;
      }
    });
    comm.sum_in_place(flag_);
  }

  bool is_in_patch(Edge edge) const { return flag_[*find(edge) * width_] > 0; }
  bool takes_nodes(Edge edge) const { return flag_[*find(edge) * width_ + 1] == 0; }
  bool is_in_wall(Edge edge, std::size_t wall) const { return flag_[*find(edge) * width_ + first_wall + wall] > 0; }

 private:
  std::optional<std::size_t> find(Edge edge) const {
    const auto row = std::lower_bound(edge_.begin(), edge_.end(), edge);
    if (row == edge_.end() || *row != edge) return std::nullopt;
    return at(row - edge_.begin());
  }

  static constexpr std::size_t first_wall = 2;  ///< column

  std::vector<Edge> edge_;
  std::size_t width_;
  std::vector<std::int64_t> flag_;
};

/// An ear, and how to take it away: the edge to split, or twice -1 where the face itself is to be.
struct Found {
  Face face;
  Edge edge{-1, -1};
};

/// True when the edges from `a` to `c` and to `d` run into one smooth part of the surface.
bool is_smooth(const geometry::Surface& surface, Vec3 a, Vec3 c, Vec3 d) {
  return geometry::dot(surface.normal(a + look_ahead * (c - a)), surface.normal(a + look_ahead * (d - a))) > min_cosine;
}

/// A face with three nodes on a curved wall, and its patch; `inner_face`: none.
struct Candidate {
  std::array<LocalId, 3> node;
  int patch = inner_face;
};

std::optional<Found> classify(const mesh::DistMesh& mesh, const Walls& walls, const EdgeTable& table,
                              const Candidate& face) {
  const bool is_inner = face.patch == inner_face;
  const int own_wall = walls.wall_of(face.patch);
  Found found;
  for (std::size_t k = 0; k < 3; ++k) found.face[k] = mesh.node_global[at(face.node[k])];
  const auto id = found.face;
  std::sort(found.face.begin(), found.face.end());
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = (k + 1) % 3, j = (k + 2) % 3;
    for (std::size_t wall = 0; wall < walls.curved.size(); ++wall) {
      if (static_cast<int>(wall) == own_wall || !table.is_in_wall(edge_of(id[k], id[i]), wall) ||
          !table.is_in_wall(edge_of(id[k], id[j]), wall) ||
          !is_smooth(*walls.curved[wall], mesh.point(face.node[k]), mesh.point(face.node[i]), mesh.point(face.node[j])))
        continue;
      const auto opposite = edge_of(id[i], id[j]);
      if (is_inner ? !table.is_in_patch(opposite) : table.takes_nodes(opposite)) found.edge = opposite;
      return found;
    }
  }
  return std::nullopt;
}

template <class T>
void sort_unique(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace

WallEars find_wall_ears(const par::Comm& comm, const mesh::DistMesh& mesh) {
  WallEars ears;
  const auto walls = curved_walls(mesh.info);
  if (walls.curved.empty()) return ears;

  const auto bits = walls_of_nodes(comm, mesh, walls);
  std::vector<Candidate> candidates;
  std::vector<Edge> asked;
  const auto look_at = [&](const Candidate& face) {
    const auto& node = face.node;
    const int wall = walls.wall_of(face.patch);
    const auto own = wall < 0 ? 0 : std::uint64_t{1} << (at(wall) % 64);
    if ((bits[at(node[0])] & bits[at(node[1])] & bits[at(node[2])] & ~own) == 0) return;
    candidates.push_back(face);
    for (std::size_t k = 0; k < 3; ++k)
      asked.push_back(edge_of(mesh.node_global[at(node[k])], mesh.node_global[at(node[(k + 1) % 3])]));
  };
  for (const bool has_patch : {false, true})
    for_each_face(mesh, has_patch, [&](LocalId c, std::size_t slot, int patch) {
      look_at({nodes_of_face(mesh, c, slot), patch});
    });
  sort_unique(asked);
  asked = gather_few(comm, std::move(asked));
  sort_unique(asked);
  const EdgeTable table(comm, mesh, walls, std::move(asked));

  std::vector<Found> found;
  std::vector<Face> inside;
  for (const auto& face : candidates) {
    const auto ear = classify(mesh, walls, table, face);
    if (!ear) continue;
    if (face.patch == inner_face)
      inside.push_back(ear->face);
    else
      ++ears.n_at_rims;
    if (face.patch == inner_face || walls.takes_nodes(face.patch))
      found.push_back(*ear);
    else
      ++ears.n_left;
  }
  ears.n_at_rims = comm.sum(ears.n_at_rims);
  ears.n_left = comm.sum(ears.n_left);
  inside = gather_few(comm, std::move(inside));
  sort_unique(inside);  // one on a rank border comes from both sides
  ears.n_inside = std::ssize(inside);
  found = gather_few(comm, std::move(found));
  for (const auto& ear : found)
    if (ear.edge[0] >= 0)
      ears.edge.push_back(ear.edge);
    else
      ears.face.push_back(ear.face);
  sort_unique(ears.edge);
  sort_unique(ears.face);
  return ears;
}

}  // namespace pamr::meshing
