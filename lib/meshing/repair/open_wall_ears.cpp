// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/open_wall_ears.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "meshing/repair/improve_nodes.hpp"
#include "meshing/repair/split_cells.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;

/// The blocks of the mesh with `splits` applied; `children` of the old cells in their order. `patch`: of the faces of
/// this rank's new cells, in their order. Collective.
mesh::BlockMesh to_block(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Split>& splits,
                         const std::map<GlobalId, std::vector<CellPart>>& children,
                         std::vector<std::array<int, 4>>& patch) {
  mesh::BlockMesh block;
  block.info = mesh.info;
  block.info.n_global_nodes += static_cast<GlobalId>(splits.size());
  const mesh::InnerPatches inner_patches(mesh);
  std::vector<LocalId> parent;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto found = children.find(mesh.cell_global[at(c)]);
    if (found != children.end()) {
      for (const auto& child : found->second) {
        parent.push_back(c);
        block.cell_to_node.push_back(child.node);
        patch.push_back(child.patch);
      }
      continue;
    }
    parent.push_back(c);
    auto& node = block.cell_to_node.emplace_back();
    auto& patches = patch.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      node[k] = mesh.node_global[at(mesh.cell_to_node[at(c)][k])];
      patches[k] = inner_patches.of_any({c, static_cast<int>(k)});
    }
  }
  const auto n_cells = static_cast<std::int64_t>(parent.size());
  block.info.n_global_cells = comm.sum(n_cells);
  block.first_cell = mesh.info.first_id + comm.exclusive_sum(n_cells);
  for (const auto& field : mesh.cell_fields) {
    if (mesh::is_inner_patch_field(field)) continue;  // made anew from `patch`
    auto& copy = block.cell_fields.emplace_back(field);
    std::visit(
        [&](auto& values) {
          const auto old = values;
          values.clear();
          for (const auto c : parent)
            for (int k = 0; k < field.n_components; ++k) values.push_back(old[at(c * field.n_components + k)]);
        },
        copy.value);
  }
  return block;
}

/// Positions and node fields in canonical blocks; new nodes get the mean of the nodes that they lie between, of
/// integers that of the first one. Collective.
void scatter_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Split>& splits,
                   mesh::BlockMesh& block) {
  std::map<GlobalId, LocalId> local;
  for (const auto& split : splits)
    for (std::size_t k = 0; k < split.n_nodes(); ++k) local[split.node[k]] = -1;
  for (LocalId n = 0; n < mesh.n_nodes(); ++n)
    if (const auto entry = local.find(mesh.node_global[at(n)]); entry != local.end()) entry->second = n;
  auto ids = mesh.node_global;
  auto position = mesh.node_position;
  std::vector<std::size_t> known;  // splits whose nodes this rank holds
  for (std::size_t s = 0; s < splits.size(); ++s) {
    bool has_all = true;
    for (std::size_t k = 0; k < splits[s].n_nodes(); ++k) has_all = has_all && local.at(splits[s].node[k]) >= 0;
    if (!has_all) continue;
    known.push_back(s);
    ids.push_back(mesh.info.node_ids().end() + static_cast<GlobalId>(s));
    position.push_back(splits[s].point);
  }
  block.node_position = par::scatter_rows<Vec3>(comm, block.info.node_ids(), position, 1, ids);
  for (const auto& field : mesh.node_fields) {
    auto& copy = block.node_fields.emplace_back(field);
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          const auto width = at(field.n_components);
          for (const auto s : known) {
            const auto& split = splits[s];
            for (std::size_t k = 0; k < width; ++k) {
              T sum{};
              for (std::size_t i = 0; i < split.n_nodes(); ++i)
                sum += values[at(local.at(split.node[i])) * width + k] / static_cast<T>(split.n_nodes());
              if (field.holds_integers()) sum = values[at(local.at(split.node[0])) * width + k];
              if (field.name == mesh::off_surface_field) sum = T{};  // not a node of the wall
              values.push_back(sum);
            }
          }
          values = par::scatter_rows<T>(comm, block.info.node_ids(), values, width, ids);
        },
        copy.value);
  }
}

/// Gives faces their patches; neighbors were built without them.
void name_patches(const std::vector<std::array<int, 4>>& patch, bool has_inner_patches, mesh::DistMesh& mesh) {
  PAMR_ENSURES(patch.size() == mesh.cell_to_cell.size());
  auto* word = has_inner_patches ? &mesh::make_inner_patches(mesh) : nullptr;
  for (std::size_t c = 0; c < patch.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      auto& next = mesh.cell_to_cell[c][k];
      const bool has_patch = patch[c][k] != inner_face;
      PAMR_ENSURES(next < 0 ? has_patch : !has_patch || word != nullptr);
      if (next < 0)
        next = mesh::patch_to_slot(patch[c][k]);
      else if (has_patch)
        (*word)[c] = mesh::with_inner_patch((*word)[c], static_cast<int>(k), patch[c][k]);
    }
}

/// The faces that keep their shape: between regions, and those inside with a patch. Collective.
std::vector<mesh::RegionFace> fixed_faces(const par::Comm& comm, const mesh::DistMesh& mesh) {
  auto faces = mesh::faces_between_regions(comm, mesh);
  mesh::InnerPatches(mesh).for_each([&](mesh::CellFace face, int) { faces.push_back({face, {}}); });
  return faces;
}

