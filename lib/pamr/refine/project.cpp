// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/project.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::refine {

namespace {

constexpr double max_off_face = 1e-10;  ///< of its edge, what a node may seem to be off a face that it lies in

bool all_flat(const std::vector<const geometry::Surface*>& surfaces) {
  return std::all_of(surfaces.begin(), surfaces.end(), [](const auto* s) { return s->is_flat(); });
}

Movable aim(LocalId node, geometry::Vec3 base, const PatchList& patch, const SurfacesOfNode& on) {
  const auto projected = on.place(base);
  return {node, base, projected.converged ? projected.point : base, patch, projected.converged};
}

/// Third corners of the two boundary faces at a new node, and the patches of the faces.
struct OppositeVertices {
  std::array<geometry::Vec3, 2> corner{};
  std::array<int, 2> patch{-1, -1};
  int count = 0;
  void add(geometry::Vec3 p, int of_patch) {
    if (count == 2) return;
    corner[at(count)] = p;
    patch[at(count++)] = of_patch;
  }
  const geometry::Vec3* find(int of_patch) const {
    const auto found = std::find(patch.begin(), patch.end(), of_patch);
    return found == patch.end() ? nullptr : &corner[at(found - patch.begin())];
  }
};

/// The patches whose faces decide where a new node belongs: those with sharp edges inside their surface, and those
/// without a surface that meet others with one that is curved. Collective.
std::vector<bool> patches_to_look_at(const par::Comm& comm, const Walls& walls, const Numbering& numbering) {
  std::vector<const geometry::Surface*> surface;
  for (const auto& patch : walls.info.patches) surface.push_back(walls.surfaces.get(patch.surface));
  std::vector<std::int64_t> is_wanted(surface.size(), 0);
  bool any_without = false, any_curved = false;
  for (std::size_t p = 0; p < surface.size(); ++p) {
    is_wanted[p] = surface[p] != nullptr && surface[p]->creases() != nullptr ? 1 : 0;
    any_without = any_without || surface[p] == nullptr;
    any_curved = any_curved || (surface[p] != nullptr && !surface[p]->is_flat());
  }
  if (any_without && any_curved) {
    for (const auto& [new_node, patches] : numbering.boundary) {
      const auto is_curved = [&](int p) { return p >= 0 && surface[at(p)] != nullptr && !surface[at(p)]->is_flat(); };
      if (std::none_of(patches.begin(), patches.end(), is_curved)) continue;
      for (const int p : patches)
        if (p >= 0 && surface[at(p)] == nullptr) is_wanted[at(p)] = 1;
    }
    comm.max_in_place(is_wanted);
  }
  std::vector<bool> result;
  for (const auto value : is_wanted) result.push_back(value != 0);
  return result;
}

/// For each entry of `numbering.boundary` the faces of the given patches at it, those of all ranks. Collective.
std::vector<OppositeVertices> find_opposite_vertices(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                     const mesh::Borders& borders, const Numbering& numbering,
                                                     const std::vector<bool>& is_wanted) {
  std::vector<OppositeVertices> opposite(numbering.boundary.size());
  const auto entry_of = [&](LocalId cell, int edge) -> OppositeVertices* {
    if (numbering.row[at(cell)] < 0 || numbering.midpoint(cell, edge) == invalid_local) return nullptr;
    const LocalId node = numbering.midpoint(cell, edge) - mesh.n_nodes();
    const auto found = std::lower_bound(numbering.boundary.begin(), numbering.boundary.end(), node,
                                        [](const BoundaryNode& b, LocalId n) { return b.new_node < n; });
    if (found == numbering.boundary.end() || found->new_node != node) return nullptr;
    return &opposite[at(found - numbering.boundary.begin())];
  };
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (numbering.row[at(c)] < 0) continue;
    for (int f = 0; f < 4; ++f) {
      const auto next = mesh.cell_to_cell[at(c)][at(f)];
      if (next >= 0 || !is_wanted[at(mesh::slot_to_patch(next))]) continue;
      const auto& corner = mesh::tet::face_to_corner[at(f)];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto edge = mesh::tet::edge_of[at(corner[(k + 1) % 3])][at(corner[(k + 2) % 3])];
        if (auto* entry = entry_of(c, edge))
          entry->add(mesh.point(mesh.cell_to_node[at(c)][at(corner[k])]), mesh::slot_to_patch(next));
      }
    }
  }
  const auto of_border = [&](LocalId item) {
    const auto arc = borders.arcs(at(item)).front();
    return entry_of(arc.cell, arc.edge);
  };
  par::fold_shared(
      par::Exchange(comm, borders.edges),
      [&](LocalId item) {
        const auto* entry = of_border(item);
        return entry == nullptr ? OppositeVertices{} : *entry;
      },
      [&](LocalId item, const OppositeVertices& theirs) {
        if (auto* entry = of_border(item))
          for (int i = 0; i < theirs.count; ++i) entry->add(theirs.corner[at(i)], theirs.patch[at(i)]);
      });
  return opposite;
}

