// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/validate/findings.hpp"
#include "pamr/validate/validate_border.hpp"
#include "pamr/validate/validate_cells.hpp"
#include "pamr/validate/validate_shared.hpp"

namespace pamr::validate {

namespace {

GlobalId number_of(const mesh::DistMesh& mesh, std::size_t cell) {
  return cell < mesh.cell_global.size() ? mesh.cell_global[cell] : static_cast<GlobalId>(cell);
}

bool border_fits(const mesh::DistMesh& mesh, Rank rank, Rank size) {
  if (mesh.border_offset.size() != mesh.border_rank.size() + 1 || mesh.border_offset.front() != 0 ||
      mesh.border_offset.back() != mesh.border_face.size() || mesh.ghost_global.size() != mesh.border_face.size())
    return false;
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    const auto other = mesh.border_rank[i];
    if (other < 0 || other >= size || other == rank || (i > 0 && other <= mesh.border_rank[i - 1]) ||
        mesh.border_offset[i] > mesh.border_offset[i + 1])
      return false;
  }
  return true;
}

void check_ids(const mesh::DistMesh& mesh, Findings& findings) {
  const auto n_slots = mesh.n_cells() + static_cast<LocalId>(mesh.border_face.size());
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    const auto& n = mesh.cell_to_node[c];
    const auto& neighbors = mesh.cell_to_cell[c];
    if (std::any_of(n.begin(), n.end(), [&](LocalId node) { return node < 0 || node >= mesh.n_nodes(); }) ||
        std::any_of(neighbors.begin(), neighbors.end(), [&](LocalId slot) { return slot >= n_slots; }) ||
        !mesh.info.cell_ids().contains(mesh.cell_global[c]))
      findings.add(Invariant::ids_in_range, number_of(mesh, c));
    if (n[0] == n[1] || n[0] == n[2] || n[0] == n[3] || n[1] == n[2] || n[1] == n[3] || n[2] == n[3])
      findings.add(Invariant::distinct_corners, number_of(mesh, c));
    if (c > 0 && mesh.cell_global[c - 1] >= mesh.cell_global[c])
      findings.add(Invariant::cells_ascend, number_of(mesh, c));
  }
  for (const auto id : mesh.node_global)
    if (!mesh.info.node_ids().contains(id)) findings.add(Invariant::ids_in_range, Findings::nowhere);
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k) {
    const auto face = mesh.border_face[k];
    if (face.cell < 0 || face.cell >= mesh.n_cells() || face.slot < 0 || face.slot > 3 ||
        !mesh.info.cell_ids().contains(mesh.ghost_global[k]))
      findings.add(Invariant::ids_in_range, number_of(mesh, static_cast<std::size_t>(std::max(face.cell, 0))));
  }
}

void check_fields(const std::vector<mesh::Field>& fields, std::size_t n, Findings& findings) {
  for (const auto& field : fields) {
    const auto size = std::visit([](const auto& values) { return values.size(); }, field.value);
    if (field.n_components < 1 || size != n * static_cast<std::size_t>(field.n_components))
      findings.add(Invariant::fields_sized, Findings::nowhere);
  }
}

/// Lengths, numbers in range, distinct corners, ascending cells, fields: what the rest relies on; and patches for faces
/// without a tag, which all ranks know, on the first one. Local.
void check_structure(const mesh::DistMesh& mesh, Rank rank, Rank size, Findings& findings) {
  const auto n_cells = mesh.cell_to_node.size(), n_nodes = mesh.node_position.size();
  check_fields(mesh.cell_fields, n_cells, findings);
  check_fields(mesh.node_fields, n_nodes, findings);
  const auto& patches = mesh.info.patches;
  if (const auto n = std::count_if(patches.begin(), patches.end(), mesh::is_untagged); rank == 0 && n > 1)
    findings.add(Invariant::untagged_outside, Findings::nowhere, n - 1);
  if (mesh.cell_to_cell.size() != n_cells || mesh.cell_global.size() != n_cells || mesh.lineage.size() != n_cells ||
      (!mesh.cell_origin.empty() && mesh.cell_origin.size() != n_cells) || mesh.node_global.size() != n_nodes ||
      !border_fits(mesh, rank, size))
    findings.add(Invariant::ids_in_range, Findings::nowhere);
  else
    check_ids(mesh, findings);
}

