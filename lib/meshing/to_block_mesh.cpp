// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/to_block_mesh.hpp"

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {
namespace {

using Neighbors = std::vector<std::array<GlobalId, 4>>;

/// A face seen from one of its cells.
struct HalfFace {
  std::array<std::int32_t, 3> node;  ///< ascending
  std::int32_t cell;
  int slot;
};

std::vector<HalfFace> sorted_half_faces(const RawMesh& mesh) {
  std::vector<HalfFace> faces;
  faces.reserve(4 * mesh.cell.size());
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      HalfFace face{{}, static_cast<std::int32_t>(c), slot};
      const auto& corners = mesh::tet::face_to_corner[static_cast<std::size_t>(slot)];
      for (std::size_t i = 0; i < 3; ++i) face.node[i] = mesh.cell[c][static_cast<std::size_t>(corners[i])];
      std::sort(face.node.begin(), face.node.end());
      faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end(),
            [](const HalfFace& a, const HalfFace& b) { return std::pair(a.node, a.cell) < std::pair(b.node, b.cell); });
  return faces;
}

Neighbors neighbors_of(const Domain& domain, const RawMesh& mesh) {
  Neighbors result(mesh.cell.size(), {invalid_global, invalid_global, invalid_global, invalid_global});
  const auto slot_of = [&result](std::int32_t cell, int slot) -> GlobalId& {
    return result[static_cast<std::size_t>(cell)][static_cast<std::size_t>(slot)];
  };
  const auto faces = sorted_half_faces(mesh);
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].node != faces[i + 1].node) continue;
    if (slot_of(faces[i].cell, faces[i].slot) != invalid_global) throw Error("expected a face in at most two cells");
    slot_of(faces[i].cell, faces[i].slot) = faces[i + 1].cell;
    slot_of(faces[i + 1].cell, faces[i + 1].slot) = faces[i].cell;
  }
  for (const auto& face : mesh.face) {
    if (slot_of(face.cell, face.slot) != invalid_global) throw Error("expected boundary faces in one cell only");
    slot_of(face.cell, face.slot) = -(domain.pieces[static_cast<std::size_t>(face.piece)].patch + 1);
  }
  for (const auto& cell : result)
    if (std::find(cell.begin(), cell.end(), invalid_global) != cell.end())
      throw Error("expected every boundary face in a patch");
  return result;
}

/// The patches of faces between regions, as `mesh::inner_patch_field` has them: from both sides.
std::vector<std::int64_t> inner_patches_of(const Domain& domain, const RawMesh& mesh, const Neighbors& neighbors) {
  std::vector<std::int64_t> word(mesh.cell.size(), 0);
  for (const auto& face : mesh.between) {
    const int patch = domain.pieces[static_cast<std::size_t>(face.piece)].patch;
    const auto cell = static_cast<std::size_t>(face.cell);
    const auto other = static_cast<std::size_t>(neighbors[cell][static_cast<std::size_t>(face.slot)]);
    const auto back = std::find(neighbors[other].begin(), neighbors[other].end(), GlobalId{face.cell});
    word[cell] = mesh::with_inner_patch(word[cell], face.slot, patch);
    word[other] = mesh::with_inner_patch(word[other], static_cast<int>(back - neighbors[other].begin()), patch);
  }
  return word;
}

/// The regions by their numbers, and the faces between parts of the domain. The same fields on every rank; values on
/// rank 0.
void add_regions(const Domain& domain, const RawMesh& mesh, mesh::BlockMesh& block) {
  if (domain.regions.empty()) return;
  for (const auto& part : domain.regions)
    if (part.number > std::ssize(block.info.regions)) block.info.regions.push_back({part.number, part.name});
  std::vector<std::int64_t> number, word;
  for (const int part : mesh.region) number.push_back(domain.regions[static_cast<std::size_t>(part)].number);
  const bool has_between =
      std::any_of(domain.pieces.begin(), domain.pieces.end(), [](const Piece& piece) { return piece.is_inside(); });
  if (has_between) word = inner_patches_of(domain, mesh, block.cell_to_cell);
  block.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int64, std::move(number)});
  if (has_between)
    block.cell_fields.push_back({mesh::inner_patch_field, "", 1, mesh::StorageType::int64, std::move(word)});
}

/// Sends the nodes of rank 0 to their canonical blocks.
std::vector<geometry::Vec3> scatter(const par::Comm& comm, const std::vector<geometry::Vec3>& all, GlobalId n) {
  std::vector<par::Outgoing<geometry::Vec3>> messages;
  if (comm.is_first())
    for (Rank rank = 0; rank < comm.size(); ++rank) {
      const auto range = par::block_range(n, rank, comm.size());
      messages.push_back({rank, {all.begin() + range.begin, all.begin() + range.end}});
    }
  return comm.sparse_exchange(messages).item;
}

}  // namespace

mesh::BlockMesh to_block_mesh(const par::Comm& comm, const Domain& domain, const RawMesh& mesh) {
  mesh::BlockMesh block;
  block.info.n_global_nodes = comm.sum(comm.is_first() ? static_cast<GlobalId>(mesh.point.size()) : 0);
  block.info.n_global_cells = comm.sum(comm.is_first() ? static_cast<GlobalId>(mesh.cell.size()) : 0);
  block.info.patches = domain.patches;
  block.info.surfaces = domain.surfaces;
  block.info.length_unit = domain.length_unit;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    block.cell_to_cell = neighbors_of(domain, mesh);
    for (const auto& cell : mesh.cell) block.cell_to_node.push_back({cell[0], cell[1], cell[2], cell[3]});
  });
  if (!comm.is_first()) block.first_cell = block.info.n_global_cells;
  add_regions(domain, mesh, block);
  block.node_position = scatter(comm, mesh.point, block.info.n_global_nodes);
  return block;
}

std::vector<Rank> block_destinations(const par::Comm& comm, const mesh::BlockMesh& block) {
  std::vector<Rank> destination;
  for (std::size_t i = 0; i < block.cell_to_node.size(); ++i)
    destination.push_back(
        par::block_of(block.first_cell + static_cast<GlobalId>(i), block.info.n_global_cells, comm.size()));
  return destination;
}

}  // namespace pamr::meshing