/// True when no field would have to follow nodes that move.
bool has_no_values(const mesh::DistMesh& mesh) {
  return std::all_of(mesh.node_fields.begin(), mesh.node_fields.end(),
                     [](const auto& field) { return field.name == mesh::off_surface_field; });
}

/// The splits of edges and faces neither between regions nor in the boundary, by number: their new nodes may move.
/// Collective.
std::vector<std::size_t> free_splits(const par::Comm& comm, const mesh::DistMesh& mesh,
                                     const std::vector<mesh::RegionFace>& between, const std::vector<Split>& splits) {
  using Nodes = std::array<GlobalId, 3>;
  const auto key = [](Nodes node) {
    std::sort(node.begin(), node.end());
    return node;
  };
  std::map<Nodes, std::size_t> number;
  for (std::size_t s = 0; s < splits.size(); ++s) number.emplace(key(splits[s].node), s);
  std::vector<std::int64_t> is_fixed(splits.size(), 0);
  const auto mark = [&](const Nodes& node) {
    if (const auto found = number.find(key(node)); found != number.end()) is_fixed[found->second] = 1;
  };
  const auto mark_face = [&](LocalId cell, std::size_t slot) {
    Nodes node{};
    for (std::size_t k = 0; k < 3; ++k)
      node[k] = mesh.node_global[at(mesh.cell_to_node[at(cell)][at(mesh::tet::face_to_corner[slot][k])])];
    mark(node);
    for (std::size_t k = 0; k < 3; ++k) mark({node[k], node[(k + 1) % 3], -1});
  };
  for (const auto& [face, regions] : between) mark_face(face.cell, at(face.slot));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (mesh.cell_to_cell[at(c)][slot] < 0) mark_face(c, slot);
  comm.max_in_place(is_fixed);
  std::vector<std::size_t> free;
  for (std::size_t s = 0; s < splits.size(); ++s)
    if (is_fixed[s] == 0) free.push_back(s);
  return free;
}

/// Where the new nodes of `free` splits are best, and those of `inner` (ascending) near poor cells: put into `splits`
/// and the mesh.
void improve(mesh::DistMesh& mesh, const std::map<GlobalId, std::vector<CellPart>>& children,
             const std::vector<GlobalId>& inner, GlobalId first_new, const std::vector<std::size_t>& free,
             std::vector<Split>& splits) {
  std::vector<CellPart> parts;
  for (const auto& [cell, of_cell] : children) parts.insert(parts.end(), of_cell.begin(), of_cell.end());
  std::map<GlobalId, Vec3> point;
  for (const auto& part : parts)
    for (std::size_t k = 0; k < 4; ++k) point[part.node[k]] = part.point[k];
  std::vector<MovableNode> nodes;
  for (const auto s : free) nodes.push_back({first_new + static_cast<GlobalId>(s), splits[s].point, true});
  for (const auto node : inner) nodes.push_back({node, point.at(node), false});
  nodes = improve_nodes(mesh.info, std::move(nodes), parts);

  for (std::size_t i = 0; i < free.size(); ++i) splits[free[i]].point = nodes[i].point;
  for (std::size_t n = 0; n < mesh.node_position.size(); ++n) {
    const auto found = std::lower_bound(inner.begin(), inner.end(), mesh.node_global[n]);
    if (found != inner.end() && *found == mesh.node_global[n])
      mesh.node_position[n] = nodes[free.size() + at(found - inner.begin())].point;
  }
}

}  // namespace

mesh::DistMesh open_wall_ears(const par::Comm& comm, mesh::DistMesh mesh, const WallEars& ears) {
  if (!ears.can_be_opened()) return mesh;
  std::vector<Split> splits;
  for (const auto& edge : ears.edge) splits.push_back({{edge[0], edge[1], -1}, 0, {}});
  for (const auto& face : ears.face) splits.push_back({face, 0, {}});
  auto cells = cells_to_split(comm, mesh, splits);
  splits = placed_in_order(cells, std::move(splits));
  const auto between = fixed_faces(comm, mesh);
  const bool has_inner_patches = mesh.find_cell_field(mesh::inner_patch_field) != nullptr;
  std::vector<GlobalId> inner;
  if (has_no_values(mesh)) inner = inner_nodes(comm, mesh, between, cells);
  const auto at_inner = cells_at(comm, mesh, inner);
  cells.insert(cells.end(), at_inner.begin(), at_inner.end());
  const GlobalId first_new = mesh.info.node_ids().end();
  const auto children = split_cells(cells, splits, first_new);
  improve(mesh, children, inner, first_new, free_splits(comm, mesh, between, splits), splits);

  mesh::drop_level0(mesh);  // it is that of another level 0
  std::vector<std::array<int, 4>> patch;
  auto block = to_block(comm, mesh, splits, children, patch);
  scatter_nodes(comm, mesh, splits, block);
  mesh = {};
  mesh = assemble::assemble(comm, std::move(block));
  name_patches(patch, has_inner_patches, mesh);
  return mesh;
}

}  // namespace pamr::meshing