/// A node that is as far from a sharp edge of its surface as `off_surface` says belongs on that edge.
bool is_of_crease(const SurfacesOfNode& on, const PatchList& patch, geometry::Vec3 point, double off) {
  if (patch[1] >= 0 || on.surface.front()->creases() == nullptr) return false;
  return off >= (1 - 1e-9) * geometry::norm(point - on.surface.front()->project_to_seam(point));
}

/// Where a patch without a surface meets another: on the other's surface and in the plane of the face a b c of the
/// patch without. Where the face continues the surface smoothly, that plane is no shape to keep.
Movable aim_beside_face(LocalId node, std::array<geometry::Vec3, 2> end, geometry::Vec3 third, const PatchList& patch,
                        const SurfacesOfNode& on) {
  // the same bits on every rank that has the edge
  if (geometry::lexicographically_less(end[1], end[0])) std::swap(end[0], end[1]);
  const auto base = geometry::midpoint(end[0], end[1]);
  const auto normal = cross(end[1] - end[0], third - end[0]);
  if (mesh::is_sharp_edge(end[0], end[1], third, *on.surface.front())) {
    const geometry::Plane of_face(base, normal);
    const std::array<const geometry::Surface*, 2> both{&of_face, on.surface.front()};
    const auto projected = geometry::project_onto_all(both, base);
    return {node,   base, projected.converged ? projected.point : base, patch, projected.converged, false, 0,
            normal, true};
  }
  auto movable = aim(node, base, patch, on);
  const double off = std::abs(dot(movable.target - base, normal)) / norm(normal);
  if (off > max_off_face * norm(end[1] - end[0])) movable.off_facets = off;
  movable.beside = normal;
  return movable;
}

/// Where a new node between these ends wants to go.
Movable aim_new_node(LocalId node, std::array<geometry::Vec3, 2> end, const PatchList& patch, const SurfacesOfNode& on,
                     const OppositeVertices& opposite) {
  const auto base = geometry::midpoint(end[0], end[1]);
  const auto* creases = on.surface.front()->creases();
  // both faces at a sharp edge inside a surface are of one patch
  if (patch[1] < 0 && creases != nullptr && opposite.count == 2)
    if (const auto crease = creases->crease_between(end[0], end[1], opposite.corner[0], opposite.corner[1]))
      return {node, base, *crease, patch, true, true};
  if (on.without_surface >= 0)
    if (const auto* third = opposite.find(on.without_surface)) return aim_beside_face(node, end, *third, patch, on);
  return aim(node, base, patch, on);
}

