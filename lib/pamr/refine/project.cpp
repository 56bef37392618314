// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/project.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

namespace {

bool all_flat(const std::vector<const geometry::Surface*>& surfaces) {
  return std::all_of(surfaces.begin(), surfaces.end(), [](const auto* s) { return s->is_flat(); });
}

Movable aim(LocalId node, geometry::Vec3 base, const PatchList& patch, const SurfacesOfNode& on) {
  const auto projected = on.place(base);
  return {node, base, projected.converged ? projected.point : base, patch, projected.converged};
}

/// Adds a patch to an ascending list without repeats; a fifth patch at one node is dropped.
void add_patch(PatchList& list, int patch) {
  if (patch < 0 || std::find(list.begin(), list.end(), patch) != list.end()) return;
  const auto free = std::find(list.begin(), list.end(), -1);
  if (free == list.end()) return;
  *free = patch;
  std::sort(list.begin(), free + 1);
}

/// Third corners of the two boundary faces at a new node.
struct Wings {
  std::array<geometry::Vec3, 2> corner{};
  int count = 0;
  void add(geometry::Vec3 p) {
    if (count < 2) corner[at(count++)] = p;
  }
};

/// The patches whose surfaces have sharp edges inside.
std::vector<bool> patches_with_creases(const mesh::MeshInfo& info, const geometry::SurfaceSet& surfaces) {
  std::vector<bool> has(info.patches.size(), false);
  for (std::size_t p = 0; p < has.size(); ++p)
    if (const auto* surface = surfaces.get(info.patches[p].surface)) has[p] = surface->creases() != nullptr;
  return has;
}

/// For each entry of `numbering.boundary` the faces of the given patches at it, those of all ranks. Collective.
std::vector<Wings> find_wings(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                              const Numbering& numbering, const std::vector<bool>& is_wanted) {
  std::vector<Wings> wings(numbering.boundary.size());
  const auto entry_of = [&](LocalId cell, int edge) -> Wings* {
    if (numbering.row[at(cell)] < 0 || numbering.midpoint(cell, edge) == invalid_local) return nullptr;
    const LocalId node = numbering.midpoint(cell, edge) - mesh.n_nodes();
    const auto found = std::lower_bound(numbering.boundary.begin(), numbering.boundary.end(), node,
                                        [](const BoundaryNode& b, LocalId n) { return b.new_node < n; });
    if (found == numbering.boundary.end() || found->new_node != node) return nullptr;
    return &wings[at(found - numbering.boundary.begin())];
  };
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (numbering.row[at(c)] < 0) continue;
    for (int f = 0; f < 4; ++f) {
      const auto next = mesh.cell_to_cell[at(c)][at(f)];
      if (next >= 0 || !is_wanted[at(mesh::slot_to_patch(next))]) continue;
      const auto& corner = mesh::tet::face_to_corner[at(f)];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto edge = mesh::tet::edge_of[at(corner[(k + 1) % 3])][at(corner[(k + 2) % 3])];
        if (auto* entry = entry_of(c, edge)) entry->add(mesh.point(mesh.cell_to_node[at(c)][at(corner[k])]));
      }
    }
  }
  std::vector<Wings> mine;
  const auto of_border = [&](LocalId item) {
    const auto arc = borders.arcs(at(item)).front();
    return entry_of(arc.cell, arc.edge);
  };
  for (const auto item : borders.edges.item) {
    const auto* entry = of_border(item);
    mine.push_back(entry == nullptr ? Wings{} : *entry);
  }
  const auto theirs = par::Exchange(comm, borders.edges).swap<Wings>(mine);
  for (std::size_t k = 0; k < theirs.size(); ++k)
    if (auto* entry = of_border(borders.edges.item[k]))
      for (int i = 0; i < theirs[k].count; ++i) entry->add(theirs[k].corner[at(i)]);
  return wings;
}

/// A node of the ledger that is as far from a sharp edge of its surface as the ledger says belongs on that edge.
bool is_of_crease(const SurfacesOfNode& on, const PatchList& patch, geometry::Vec3 point, double off) {
  if (patch[1] >= 0 || on.surface.front()->creases() == nullptr) return false;
  return off >= (1 - 1e-9) * geometry::norm(point - on.surface.front()->project_to_seam(point));
}

}  // namespace

