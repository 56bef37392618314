// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/pass.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/open_parents.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/fine_nodes.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/relink.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/refine/settle.hpp"
#include "pamr/refine/subdivide.hpp"
#include "pamr/refine/transfer.hpp"

namespace pamr::adapt {

namespace {

mesh::DistMesh put_together(const refine::NumberedMesh& old, const mesh::MeshInfo& info, refine::FineNodes nodes,
                            refine::Children children, refine::Links links) {
  mesh::DistMesh fine;
  fine.info = info;
  fine.info.n_global_nodes = old.numbering.n_global_nodes;
  fine.info.n_global_cells = old.numbering.n_global_cells;
  fine.info.cut_faces_conform = old.closure.cut_faces_conform;
  fine.node_position = std::move(nodes.position);
  fine.node_global = std::move(nodes.global);
  fine.cell_to_node = std::move(children.cell_to_node);
  fine.cell_global = std::move(children.cell_global);
  fine.lineage = std::move(children.lineage);
  fine.cell_to_cell = std::move(links.cell_to_cell);
  fine.border_rank = std::move(links.border.border_rank);
  fine.border_offset = std::move(links.border.border_offset);
  fine.border_face = std::move(links.border.border_face);
  fine.ghost_global = std::move(links.border.ghost_global);
  return fine;
}

/// `input_cell`: as `split_early` has it.
std::vector<LocalId> cells_they_came_from(const refine::Numbering& numbering, std::span<const LocalId> input_cell) {
  std::vector<LocalId> from(at(numbering.first_child.back()));
  for (std::size_t c = 0; c + 1 < numbering.first_child.size(); ++c)
    std::fill(from.begin() + numbering.first_child[c], from.begin() + numbering.first_child[c + 1],
              input_cell.empty() ? static_cast<LocalId>(c) : input_cell[c]);
  return from;
}

/// All is split as `closed` has it; of the closing of early families nothing is left but its cost.
void go_without_early(const mesh::DistMesh& mesh, Closed& early, const refine::Options& options, Closed& closed) {
  closed.borders = std::move(early.borders);
  closed.closure.has_early = false;
  refine::find_states(mesh, options, closed.closure);
  closed.report.closure.rounds += early.closure.report.rounds;
  closed.report.closure.sweeps += early.closure.report.sweeps;
}

/// Adds what one pass did to what is known of those before it.
void add_to_report(const Report& pass, Report& sum) {
  sum.closure.rounds += pass.closure.rounds;
  sum.closure.sweeps += pass.closure.sweeps;
  sum.closure.families_rebuilt += pass.closure.families_rebuilt;
  sum.closure.families_kept += pass.closure.families_kept;
  sum.closure.early_passes += pass.closure.early_passes;
  sum.certificate.n_moved += pass.certificate.n_moved;
  sum.certificate.n_cells_checked += pass.certificate.n_cells_checked;
  sum.certificate.back_off_rounds += pass.certificate.back_off_rounds;
  sum.certificate.untangling_rounds += pass.certificate.untangling_rounds;
}

}  // namespace

Closed open_pass(const par::Comm& comm, const mesh::DistMesh& mesh, mesh::Borders borders,
                 const refine::Options& options) {
  Closed closed{mesh.info, geometry::no_surfaces(), std::move(borders), {}, {}};
  if (options.project) {
    closed.info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh, closed.borders));
    closed.surfaces = closed.info.surfaces;
  }
  return closed;
}

Closed close_pass(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
                  const refine::Carried& carried, const refine::Options& options, StepTimer& timer) {
  auto closed = open_pass(comm, mesh, mesh::find_borders(comm, mesh), options);
  timer.lap("preprocessing");
  closed.closure = refine::close(comm, mesh, closed.borders, requests, options, carried);
  if (!closed.closure.has_early) {
    refine::find_states(mesh, options, closed.closure);
    require_depth(comm, mesh, closed.closure);
  }
  closed.report.closure = closed.closure.report;
  closed.report.neighbors_closing = std::ssize(closed.borders.nodes.rank);
  timer.lap("close");
  return closed;
}

Split split_pass(const par::Comm& comm, const mesh::DistMesh& mesh, const Closed& closed, StepTimer& timer) {
  const auto& [info, surfaces, borders, closure, report] = closed;
  auto numbering = refine::number(comm, mesh, borders, closure);
  const refine::NumberedMesh old{mesh, closure, numbering};
  timer.lap("number");
  auto movables = refine::project(comm, mesh, info, borders, numbering, *surfaces);
  auto nodes = refine::place_nodes(old, borders, movables);
  timer.lap("project");
  auto children = refine::subdivide(old, nodes.position);
  timer.lap("subdivide");
  const refine::NewLevel level{info, *surfaces, numbering, children, nodes.shared};
  auto settled = refine::settle(comm, level, std::move(nodes.position), std::move(movables));
  nodes.position = std::move(settled.position);
  timer.lap("project");
  auto links = refine::relink(comm, old, children, nodes.global);
  auto fine = put_together(old, info, std::move(nodes), std::move(children), std::move(links));
  timer.lap("relink");
  return {std::move(fine), std::move(numbering), std::move(settled.certificate)};
}

