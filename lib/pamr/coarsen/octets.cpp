// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/octets.hpp"

#include <algorithm>

#include "pamr/base/memory.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::coarsen {

namespace {

/// The corners of a base cell.
mesh::CellNodes base_corners(const mesh::DistMesh& mesh, LocalId first) {
  const auto lineage = mesh.lineage[at(first)];
  if (!lineage.is_removable()) return mesh.cell_to_node[at(first)];
  mesh::CellNodes corner{};
  for (int code = 0; code < 4; ++code) {
    const auto [member, slot] = refine::family_table[at(lineage.state())].node[at(code)];
    corner[at(code)] = mesh.cell_to_node[at(first + member)][at(slot)];
  }
  return corner;
}

/// Eight base cells that follow each other and have the child numbers 0 to 7.
struct Run {
  std::array<LocalId, 8> first{};
  int n = 0;
};

/// Fills in how the parent was split, and its nodes. False if these are no siblings.
bool fit_octet(const mesh::DistMesh& mesh, const Run& run, Group& octet) {
  std::array<mesh::CellNodes, 8> corner;
  for (std::size_t child = 0; child < 8; ++child) corner[child] = base_corners(mesh, run.first[child]);
  for (int diagonal = 0; diagonal < 3; ++diagonal) {
    const auto& pattern = refine::split_pattern[at(refine::regular_state + diagonal)];
    octet.node.fill(invalid_local);
    bool fits = true;
    for (std::size_t child = 0; child < 8 && fits; ++child)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        auto& node = octet.node[at(pattern.child_to_node[child][slot])];
        if (node == invalid_local) node = corner[child][slot];
        fits = fits && node == corner[child][slot];
      }
    if (!fits) continue;
    octet.before = static_cast<refine::SplitState>(refine::regular_state + diagonal);
    return true;
  }
  return false;
}

}  // namespace

mesh::Lineage parent_lineage(const mesh::DistMesh& mesh, const Group& group) {
  const auto base = mesh.lineage[at(group.first)].base();
  return group.is_octet() ? base.red_parent() : base;
}

bool base_cell_may_go(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, LocalId first) {
  for (auto c = first; c < end_of_base_cell(mesh, first); ++c)
    if (flags[at(c)] != may_go) return false;
  return true;
}

Group family_group(const mesh::DistMesh& mesh, LocalId first) {
  const auto lineage = mesh.lineage[at(first)];
  const auto state = static_cast<refine::SplitState>(lineage.state());
  Group group{first, first + lineage.family_size(), state, state, {}};
  for (int code = 0; code < 10; ++code) {
    const auto [member, slot] = refine::family_table[state].node[at(code)];
    group.node[at(code)] = member < 0 ? invalid_local : mesh.cell_to_node[at(first + member)][at(slot)];
  }
  return group;
}

Candidates find_octets(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags) {
  Candidates found;
  reserve_array(found.octets, at(mesh.n_cells()) / 8);
  Run run;
  LocalId end = 0;
  for (LocalId c = 0; c < mesh.n_cells(); c = end) {
    end = end_of_base_cell(mesh, c);
    const auto base = mesh.lineage[at(c)].base();
    const auto n_flagged = std::count(flags.begin() + c, flags.begin() + end, may_go);
    found.asked.n_flagged += n_flagged;
    const bool has_parent = base.depth() > 0;
    if (!has_parent) found.asked.n_without_parent += n_flagged;
    if (!has_parent || n_flagged < end - c) {
      run.n = 0;
      continue;
    }
    const bool follows = run.n > 0 && mesh.cell_global[at(c)] == mesh.cell_global[at(c - 1)] + 1 &&
                         base.child_number() == run.n &&
                         base.red_parent() == mesh.lineage[at(run.first[0])].base().red_parent();
    if (!follows) run.n = 0;
    if (!follows && base.child_number() != 0) continue;
    run.first[at(run.n++)] = c;
    if (run.n < 8) continue;
    run.n = 0;
    Group octet{run.first[0], end, 0, 0, {}};
    if (!fit_octet(mesh, run, octet)) continue;
    found.asked.n_in_octets += end - octet.first;
    found.octets.push_back(octet);
  }
  return found;
}

}  // namespace pamr::coarsen
