// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/build_neighbors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/rank_border.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::assemble {

namespace {

[[noreturn]] void refuse(par::SharedKey key, std::vector<GlobalId> cells) {
  std::sort(key.begin(), key.end());
  std::sort(cells.begin(), cells.end());
  std::string text;
  for (const auto cell : cells) text.append(" ").append(fmt::format("{}", cell));
  throw Error(fmt::format("cells: expected at most two cells at a face, found cells{} at the face of nodes {} {} {}",
                          text, key[0], key[1], key[2]));
}

LocalId& slot_at(mesh::DistMesh& mesh, mesh::CellFace face) {
  return mesh.cell_to_cell[static_cast<std::size_t>(face.cell)][static_cast<std::size_t>(face.slot)];
}

/// Links the cells of this rank that have a face in common; what stays single keeps `invalid_local`.
void match_own(mesh::DistMesh& mesh) {
  assign_array(mesh.cell_to_cell, mesh.cell_to_node.size(),
               {invalid_local, invalid_local, invalid_local, invalid_local});
  mesh::FaceGroups(mesh).for_each([&](std::span<const mesh::CellFace> faces) {
    if (faces.size() > 2) {
      std::vector<GlobalId> cells;
      for (const auto face : faces) cells.push_back(mesh.cell_global[static_cast<std::size_t>(face.cell)]);
      refuse(mesh::face_key(mesh, faces[0]), cells);
    }
    if (faces.size() < 2) return;
    slot_at(mesh, faces[0]) = faces[1].cell;
    slot_at(mesh, faces[1]) = faces[0].cell;
  });
}

/// True for the nodes that other ranks hold too. Collective.
std::vector<char> find_shared_nodes(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<par::SharedKey> key;
  key.reserve(mesh.node_global.size());
  for (const auto id : mesh.node_global) key.push_back({id, -1, -1});
  std::vector<char> is_shared(mesh.node_global.size(), 0);
  for (const auto node : par::find_shared(comm, key).item) is_shared[static_cast<std::size_t>(node)] = 1;
  return is_shared;
}

/// Faces whose three nodes other ranks hold too, each once: only these can lie on a rank border, or have a third cell
/// on another rank.
std::vector<mesh::CellFace> find_candidates(const mesh::DistMesh& mesh, const std::vector<char>& is_shared) {
  std::vector<mesh::CellFace> candidates;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(c)];
      const auto& corner = mesh::tet::face_to_corner[static_cast<std::size_t>(f)];
      const auto neighbor = mesh.cell_to_cell[static_cast<std::size_t>(c)][static_cast<std::size_t>(f)];
      const bool is_first = neighbor == invalid_local || neighbor > c;
      if (is_first && std::all_of(corner.begin(), corner.end(), [&](int i) {
            return is_shared[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])] != 0;
          }))
        candidates.push_back({c, f});
    }
  return candidates;
}

void check_two_cells(const mesh::DistMesh& mesh, const par::Pattern& pattern,
                     const std::vector<mesh::CellFace>& candidates, const std::vector<GlobalId>& theirs) {
  std::vector<GlobalId> partner(candidates.size(), -1);
  for (std::size_t k = 0; k < pattern.item.size(); ++k) {
    const auto item = static_cast<std::size_t>(pattern.item[k]);
    const auto face = candidates[item];
    const auto own = mesh.cell_to_cell[static_cast<std::size_t>(face.cell)][static_cast<std::size_t>(face.slot)];
    const auto cell = mesh.cell_global[static_cast<std::size_t>(face.cell)];
    const auto key = mesh::face_key(mesh, face);
    if (own != invalid_local) refuse(key, {cell, mesh.cell_global[static_cast<std::size_t>(own)], theirs[k]});
    if (partner[item] >= 0) refuse(key, {cell, partner[item], theirs[k]});
    partner[item] = theirs[k];
  }
}

/// Links single faces with those of other ranks. Collective.
void match_across_ranks(const par::Comm& comm, mesh::DistMesh& mesh) {
  const auto candidates = find_candidates(mesh, find_shared_nodes(comm, mesh));
  std::vector<par::SharedKey> key;
  for (const auto face : candidates) key.push_back(mesh::face_key(mesh, face));
  const auto pattern = par::find_shared(comm, key);
  std::vector<GlobalId> cell;
  for (const auto item : pattern.item)
    cell.push_back(mesh.cell_global[static_cast<std::size_t>(candidates[static_cast<std::size_t>(item)].cell)]);
  const auto theirs = par::Exchange(comm, pattern).swap<GlobalId>(cell);
  par::agree(comm, [&] { check_two_cells(mesh, pattern, candidates, theirs); });

  std::vector<mesh::RemoteFace> remote;
  remote.reserve(theirs.size());
  for (std::size_t i = 0; i < pattern.rank.size(); ++i)
    for (auto k = pattern.offset[i]; k < pattern.offset[i + 1]; ++k)
      remote.push_back({candidates[static_cast<std::size_t>(pattern.item[k])], pattern.rank[i], theirs[k]});
  mesh::fill_border(comm.rank(), mesh, remote);
}

}  // namespace

void build_neighbors(const par::Comm& comm, mesh::DistMesh& mesh) {
  par::agree(comm, [&] { match_own(mesh); });
  if (comm.size() > 1) match_across_ranks(comm, mesh);
  for (auto& neighbors : mesh.cell_to_cell)
    for (auto& neighbor : neighbors)
      if (neighbor == invalid_local) neighbor = mesh::patch_to_slot(0);
}

}  // namespace pamr::assemble
