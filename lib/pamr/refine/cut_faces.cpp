// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/cut_faces.hpp"

#include <bit>

#include "pamr/base/index.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::refine {

namespace {

/// Bit i: the face in slot i is a cut face.
unsigned cut_slots(const mesh::DistMesh& mesh, LocalId cell) {
  const auto lineage = mesh.lineage[at(cell)];
  return lineage.is_removable() ? family_table[at(lineage.state())].cut_slots[at(lineage.child())] : 0U;
}

bool is_cut(const mesh::DistMesh& mesh, mesh::CellFace face) {
  return (cut_slots(mesh, face.cell) >> face.slot & 1U) != 0;
}

/// The same of the face between `cell` and `next` as the own cell `next` has it.
bool is_cut_behind(const mesh::DistMesh& mesh, LocalId cell, LocalId next) {
  return is_cut(mesh, {next, mesh::slot_of(mesh.cell_to_cell[at(next)], cell)});
}

bool is_unpaired(const mesh::DistMesh& mesh, LocalId cell) {
  for (unsigned slots = cut_slots(mesh, cell); slots != 0; slots &= slots - 1) {
    const auto next = mesh.cell_to_cell[at(cell)][at(std::countr_zero(slots))];
    if (mesh.is_own(next) && !is_cut_behind(mesh, cell, next)) return true;
  }
  return false;
}

void retain_family(const mesh::DistMesh& mesh, LocalId cell, std::vector<std::uint8_t>& retained,
                   std::vector<LocalId>& fresh) {
  const auto lineage = mesh.lineage[at(cell)];
  const auto first = cell - lineage.child();
  if (!lineage.is_removable() || retained[at(first)] != 0) return;
  for (int child = 0; child < lineage.family_size(); ++child) {
    retained[at(first + child)] = 1;
    fresh.push_back(first + child);
  }
}

}  // namespace

std::vector<LocalId> find_unpaired_families(const par::Comm& comm, const mesh::DistMesh& mesh,
                                            const mesh::Borders& borders) {
  std::vector<std::uint8_t> mine;
  for (const auto face : mesh.border_face) mine.push_back(is_cut(mesh, face) ? 1 : 0);
  const auto theirs = par::Exchange(comm, borders.faces).swap<std::uint8_t>(mine);
  std::vector<LocalId> members;
  for (std::size_t k = 0; k < theirs.size(); ++k)
    if (mine[k] != 0 && theirs[k] == 0) members.push_back(mesh.border_face[k].cell);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (is_unpaired(mesh, c)) members.push_back(c);
  return members;
}

void retain_families(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                     const std::vector<LocalId>& members, std::vector<std::uint8_t>& retained) {
  retained.resize(at(mesh.n_cells()), 0);
  std::vector<LocalId> fresh;
  for (const auto member : members) retain_family(mesh, member, retained, fresh);
  const par::Exchange exchange(comm, borders.faces);
  for (bool news = true; news;) {
    while (!fresh.empty()) {
      const auto cell = fresh.back();
      fresh.pop_back();
      for (unsigned slots = cut_slots(mesh, cell); slots != 0; slots &= slots - 1) {
        const auto next = mesh.cell_to_cell[at(cell)][at(std::countr_zero(slots))];
        if (mesh.is_own(next) && is_cut_behind(mesh, cell, next)) retain_family(mesh, next, retained, fresh);
      }
    }
    std::vector<std::uint8_t> mine;
    for (const auto face : mesh.border_face) mine.push_back(retained[at(face.cell)] != 0 && is_cut(mesh, face) ? 1 : 0);
    const auto theirs = exchange.swap<std::uint8_t>(mine);
    for (std::size_t k = 0; k < theirs.size(); ++k)
      if (theirs[k] != 0 && is_cut(mesh, mesh.border_face[k]))
        retain_family(mesh, mesh.border_face[k].cell, retained, fresh);
    news = comm.any(!fresh.empty());
  }
}

}  // namespace pamr::refine