/// Which patches break `untagged_outside`, and how.
std::string text_of_untagged(const mesh::MeshInfo& info, std::int64_t n_faces_inside) {
  std::vector<std::string> names;
  for (const auto& patch : info.patches)
    if (mesh::is_untagged(patch)) names.push_back("'" + patch.name + "'");
  if (names.size() > 1)
    return fmt::format("expected at most one patch of kind '{}', found {}", mesh::untagged_kind,
                       listed(names, {.before_last = " and "}));
  return fmt::format("expected faces of the boundary alone in a patch of kind '{}', found {} inside in {}",
                     mesh::untagged_kind, n_faces_inside, names.front());
}

}  // namespace

std::vector<Violation> validate(const par::Comm& comm, const mesh::DistMesh& mesh) {
  Findings found;
  check_structure(mesh, comm.rank(), comm.size(), found);
  if (!comm.any(found.has(Invariant::ids_in_range) || found.has(Invariant::distinct_corners))) {
    check_unique_cells(comm, mesh, found);
    check_shapes(mesh, found);
    check_own_neighbors(mesh, found);
    check_families(mesh, found);
    check_border(comm, mesh, found);
    check_inner_patches(comm, mesh, found);
    check_shared(comm, mesh, found);
    check_boundary(comm, mesh, found);
  }
  comm.sum_in_place(found.count);
  std::vector<Violation> violations;
  for (std::size_t i = 0; i < found.count.size(); ++i)
    if (found.count[i] != 0) {
      const auto where = comm.min(found.where[i]);
      violations.push_back({invariant_name[i], found.count[i], where == Findings::nowhere ? invalid_global : where});
    }
  return violations;
}

std::string text_of_place(const Violation& violation) {
  constexpr std::array<std::string_view, 4> of_nodes{"finite_coordinates", "unique_nodes", "shared_nodes_equal",
                                                     "nodes_referenced"};
  if (violation.where == invalid_global) return {};
  const bool is_node = std::find(of_nodes.begin(), of_nodes.end(), violation.invariant) != of_nodes.end();
  return fmt::format(", first at {} {}", is_node ? "node" : "cell", violation.where);
}

void require_size(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what) {
  if (mesh.info.n_global_cells == 0) return;
  const auto box = mesh::box_of_nodes(comm, mesh);
  const auto extent = geometry::largest_coordinate(box.high - box.low);
  if (extent < geometry::min_extent)
    throw Error(fmt::format("{}: expected a mesh larger than {:g}, found one of {:g}: choose a smaller unit of length",
                            what, geometry::min_extent, extent));
}

void require_valid(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what) {
  const auto violations = validate(comm, mesh);
  if (violations.empty()) return require_size(comm, mesh, what);
  const auto& first = violations.front();
  auto text = what + ": ";
  if (first.invariant == invariant_name[at(static_cast<int>(Invariant::untagged_outside))])
    text += text_of_untagged(mesh.info, first.count);
  else
    text += fmt::format("expected a valid mesh, found `{}` broken {}", first.invariant,
                        counted(first.count, "time", "times"));
  text += text_of_place(first);
  if (first.invariant == "boundary_manifold")
    text += " (the boundary touches itself in an edge, where four of its faces meet)";
  const auto more = violations.size() - 1;
  if (more > 0) text += fmt::format("; {} other invariant{} broken too", more, more == 1 ? " is" : "s are");
  throw Error(text);
}

void require_shapes(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what) {
  std::int64_t n_flat = 0;
  auto first = std::numeric_limits<GlobalId>::max();
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    if (is_far_from_flat(p) || geometry::mean_ratio(p) >= min_mean_ratio) continue;
    ++n_flat;
    first = std::min(first, number_of(mesh, c));
  }
  n_flat = comm.sum(n_flat);
  if (n_flat == 0) return;
  throw Error(fmt::format(
      "{}: expected cells with a mean ratio of at least {}, found {} flatter or too small for a double, first cell {}: "
      "no tool would read such a mesh",
      what, min_mean_ratio, n_flat, comm.min(first)));
}

}  // namespace pamr::validate
