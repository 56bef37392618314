// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/split_cells.hpp"

#include <algorithm>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;

std::size_t slot_of(const CellPart& part, GlobalId node) {
  return at(std::find(part.node.begin(), part.node.end(), node) - part.node.begin());
}
bool contains(const CellPart& part, const Split& split) {
  return std::all_of(split.node.begin(), split.node.begin() + static_cast<std::ptrdiff_t>(split.n_nodes()),
                     [&](GlobalId node) { return slot_of(part, node) < 4; });
}

/// The entries of `splits` by their first nodes.
std::map<GlobalId, std::vector<std::size_t>> by_first_node(const std::vector<Split>& splits) {
  std::map<GlobalId, std::vector<std::size_t>> rows;
  for (std::size_t s = 0; s < splits.size(); ++s) rows[splits[s].node[0]].push_back(s);
  return rows;
}

CellPart part_from(const mesh::DistMesh& mesh, const mesh::InnerPatches& patches, LocalId c) {
  CellPart part{mesh.cell_global[at(c)], {}, mesh.points(c), {}};
  for (std::size_t k = 0; k < 4; ++k) {
    part.node[k] = mesh.node_global[at(mesh.cell_to_node[at(c)][k])];
    part.patch[k] = patches.of_any({c, static_cast<int>(k)});
  }
  return part;
}

/// The cells of all ranks at nodes of `wanted` (ascending) for which `is_wanted(part)`. Collective.
template <class Wanted>
std::vector<CellPart> gather_cells(const par::Comm& comm, const mesh::DistMesh& mesh,
                                   const std::vector<GlobalId>& wanted, Wanted&& is_wanted) {
  std::vector<std::uint8_t> is_at(at(mesh.n_nodes()), 0);
  for (std::size_t n = 0; n < is_at.size(); ++n)
    is_at[n] = std::binary_search(wanted.begin(), wanted.end(), mesh.node_global[n]) ? 1 : 0;
  const mesh::InnerPatches patches(mesh);
  std::vector<CellPart> parts;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& nodes = mesh.cell_to_node[at(c)];
    if (std::none_of(nodes.begin(), nodes.end(), [&](LocalId n) { return is_at[at(n)] != 0; })) continue;
    if (const auto part = part_from(mesh, patches, c); is_wanted(part)) parts.push_back(part);
  }
  return gather_few(comm, std::move(parts));
}

/// The children of a part: in each one node of the split edge or face gives way to the new node.
void apply(const Split& split, GlobalId new_node, std::vector<CellPart>& parts) {
  std::vector<CellPart> result;
  for (const auto& part : parts) {
    if (!contains(part, split)) {
      result.push_back(part);
      continue;
    }
    for (std::size_t k = 0; k < split.n_nodes(); ++k) {
      auto child = part;
      for (std::size_t other = 0; other < split.n_nodes(); ++other)
        if (other != k) child.patch[slot_of(part, split.node[other])] = inner_face;  // between the children
      const auto slot = slot_of(part, split.node[k]);
      child.node[slot] = new_node;
      child.point[slot] = split.point;
      result.push_back(child);
    }
  }
  parts = std::move(result);
}

}  // namespace

std::vector<CellPart> cells_to_split(const par::Comm& comm, const mesh::DistMesh& mesh,
                                     const std::vector<Split>& splits) {
  const auto first = by_first_node(splits);
  std::vector<GlobalId> wanted;
  for (const auto& [node, rows] : first) wanted.push_back(node);
  return gather_cells(comm, mesh, wanted, [&](const CellPart& part) {
    return std::any_of(part.node.begin(), part.node.end(), [&](GlobalId node) {
      const auto rows = first.find(node);
      return rows != first.end() && std::any_of(rows->second.begin(), rows->second.end(),
                                                [&](std::size_t row) { return contains(part, splits[row]); });
    });
  });
}

std::vector<CellPart> cells_at(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& nodes) {
  return gather_cells(comm, mesh, nodes, [](const CellPart&) { return true; });
}

std::vector<GlobalId> inner_nodes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  const std::vector<mesh::RegionFace>& between, const std::vector<CellPart>& parts) {
  std::vector<GlobalId> nodes;
  for (const auto& part : parts) nodes.insert(nodes.end(), part.node.begin(), part.node.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<std::int64_t> n_faces(nodes.size(), 0);
  const auto count = [&](LocalId cell, std::size_t slot) {
    for (const auto corner : mesh::tet::face_to_corner[slot]) {
      const auto id = mesh.node_global[at(mesh.cell_to_node[at(cell)][at(corner)])];
      const auto found = std::lower_bound(nodes.begin(), nodes.end(), id);
      if (found != nodes.end() && *found == id) ++n_faces[at(found - nodes.begin())];
    }
  };
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (mesh.cell_to_cell[at(c)][slot] < 0) count(c, slot);
  for (const auto& [face, regions] : between) count(face.cell, at(face.slot));
  comm.sum_in_place(n_faces);
  std::vector<GlobalId> inner;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (n_faces[i] == 0) inner.push_back(nodes[i]);
  return inner;
}

std::vector<Split> placed_in_order(const std::vector<CellPart>& cells, std::vector<Split> splits) {
  std::map<GlobalId, Vec3> point;
  for (const auto& part : cells)
    for (std::size_t k = 0; k < 4; ++k) point[part.node[k]] = part.point[k];
  for (auto& split : splits) {
    const Vec3 a = point.at(split.node[0]), b = point.at(split.node[1]);
    split.point = geometry::midpoint(a, b);
    split.squared_length = geometry::squared_norm(b - a);
    if (split.n_nodes() == 3) split.point = split.point + (1.0 / 3) * (point.at(split.node[2]) - split.point);
  }
  std::stable_sort(splits.begin(), splits.end(), [](const Split& p, const Split& q) {  // edges before faces
    return p.n_nodes() != q.n_nodes() ? p.n_nodes() < q.n_nodes() : p.squared_length > q.squared_length;
  });
  return splits;
}

std::map<GlobalId, std::vector<CellPart>> split_cells(const std::vector<CellPart>& parents,
                                                      const std::vector<Split>& splits, GlobalId first_new) {
  const auto first = by_first_node(splits);
  std::map<GlobalId, std::vector<CellPart>> children;
  for (const auto& parent : parents) {
    std::vector<std::size_t> rows;
    for (const auto node : parent.node)
      if (const auto found = first.find(node); found != first.end())
        rows.insert(rows.end(), found->second.begin(), found->second.end());
    std::sort(rows.begin(), rows.end());
    auto& parts = children[parent.cell] = {parent};
    for (const auto s : rows) apply(splits[s], first_new + static_cast<GlobalId>(s), parts);
  }
  return children;
}

}  // namespace pamr::meshing