/// Adds the new nodes that the map of level 0 places, ascending.
void map_new_nodes(const mesh::DistMesh& mesh, const Numbering& numbering, std::vector<Movable>& movables) {
  const mesh::Level0View level0(mesh);
  if (level0.is_empty()) return;
  std::vector<LocalId> row_of_node;  // of the map; every cell at a node that the map moves has one
  assign_array(row_of_node, numbering.n_new_nodes(), invalid_local);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (numbering.row[at(c)] < 0) continue;
    const auto row = level0.row_of(c);
    if (row < 0) continue;
    for (const auto node : numbering.edge_to_node[at(numbering.row[at(c)])])
      if (node != invalid_local) row_of_node[at(node - mesh.n_nodes())] = row;
  }
  const auto n_without = std::count(row_of_node.begin(), row_of_node.end(), invalid_local);
  reserve_array(movables, movables.size() + row_of_node.size() - at(n_without));
  for (std::size_t i = 0; i < row_of_node.size(); ++i) {
    const auto row = row_of_node[i];
    if (row == invalid_local) continue;
    const auto [a, b] = numbering.ends[i];
    if (const auto placed = level0.place(row, mesh::middle(level0.weights(row, a), level0.weights(row, b))))
      movables.push_back({mesh.n_nodes() + static_cast<LocalId>(i), geometry::midpoint(mesh.point(a), mesh.point(b)),
                          placed->point, placed->patch, placed->is_reachable, placed->is_on_crease,
                          placed->off_facets});
  }
}

/// Adds the new nodes, ascending: those that the map places and others on the boundary.
void project_new_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                       const Numbering& numbering, const Walls& walls, std::vector<Movable>& movables) {
  const auto first = movables.size();
  map_new_nodes(mesh, numbering, movables);
  const auto end_of_mapped = movables.size();
  auto next = first;  // of those that are mapped
  const auto is_wanted = patches_to_look_at(comm, walls, numbering);
  std::vector<OppositeVertices> opposite;
  if (std::find(is_wanted.begin(), is_wanted.end(), true) != is_wanted.end())
    opposite = find_opposite_vertices(comm, mesh, borders, numbering, is_wanted);
  std::map<PatchList, SurfacesOfNode> surfaces_of;
  for (std::size_t i = 0; i < numbering.boundary.size(); ++i) {
    const auto& boundary = numbering.boundary[i];
    const auto node = mesh.n_nodes() + boundary.new_node;
    while (next < end_of_mapped && movables[next].node < node) ++next;
    if (next < end_of_mapped && movables[next].node == node) continue;
    const auto& patch = boundary.patch;
    auto known = surfaces_of.find(patch);
    if (known == surfaces_of.end())
      known = surfaces_of.emplace(patch, surfaces_of_node(walls.info, walls.surfaces, patch)).first;
    if (all_flat(known->second.surface)) continue;
    const auto [a, b] = numbering.ends[at(boundary.new_node)];
    movables.push_back(aim_new_node(node, {mesh.point(a), mesh.point(b)}, patch, known->second,
                                    opposite.empty() ? OppositeVertices{} : opposite[i]));
  }
  const auto begin = movables.begin();
  std::inplace_merge(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end_of_mapped),
                     movables.end(), [](const Movable& a, const Movable& b) { return a.node < b.node; });
}

/// The old nodes that are off their surfaces, ascending.
std::vector<Movable> project_off_surface(const par::Comm& comm, const mesh::DistMesh& mesh,
                                         const mesh::Borders& borders, const Walls& walls) {
  const auto* field = mesh.find_node_field(mesh::off_surface_field);
  if (field == nullptr || field->holds_integers()) return {};
  const auto& off = field->real();
  std::map<LocalId, PatchList> patches;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node)
    if (off[at(node)] > 0) patches[node].fill(-1);
  mesh::add_patches_of_nodes(comm, mesh, borders, patches);
  std::vector<Movable> movables;
  for (const auto& [node, patch] : patches) {
    const auto on = surfaces_of_node(walls.info, walls.surfaces, patch);
    if (on.surface.empty()) continue;
    const auto here = mesh.point(node);
    if (is_of_crease(on, patch, here, off[at(node)]))
      movables.push_back({node, here, on.surface.front()->project_to_seam(here), patch, true, true});
    else
      movables.push_back(aim(node, here, patch, on));
    if (on.without_surface >= 0) movables.back().off_facets = geometry::norm(movables.back().target - here);
  }
  return movables;
}

}  // namespace

std::vector<Movable> project(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                             const Numbering& numbering, const Walls& walls) {
  auto movables = project_off_surface(comm, mesh, borders, walls);
  project_new_nodes(comm, mesh, borders, numbering, walls, movables);
  return movables;
}

}  // namespace pamr::refine
