// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/mesh/assemble_steps.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh::assembly {

namespace {

/// A face at its smallest node: the other two, and where it comes from (4 * cell + slot).
struct FaceAtNode {
  LocalId middle = 0;
  LocalId largest = 0;
  std::uint32_t from = 0;

  bool has_nodes_of(const FaceAtNode& other) const { return middle == other.middle && largest == other.largest; }
};

std::array<LocalId, 3> local_key(const DistMesh& mesh, std::uint32_t from) {
  const auto& nodes = mesh.cell_to_node[from / 4];
  const auto& corner = tet::face_to_corner[from % 4];
  std::array<LocalId, 3> key{nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
                             nodes[static_cast<std::size_t>(corner[2])]};
  std::sort(key.begin(), key.end());
  return key;
}

LocalId& slot_at(DistMesh& mesh, std::uint32_t from) { return mesh.cell_to_cell[from / 4][from % 4]; }

[[noreturn]] void refuse(par::SharedKey key, std::vector<GlobalId> cells) {
  std::sort(key.begin(), key.end());
  std::sort(cells.begin(), cells.end());
  std::string text;
  for (const auto cell : cells) text.append(" ").append(std::to_string(cell));
  throw Error("cells: expected at most two cells at a face, found cells" + text + " at the face of nodes " +
              std::to_string(key[0]) + " " + std::to_string(key[1]) + " " + std::to_string(key[2]));
}

/// Faces grouped by their smallest node: faces of node n are `from[offset[n] .. offset[n+1])`.
struct FacesOfNodes {
  std::vector<std::size_t> offset;
  std::vector<std::uint32_t> from;
};

FacesOfNodes group_by_smallest_node(const DistMesh& mesh) {
  const auto n_faces = static_cast<std::uint32_t>(4 * mesh.cell_to_node.size());
  FacesOfNodes faces;
  faces.offset.assign(mesh.node_global.size() + 1, 0);
  faces.from.resize(n_faces);
  for (std::uint32_t face = 0; face < n_faces; ++face)
    ++faces.offset[static_cast<std::size_t>(local_key(mesh, face)[0])];
  std::size_t end = 0;
  for (auto& offset : faces.offset) offset = end += offset;
  for (auto face = n_faces; face-- > 0;)
    faces.from[--faces.offset[static_cast<std::size_t>(local_key(mesh, face)[0])]] = face;
  return faces;
}

/// Links the cells of this rank that have a face in common; what stays single keeps `invalid_local`.
void match_own(DistMesh& mesh) {
  mesh.cell_to_cell.assign(mesh.cell_to_node.size(), {invalid_local, invalid_local, invalid_local, invalid_local});
  const auto faces = group_by_smallest_node(mesh);
  std::vector<FaceAtNode> here;
  for (std::size_t node = 0; node + 1 < faces.offset.size(); ++node) {
    here.clear();
    for (auto i = faces.offset[node]; i < faces.offset[node + 1]; ++i) {
      const auto key = local_key(mesh, faces.from[i]);
      here.push_back({key[1], key[2], faces.from[i]});
    }
    std::sort(here.begin(), here.end(), [](const FaceAtNode& a, const FaceAtNode& b) {
      if (a.middle != b.middle) return a.middle < b.middle;
      return a.largest != b.largest ? a.largest < b.largest : a.from < b.from;
    });
    for (std::size_t i = 0; i + 1 < here.size(); ++i) {
      if (!here[i].has_nodes_of(here[i + 1])) continue;
      if (i + 2 < here.size() && here[i].has_nodes_of(here[i + 2]))
        refuse(face_key(mesh, static_cast<LocalId>(here[i].from / 4), static_cast<int>(here[i].from % 4)),
               {mesh.cell_global[here[i].from / 4], mesh.cell_global[here[i + 1].from / 4],
                mesh.cell_global[here[i + 2].from / 4]});
      slot_at(mesh, here[i].from) = static_cast<LocalId>(here[i + 1].from / 4);
      slot_at(mesh, here[i + 1].from) = static_cast<LocalId>(here[i].from / 4);
      ++i;
    }
  }
}

/// True for the nodes that other ranks hold too. Collective.
std::vector<char> find_shared_nodes(const par::Comm& comm, const DistMesh& mesh) {
  std::vector<par::SharedKey> key;
  key.reserve(mesh.node_global.size());
  for (const auto id : mesh.node_global) key.push_back({id, -1, -1});
  std::vector<char> is_shared(mesh.node_global.size(), 0);
  for (const auto node : par::find_shared(comm, key).item) is_shared[static_cast<std::size_t>(node)] = 1;
  return is_shared;
}

/// Faces whose three nodes other ranks hold too, each once: only these can lie on a rank border, or have a third cell
/// on another rank.
std::vector<CellFace> find_candidates(const DistMesh& mesh, const std::vector<char>& is_shared) {
  std::vector<CellFace> candidates;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(c)];
      const auto& corner = tet::face_to_corner[static_cast<std::size_t>(f)];
      const auto neighbour = mesh.cell_to_cell[static_cast<std::size_t>(c)][static_cast<std::size_t>(f)];
      const bool is_first = neighbour == invalid_local || neighbour > c;
      if (is_first && std::all_of(corner.begin(), corner.end(), [&](int i) {
            return is_shared[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])] != 0;
          }))
        candidates.push_back({c, f});
    }
  return candidates;
}

