// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt.hpp"

#include <algorithm>
#include <string>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/relink.hpp"
#include "pamr/refine/settle.hpp"
#include "pamr/refine/subdivide.hpp"
#include "pamr/refine/transfer.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

void require_flags(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags) {
  par::agree(comm, [&] {
    if (flags.size() != at(mesh.n_cells()))
      throw Error("refine: expected one flag for each of the " + std::to_string(mesh.n_cells()) + " cells of rank " +
                  std::to_string(comm.rank()) + ", found " + std::to_string(flags.size()));
  });
}

/// Old nodes where they are, new ones where they are meant to lie.
std::vector<geometry::Vec3> place_nodes(const mesh::DistMesh& mesh, const refine::Numbering& numbering,
                                        const std::vector<refine::Movable>& movables) {
  std::vector<geometry::Vec3> position;
  reserve_array(position, at(mesh.n_nodes()) + numbering.n_new_nodes());
  position = mesh.node_position;
  for (const auto [a, b] : numbering.ends) position.push_back(geometry::midpoint(mesh.point(a), mesh.point(b)));
  for (const auto& movable : movables) position[at(movable.node)] = movable.target;
  return position;
}

std::vector<GlobalId> join_ids(const mesh::DistMesh& mesh, const refine::Numbering& numbering) {
  std::vector<GlobalId> ids;
  reserve_array(ids, mesh.node_global.size() + numbering.n_new_nodes());
  ids = mesh.node_global;
  ids.insert(ids.end(), numbering.node_global.begin(), numbering.node_global.end());
  return ids;
}

/// Nodes of the refined mesh that other ranks hold too: the old ones, and those on marked border edges.
par::Pattern share_nodes(const mesh::Borders& borders, const refine::Closure& closure,
                         const refine::Numbering& numbering) {
  par::Pattern shared;
  const auto& nodes = borders.nodes;
  const auto& edges = borders.edges;
  for (std::size_t i = 0, j = 0; i < nodes.rank.size() || j < edges.rank.size();) {
    const bool take_nodes = j == edges.rank.size() || (i < nodes.rank.size() && nodes.rank[i] <= edges.rank[j]);
    const Rank rank = take_nodes ? nodes.rank[i] : edges.rank[j];
    if (take_nodes) {
      shared.item.insert(shared.item.end(), nodes.item.begin() + static_cast<std::ptrdiff_t>(nodes.offset[i]),
                         nodes.item.begin() + static_cast<std::ptrdiff_t>(nodes.offset[i + 1]));
      ++i;
    }
    if (j < edges.rank.size() && edges.rank[j] == rank) {
      for (auto k = edges.offset[j]; k < edges.offset[j + 1]; ++k) {
        const auto arc = borders.arcs(at(edges.item[k])).front();
        if ((closure.marks[at(arc.cell)] >> arc.edge & 1) != 0)
          shared.item.push_back(numbering.midpoint(arc.cell, arc.edge));
      }
      ++j;
    }
    shared.rank.push_back(rank);
    shared.offset.push_back(shared.item.size());
  }
  return shared;
}

/// Of each patch whether new nodes on it will be moved: not where it has no surface or a flat one.
std::vector<bool> curved_patches(const mesh::DistMesh& mesh, const refine::Options& options) {
  std::vector<bool> is_curved(mesh.info.patches.size(), false);
  if (!options.project) return is_curved;
  for (std::size_t p = 0; p < is_curved.size(); ++p)
    if (const auto* surface = mesh.info.surface_of(static_cast<int>(p))) is_curved[p] = !surface->is_flat();
  return is_curved;
}

/// `Forecast::work`: the number of children, two more where a cell is closed (its edges are walked for few children),
/// and five quarters more at a curved wall, where nodes are moved and what moves with them is smoothed and checked.
/// Source: processor times of 64 ranks of tests/bench/scaling.sh, fitted.
std::vector<std::uint8_t> work_of_cells(const mesh::DistMesh& mesh, const std::vector<LocalId>& first_child,
                                        const std::vector<bool>& is_curved) {
  std::vector<std::uint8_t> work(at(mesh.n_cells()));
  for (std::size_t c = 0; c < work.size(); ++c) {
    const auto children = first_child[c + 1] - first_child[c];
    const auto& slots = mesh.cell_to_cell[c];
    const bool at_wall = children > 1 && std::any_of(slots.begin(), slots.end(), [&](LocalId slot) {
                           return slot < 0 && is_curved[at(mesh::slot_to_patch(slot))];
                         });
    const bool is_closed = children > 1 && children < refine::max_children;
    work[c] = static_cast<std::uint8_t>(
        std::clamp(children + (is_closed ? 2 : 0) + (at_wall ? 5 * children / 4 : 0), 1, 255));
  }
  return work;
}

/// Flagged cells of which something is left that was not split into eight.
std::int64_t count_not_split(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                             const refine::Closure& closure) {
  std::int64_t n = 0;
  auto family = closure.rebuilt.begin();
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (flags[at(c)] == 0) continue;
    if (closure.action[at(c)] == refine::Action::split) {
      n += closure.marks[at(c)] == refine::all_edges ? 0 : 1;
      continue;
    }
    const auto first = c - mesh.lineage[at(c)].child();
    while (family->first < first) ++family;
    n += refine::split_pattern[at(family->state)].mask == refine::all_edges ? 0 : 1;
  }
  return n;
}