RefineResult transfer_pass(const mesh::DistMesh& mesh, Closed closed, Split&& split, const refine::Options& options) {
  auto& [fine, numbering, certificate] = split;
  auto fields = refine::transfer({mesh, closed.closure, numbering}, fine.cell_to_node, certificate, options);
  fine.node_fields = std::move(fields.of_nodes);
  fine.cell_fields = std::move(fields.of_cells);

  auto& report = closed.report;
  const auto before = std::exchange(report.certificate, std::move(certificate));
  report.certificate.n_moved += before.n_moved;
  report.certificate.n_cells_checked += before.n_cells_checked;
  report.certificate.back_off_rounds += before.back_off_rounds;
  report.certificate.untangling_rounds += before.untangling_rounds;
  report.cells_out = fine.info.n_global_cells;
  report.nodes_out = fine.info.n_global_nodes;
  report.neighbors = std::ssize(closed.borders.nodes.rank);
  return {std::move(fine), std::move(report)};
}

namespace {

/// A mesh on its way through early passes, and what is still asked of its cells.
struct Unfinished {
  mesh::DistMesh mesh;
  std::vector<std::uint8_t> requests;
  refine::Carried carried;
  std::vector<LocalId> input_cell;  ///< this rank's input cell that each cell came from, or its family's first member
};

/// The splits that have to go before: those of the early families of `closed`. The cells stay on their ranks.
/// `input_cell`: this rank's input cell of each cell of `mesh`; empty: `mesh` is the input. The new mesh knows the
/// input cells by `cell_origin`, see `origins_of_pass`. Adds to the report of `closed`.
///
/// Nothing if a family would have to be kept and broken for it: then `closed` has no early families any more, but its
/// states, and children are closed as they are, under the floor or not. So each early pass splits all its early
/// families, and there is an end to them. Collective.
std::optional<Unfinished> split_early(const par::Comm& comm, const mesh::DistMesh& mesh,
                                      std::span<const std::uint8_t> requests, std::span<const LocalId> input_cell,
                                      Closed& closed, const refine::Options& options, StepTimer& timer) {
  const auto early = refine::requests_of_early(requests, closed.closure);
  Closed pass{closed.info, closed.surfaces, std::move(closed.borders), {}, {}};
  pass.closure = refine::close(comm, mesh, pass.borders, early, options);
  if (pass.closure.report.families_kept > 0) {
    go_without_early(mesh, pass, options, closed);
    require_depth(comm, mesh, closed.closure);
    timer.lap("close");
    return {};
  }
  refine::find_states(mesh, options, pass.closure);
  require_depth(comm, mesh, pass.closure);
  timer.lap("close");
  auto made = split_pass(comm, mesh, pass, timer);
  Unfinished unfinished;
  unfinished.requests = refine::remaining_requests({mesh, pass.closure, made.numbering}, requests);
  unfinished.input_cell = cells_they_came_from(made.numbering, input_cell);
  const bool has_moved =
      !std::equal(mesh.node_position.begin(), mesh.node_position.end(), made.fine.node_position.begin());
  unfinished.carried = refine::carry_over({mesh, pass.closure, made.numbering}, closed.closure, has_moved);
  auto origin = origins_of_pass(comm.rank(), {mesh, pass.closure, made.numbering}, made.fine.cell_to_node, input_cell);
  auto report = pass.closure.report;
  auto without_parent = options;
  without_parent.parent_field = false;
  auto result = transfer_pass(mesh, std::move(pass), std::move(made), without_parent);
  unfinished.mesh = std::move(result.mesh);
  unfinished.mesh.cell_origin = std::move(origin);
  timer.lap("transfer");

  // the plan is dropped; earlier passes stay in the sums
  closed.report.closure.families_rebuilt -= closed.closure.report.families_rebuilt;
  closed.report.closure.families_kept -= closed.closure.report.families_kept;
  report.early_passes = 1;
  result.report.closure = report;
  add_to_report(result.report, closed.report);
  return unfinished;
}

}  // namespace

Ready split_all_early(const par::Comm& comm, const mesh::DistMesh& input, Ready ready, const refine::Options& options,
                      StepTimer& timer) {
  while (ready.closed.closure.has_early) {
    const auto& mesh = ready.mesh ? *ready.mesh : input;
    auto unfinished = split_early(comm, mesh, ready.requests, ready.input_cell, ready.closed, options, timer);
    if (!unfinished) break;
    ready.mesh = std::move(unfinished->mesh);
    ready.requests = std::move(unfinished->requests);
    ready.input_cell = std::move(unfinished->input_cell);
    const auto before = std::move(ready.closed.report);
    ready.closed = close_pass(comm, *ready.mesh, ready.requests, unfinished->carried, options, timer);
    add_to_report(before, ready.closed.report);
  }
  return ready;
}

}  // namespace pamr::adapt
