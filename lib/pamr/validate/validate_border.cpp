// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate_border.hpp"

#include <algorithm>

#include "pamr/mesh/border_agrees.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/validate/validate_cells.hpp"

namespace pamr::validate {

namespace {

using mesh::FaceRecord;

void compare_sides(std::span<const FaceRecord> mine, std::span<const FaceRecord> theirs, Findings& findings) {
  for (std::size_t k = 0; k < std::max(mine.size(), theirs.size()); ++k) {
    if (k >= mine.size())
      findings.add(Invariant::border_matches, theirs[k].own);
    else if (k >= theirs.size() || mine[k].key != theirs[k].key)
      findings.add(Invariant::border_matches, mine[k].own);
    else if (mine[k].own != theirs[k].other || mine[k].other != theirs[k].own || mine[k].sign != -theirs[k].sign)
      findings.add(Invariant::neighbors_reciprocal, mine[k].own);
  }
}

/// True when the other side of every rank-border face says the same of it: nodes, cells, and from which side each cell
/// looks at it. `assemble` has exchanged nearly the same words when the neighbors came from a file. They are exchanged
/// anew, because a mesh to be validated may come from anywhere, and `assemble` does not look at the sides: 8 bytes a
/// face of the border cost less than a promise that every maker of a mesh would have to keep. Collective.
bool sides_agree(const par::Comm& comm, const mesh::DistMesh& mesh) {
  return mesh::border_agrees(comm, mesh, [&](std::size_t k, bool is_lower) {
    const bool is_positive = (face_sign(mesh, mesh.border_face[k]) > 0) == is_lower;
    return mesh::border_word(mesh, k, is_lower) + (is_positive ? 1 : 0);
  });
}

/// Finds in what the two sides of rank-border faces differ. Collective: one sparse exchange.
void find_differences(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto messages = mesh::for_each_border_face<FaceRecord>(mesh, [&](std::size_t k) {
    const auto face = mesh.border_face[k];
    return FaceRecord{mesh::face_key(mesh, face), number_of(mesh, face.cell), mesh.ghost_global[k],
                      face_sign(mesh, face)};
  });
  const auto arrived = comm.sparse_exchange(messages);
  for (const auto& message : messages) {
    const auto from = std::find(arrived.rank.begin(), arrived.rank.end(), message.to);
    compare_sides(message.item,
                  from == arrived.rank.end() ? std::span<const FaceRecord>{}
                                             : arrived.from(static_cast<std::size_t>(from - arrived.rank.begin())),
                  findings);
  }
  for (std::size_t r = 0; r < arrived.rank.size(); ++r)
    if (!std::binary_search(mesh.border_rank.begin(), mesh.border_rank.end(), arrived.rank[r]))
      compare_sides({}, arrived.from(r), findings);
}

}  // namespace

void check_border(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k)
    if (slot_at(mesh, mesh.border_face[k]) != mesh.n_cells() + static_cast<LocalId>(k))
      findings.add(Invariant::border_matches, number_of(mesh, mesh.border_face[k].cell));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto slot = slot_at(mesh, {c, f});
      if (mesh.is_ghost(slot) &&
          mesh.border_face[static_cast<std::size_t>(slot - mesh.n_cells())] != mesh::CellFace{c, f})
        findings.add(Invariant::border_matches, number_of(mesh, c));
    }
  if (comm.any(!sides_agree(comm, mesh))) find_differences(comm, mesh, findings);
}

void check_inner_patches(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto* field = mesh.find_cell_field(mesh::inner_patch_field);
  if (!comm.any(field != nullptr)) return;
  const bool is_sound = field != nullptr && field->holds_integers() && field->integer().size() == at(mesh.n_cells());
  if (!is_sound) findings.add(Invariant::inner_patches_agree, Findings::nowhere);
  if (comm.any(!is_sound)) return;
  const mesh::InnerPatches inner(mesh);
  inner.for_each([&](mesh::CellFace face, int patch) {
    const auto cell = face.cell, next = slot_at(mesh, face);
    if (at(patch) >= mesh.info.patches.size())
      findings.add(Invariant::patches_in_range, number_of(mesh, cell));
    else if (mesh::is_untagged(mesh.info.patches[at(patch)]) && inner.is_first_side(face))
      findings.add(Invariant::untagged_outside, number_of(mesh, cell));
    bool agrees = mesh.is_ghost(next);
    for (int slot = 0; mesh.is_own(next) && slot < 4; ++slot)  // a broken neighbor may name the cell twice, or never
      agrees = agrees || (slot_at(mesh, {next, slot}) == cell && inner.of({next, slot}) == patch);
    if (!agrees) findings.add(Invariant::inner_patches_agree, number_of(mesh, cell));
  });
  const bool sides_agree = mesh::border_agrees(
      comm, mesh, [&](std::size_t k, bool) { return static_cast<std::uint64_t>(inner.of(mesh.border_face[k]) + 1); });
  if (!sides_agree) findings.add(Invariant::inner_patches_agree, Findings::nowhere);
}

}  // namespace pamr::validate