SurfacesOfNode surfaces_of_node(const mesh::MeshInfo& info, const geometry::SurfaceSet& surfaces,
                                const PatchList& patch) {
  SurfacesOfNode on;
  on.all_tied = true;
  for (const auto p : patch) {
    if (p < 0) continue;
    const auto* surface = surfaces.get(info.patches[at(p)].surface);
    if (surface == nullptr)
      on.all_tied = false;
    else if (std::find(on.surface.begin(), on.surface.end(), surface) == on.surface.end())
      on.surface.push_back(surface);
  }
  on.is_on_seam = patch[1] >= 0 && patch[2] < 0 &&
                  info.patches[at(patch[0])].surface == info.patches[at(patch[1])].surface && !on.surface.empty();
  return on;
}

PatchList patches_of(const BoundaryNode& boundary) {
  return {boundary.patch[0], boundary.patch[1] == boundary.patch[0] ? -1 : boundary.patch[1], -1, -1};
}

std::vector<Movable> project_new_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                       const Numbering& numbering, const geometry::SurfaceSet& surfaces) {
  const auto has_creases = patches_with_creases(mesh.info, surfaces);
  std::vector<Wings> wings;
  if (std::find(has_creases.begin(), has_creases.end(), true) != has_creases.end())
    wings = find_wings(comm, mesh, borders, numbering, has_creases);
  std::vector<Movable> movables;
  std::map<std::array<int, 2>, SurfacesOfNode> surfaces_of_pair;
  for (std::size_t i = 0; i < numbering.boundary.size(); ++i) {
    const auto& boundary = numbering.boundary[i];
    const auto patch = patches_of(boundary);
    auto known = surfaces_of_pair.find(boundary.patch);
    if (known == surfaces_of_pair.end())
      known = surfaces_of_pair.emplace(boundary.patch, surfaces_of_node(mesh.info, surfaces, patch)).first;
    if (all_flat(known->second.surface)) continue;
    const auto [a, b] = numbering.ends[at(boundary.new_node)];
    const LocalId node = mesh.n_nodes() + boundary.new_node;
    const auto base = geometry::midpoint(mesh.point(a), mesh.point(b));
    const auto* creases = known->second.surface.front()->creases();
    if (patch[1] < 0 && creases != nullptr && wings[i].count == 2)  // a crease inside a patch parts no patches
      if (const auto crease =
              creases->crease_between(mesh.point(a), mesh.point(b), wings[i].corner[0], wings[i].corner[1])) {
        movables.push_back({node, base, *crease, patch, true, true});
        continue;
      }
    movables.push_back(aim(node, base, patch, known->second));
  }
  return movables;
}

std::vector<Movable> project_ledger(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                    const geometry::SurfaceSet& surfaces) {
  const auto* ledger = mesh.find_node_field(ledger_field);
  if (ledger == nullptr || ledger->holds_integers()) return {};
  const auto& off = ledger->real();
  std::map<LocalId, PatchList> patches;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node)
    if (off[at(node)] > 0) patches[node].fill(-1);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto next = mesh.cell_to_cell[at(c)][at(f)];
      if (next >= 0) continue;
      for (const auto corner : mesh::tet::face_to_corner[at(f)]) {
        const auto entry = patches.find(mesh.cell_to_node[at(c)][at(corner)]);
        if (entry != patches.end()) add_patch(entry->second, mesh::slot_to_patch(next));
      }
    }
  std::vector<PatchList> mine;
  for (const auto node : borders.nodes.item) {
    const auto entry = patches.find(node);
    mine.push_back(entry == patches.end() ? PatchList{-1, -1, -1, -1} : entry->second);
  }
  const auto theirs = par::Exchange(comm, borders.nodes).swap<PatchList>(mine);
  for (std::size_t k = 0; k < theirs.size(); ++k) {
    const auto entry = patches.find(borders.nodes.item[k]);
    if (entry == patches.end()) continue;
    for (const auto patch : theirs[k]) add_patch(entry->second, patch);
  }
  std::vector<Movable> movables;
  for (const auto& [node, patch] : patches) {
    const auto on = surfaces_of_node(mesh.info, surfaces, patch);
    if (on.surface.empty()) continue;
    const auto here = mesh.point(node);
    if (is_of_crease(on, patch, here, off[at(node)]))
      movables.push_back({node, here, on.surface.front()->project_to_seam(here), patch, true, true});
    else
      movables.push_back(aim(node, here, patch, on));
  }
  return movables;
}

}  // namespace pamr::refine
