// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/inner_patches.hpp"

#include <fmt/format.h>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::mesh {

InnerPatches::InnerPatches(const DistMesh& mesh) : mesh_(&mesh) {
  if (const auto* field = mesh.find_cell_field(inner_patch_field)) word_ = &field->integer();
}

bool InnerPatches::is_first_side(CellFace face) const {
  const auto next = mesh_->cell_to_cell[at(face.cell)][at(face.slot)];
  const auto other = mesh_->is_ghost(next) ? mesh_->ghost_global[at(next - mesh_->n_cells())]
                     : next >= 0           ? mesh_->cell_global[at(next)]
                                           : invalid_global;
  return other == invalid_global || mesh_->cell_global[at(face.cell)] < other;
}

std::vector<std::int64_t>& make_inner_patches(DistMesh& mesh) {
  if (auto* known = mesh.find_cell_field(inner_patch_field)) return known->integer();
  std::vector<std::int64_t> none;
  assign_array(none, mesh.cell_to_node.size(), std::int64_t{0});
  mesh.cell_fields.push_back({inner_patch_field, "", 1, StorageType::int64, std::move(none)});
  return mesh.cell_fields.back().integer();
}

std::vector<std::int64_t> count_inner_faces(const par::Comm& comm, const DistMesh& mesh) {
  const InnerPatches patches(mesh);
  std::vector<std::int64_t> n(mesh.info.patches.size(), 0);
  for (LocalId c = 0; c < (patches.is_empty() ? 0 : mesh.n_cells()); ++c)
    for (int slot = 0; slot < 4 && patches.word(c) != 0; ++slot)
      if (const int patch = patches.of({c, slot}); patch >= 0 && patches.is_first_side({c, slot})) ++n[at(patch)];
  comm.sum_in_place(n);
  return n;
}

std::vector<bool> patches_inside_alone(const par::Comm& comm, const DistMesh& mesh) {
  const InnerPatches patches(mesh);
  const auto n_patches = mesh.info.patches.size();
  std::vector<std::int64_t> n(2 * n_patches, 0);  // on the boundary, then inside
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      if (const int patch = patches.of_any({c, slot}); patch >= 0)
        ++n[at(patch) + (mesh.cell_to_cell[at(c)][at(slot)] < 0 ? 0 : n_patches)];
  comm.sum_in_place(n);
  std::vector<bool> alone;
  for (std::size_t p = 0; p < n_patches; ++p) alone.push_back(n[p] == 0 && n[p + n_patches] > 0);
  return alone;
}

void require_inner_patches(const Field& field, std::size_t n_patches) {
  if (!is_inner_patch_field(field)) return;
  if (!field.holds_integers() || field.n_components != 1)
    throw Error(
        fmt::format("field '{}': expected another name, which is not that of the patches of faces inside, or one "
                    "integer a cell, found {} {}",
                    field.name, field.n_components, field.holds_integers() ? "integers" : "reals"));
  for (const auto word : field.integer())
    for (int slot = 0; slot < 4; ++slot)
      if (const int patch = inner_patch(word, slot); patch >= 0 && at(patch) >= n_patches)
        throw Error(fmt::format("field '{}': expected patches from 0 to {}, found {}", field.name,
                                static_cast<std::int64_t>(n_patches) - 1, patch));
}

}  // namespace pamr::mesh