/// All steps after balancing. `consumed`: the same mesh where its arrays may be freed on the way, or null.
void split(const par::Comm& comm, const mesh::DistMesh& mesh, mesh::DistMesh* consumed, const mesh::Borders& borders,
           const refine::Closure& closure, const geometry::SurfaceSet& surfaces, const refine::Options& options,
           StepTimer& timer, RefineResult& result) {
  const auto numbering = refine::number(comm, mesh, borders, closure);
  timer.lap("number");

  auto& fine = result.mesh;
  fine.info = mesh.info;
  fine.info.n_global_nodes = numbering.n_global_nodes;
  fine.info.n_global_cells = numbering.n_global_cells;
  fine.info.halves_are_paired = closure.halves_are_paired;
  auto movables = refine::project_ledger(comm, mesh, borders, surfaces);
  const auto of_new_nodes = refine::project_new_nodes(comm, mesh, borders, numbering, surfaces);
  movables.insert(movables.end(), of_new_nodes.begin(), of_new_nodes.end());
  fine.node_position = place_nodes(mesh, numbering, movables);
  fine.node_global = join_ids(mesh, numbering);
  timer.lap("project");

  auto children = refine::subdivide(mesh, closure, numbering, fine.node_position);
  fine.cell_to_node = std::move(children.cell_to_node);
  fine.cell_global = std::move(children.cell_global);
  fine.lineage = std::move(children.lineage);
  timer.lap("subdivide");

  const auto shared = share_nodes(borders, closure, numbering);
  const auto certificate =
      refine::settle(comm, fine, shared, surfaces, numbering, mesh.n_nodes(), std::move(movables), children.suspects);
  timer.lap("project");

  refine::relink(comm, mesh, closure, numbering, children, fine);
  if (consumed != nullptr) consumed->cell_to_cell = {};
  timer.lap("relink");
  refine::transfer(mesh, closure, numbering, certificate, certificate.n_off_surface > 0, options, fine);
  PAMR_ENSURES_AUDIT(validate::validate(comm, fine).empty());
  timer.lap("transfer");

  auto& report = result.report;
  report.cells_in = mesh.info.n_global_cells;
  report.nodes_in = mesh.info.n_global_nodes;
  report.cells_out = fine.info.n_global_cells;
  report.nodes_out = fine.info.n_global_nodes;
  report.marked = closure.n_marked;
  report.families_rebuilt = closure.families_rebuilt;
  report.families_kept = closure.families_kept;
  report.off_surface_nodes = certificate.n_off_surface;
  report.rounds = closure.rounds;
  report.back_off_rounds = certificate.rounds;
  report.moved_nodes = certificate.n_moved;
  report.cells_checked = certificate.n_cells_checked;
  report.untangling_rounds = certificate.untangling_rounds;
  report.neighbors = static_cast<std::int64_t>(borders.nodes.rank.size());
}

/// The pipeline. `consumed`: the same mesh where it may move to other ranks and be taken apart, or null.
RefineResult run(const par::Comm& comm, const mesh::DistMesh& mesh, mesh::DistMesh* consumed,
                 std::span<const std::uint8_t> flags, const refine::Options& options, const Balancing& balancing) {
  StepTimer timer([&] { return comm.traffic(); });
  const auto traffic_before = comm.traffic();
  RefineResult result;
  require_flags(comm, mesh, flags);
  const auto surfaces = options.project ? mesh.info.surfaces : geometry::no_surfaces();
  auto borders = mesh::find_borders(comm, mesh);
  timer.lap("preprocessing");

  auto closure = refine::close(comm, mesh, borders, flags, options.quality_control);
  result.report.marked_not_split = comm.sum(count_not_split(mesh, flags, closure));
  result.report.neighbors_closing = static_cast<std::int64_t>(borders.nodes.rank.size());
  timer.lap("close");
  if (consumed != nullptr)
    result.report.balance = balance_parents(comm, *consumed, borders, closure, flags, balancing, timer);
  timer.lap("balance");
  split(comm, mesh, consumed, borders, closure, *surfaces, options, timer, result);
  result.report.steps = timer.steps();
  result.report.traffic = comm.traffic() - traffic_before;
  return result;
}

}  // namespace

RefineResult refine(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                    const refine::Options& options) {
  return run(comm, mesh, nullptr, flags, options, {});
}

RefineResult refine(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                    const Options& options) {
  return run(comm, mesh, &mesh, flags, options.refinement, options.balancing);
}

Forecast dry_run(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                 const refine::Options& options) {
  require_flags(comm, mesh, flags);
  const auto borders = mesh::find_borders(comm, mesh);
  const auto closure = refine::close(comm, mesh, borders, flags, options.quality_control);
  const auto numbering = refine::number(comm, mesh, borders, closure);
  return {numbering.n_global_cells, numbering.n_global_nodes, closure.n_marked, numbering.first_child.back(),
          work_of_cells(mesh, numbering.first_child, curved_patches(mesh, options))};
}

std::vector<std::uint8_t> flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name) {
  std::vector<std::uint8_t> flags(at(mesh.n_cells()));
  par::agree(comm, [&] {
    const auto* field = mesh.find_cell_field(name);
    if (field == nullptr) throw Error("marks: expected a cell field '" + name + "', found none of that name");
    if (!field->holds_integers() || field->n_components != 1)
      throw Error("marks: expected an integer field of one component, found cell field '" + name + "' of " +
                  (field->holds_integers() ? std::to_string(field->n_components) + " components" : "reals"));
    const auto& value = field->integer();
    for (std::size_t c = 0; c < flags.size(); ++c) {
      if (value[c] != 0 && value[c] != 1)
        throw Error("marks: expected 0 (keep) or 1 (split), found " + std::to_string(value[c]) + " in cell field '" +
                    name + "' at cell " + std::to_string(mesh.cell_global[c]));
      flags[c] = static_cast<std::uint8_t>(value[c]);
    }
  });
  return flags;
}

}  // namespace pamr::adapt
