// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/inner_patches.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::mesh {

InnerPatches::InnerPatches(const DistMesh& mesh) : mesh_(&mesh) {
  if (const auto* field = mesh.find_cell_field(inner_patch_field)) word_ = &field->integer();
}

bool InnerPatches::is_first_side(CellFace face) const {
  const auto next = mesh_->cell_to_cell[at(face.cell)][at(face.slot)];
  if (next < 0) return true;
  const auto other =
      mesh_->is_ghost(next) ? mesh_->ghost_global[at(next - mesh_->n_cells())] : mesh_->cell_global[at(next)];
  return mesh_->cell_global[at(face.cell)] < other;
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
  patches.for_each([&](CellFace face, int patch) { n[at(patch)] += patches.is_first_side(face) ? 1 : 0; });
  comm.sum_in_place(n);
  return n;
}

std::vector<bool> patches_inside_alone(const par::Comm& comm, const DistMesh& mesh) {
  const auto n_inside = count_inner_faces(comm, mesh);
  std::vector<bool> alone(n_inside.size(), false);
  if (std::all_of(n_inside.begin(), n_inside.end(), [](std::int64_t n) { return n == 0; })) return alone;
  std::vector<std::int64_t> n_outside(n_inside.size(), 0);
  for (const auto& neighbors : mesh.cell_to_cell)
    for (const auto next : neighbors)
      if (next < 0) ++n_outside[at(slot_to_patch(next))];
  comm.sum_in_place(n_outside);
  for (std::size_t p = 0; p < alone.size(); ++p) alone[p] = n_outside[p] == 0 && n_inside[p] > 0;
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