void check_two_cells(const DistMesh& mesh, const par::Pattern& pattern, const std::vector<CellFace>& candidates,
                     const std::vector<GlobalId>& theirs) {
  std::vector<GlobalId> partner(candidates.size(), -1);
  for (std::size_t k = 0; k < pattern.item.size(); ++k) {
    const auto item = static_cast<std::size_t>(pattern.item[k]);
    const auto face = candidates[item];
    const auto own = mesh.cell_to_cell[static_cast<std::size_t>(face.cell)][static_cast<std::size_t>(face.slot)];
    const auto cell = mesh.cell_global[static_cast<std::size_t>(face.cell)];
    const auto key = face_key(mesh, face.cell, face.slot);
    if (own != invalid_local) refuse(key, {cell, mesh.cell_global[static_cast<std::size_t>(own)], theirs[k]});
    if (partner[item] >= 0) refuse(key, {cell, partner[item], theirs[k]});
    partner[item] = theirs[k];
  }
}

/// Links single faces with those of other ranks. Collective.
void match_across_ranks(const par::Comm& comm, DistMesh& mesh) {
  const auto candidates = find_candidates(mesh, find_shared_nodes(comm, mesh));
  std::vector<par::SharedKey> key;
  for (const auto face : candidates) key.push_back(face_key(mesh, face.cell, face.slot));
  auto pattern = par::find_shared(comm, key);
  std::vector<GlobalId> cell;
  for (const auto item : pattern.item)
    cell.push_back(mesh.cell_global[static_cast<std::size_t>(candidates[static_cast<std::size_t>(item)].cell)]);
  mesh.ghost_global = par::Exchange(comm, pattern).swap<GlobalId>(cell);
  par::agree(comm, [&] { check_two_cells(mesh, pattern, candidates, mesh.ghost_global); });

  mesh.border_rank = std::move(pattern.rank);
  mesh.border_offset = std::move(pattern.offset);
  mesh.border_face.reserve(pattern.item.size());
  for (const auto item : pattern.item) {
    const auto face = candidates[static_cast<std::size_t>(item)];
    mesh.cell_to_cell[static_cast<std::size_t>(face.cell)][static_cast<std::size_t>(face.slot)] =
        mesh.n_cells() + static_cast<LocalId>(mesh.border_face.size());
    mesh.border_face.push_back(face);
  }
}

}  // namespace

void build_neighbours(const par::Comm& comm, DistMesh& mesh) {
  par::agree(comm, [&] { match_own(mesh); });
  if (comm.size() > 1) match_across_ranks(comm, mesh);
  for (auto& neighbours : mesh.cell_to_cell)
    for (auto& neighbour : neighbours)
      if (neighbour == invalid_local) neighbour = patch_to_slot(0);
}

}  // namespace pamr::mesh::assembly
