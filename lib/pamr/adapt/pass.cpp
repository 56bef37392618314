// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/pass.hpp"

#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/fine_nodes.hpp"
#include "pamr/refine/inner_faces.hpp"
#include "pamr/refine/integrals.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/relink.hpp"
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
  fine.info.level0 = old.mesh.info.level0;
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

}  // namespace

Closed open_pass(const par::Comm& comm, GivenMesh given, mesh::Borders borders, const refine::Options& options) {
  const auto& mesh = given.get();
  Closed closed{mesh, {}, mesh.info, geometry::no_surfaces(), std::move(borders), {}, {}, {}, {}};
  if (options.project) {
    closed.info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh, closed.borders));
    closed.surfaces = closed.info.surfaces;
  }
  closed.mesh = std::move(given);
  return closed;
}

Closed close_pass(const par::Comm& comm, Marked marked, const refine::Options& options, StepTimer& timer) {
  auto& known = marked.known;
  auto borders = known ? std::move(known->borders) : mesh::find_borders(comm, marked.mesh.get());
  auto closed = open_pass(comm, std::move(marked.mesh), std::move(borders), options);
  closed.requests = std::move(marked.requests);
  timer.lap("preprocessing");
  const auto& mesh = closed.mesh.get();
  closed.closure =
      known ? std::move(known->closure) : refine::close(comm, mesh, closed.borders, {closed.requests}, options);
  if (!closed.closure.has_early) {
    refine::find_states(mesh, options, closed.closure);
    require_depth(comm, mesh, closed.closure);
  }
  closed.report.closure = closed.closure.report;
  closed.report.neighbors_closing = std::ssize(closed.borders.nodes.rank);
  timer.lap("close");
  return closed;
}

Split split_pass(const par::Comm& comm, Closed& closed, StepTimer& timer) {
  const auto& mesh = closed.mesh.get();
  const auto& info = closed.info;
  const auto& borders = closed.borders;
  const auto& closure = closed.closure;
  auto numbering = refine::number(comm, mesh, borders, closure);
  const refine::NumberedMesh old{mesh, closure, numbering};
  timer.lap("number");
  auto movables = refine::project(comm, mesh, borders, numbering, {info, *closed.surfaces});
  auto nodes = refine::place_nodes(old, borders, movables);
  timer.lap("project");
  auto children = refine::subdivide(old, nodes.position);
  timer.lap("subdivide");
  const refine::NewLevel level{mesh, info, *closed.surfaces, numbering, children, nodes.shared};
  auto settled = refine::certify(comm, level, std::move(nodes.position), movables);
  nodes.position = std::move(settled.position);
  free_array(movables);
  numbering.drop_all_but_children();
  closed.mesh.drop_replaced_numbers();
  timer.lap("project");
  auto links = refine::relink(comm, old, children, nodes.global);
  auto inner_patches = refine::inner_patches_of_children(old, children);
  auto fine = put_together(old, info, std::move(nodes), std::move(children), std::move(links));
  if (inner_patches) fine.cell_fields.push_back(std::move(*inner_patches));
  timer.lap("relink");
  return {std::move(fine), std::move(numbering), std::move(settled.certificate)};
}

Result transfer_pass(Closed closed, Split split, const refine::Options& options) {
  const auto& mesh = closed.mesh.get();
  auto fine = std::move(split.fine);
  const refine::NumberedMesh old{mesh, closed.closure, split.numbering};
  auto fields = refine::transfer(old, fine.cell_to_node, split.certificate, options,
                                 [&](const mesh::Field& field) { closed.mesh.drop_values(field); });
  refine::keep_integrals(old, fine, options.integrals, fields.of_cells);
  fine.node_fields = std::move(fields.of_nodes);
  for (auto& inner_patches : fine.cell_fields) fields.of_cells.push_back(std::move(inner_patches));
  fine.cell_fields = std::move(fields.of_cells);

  auto& report = closed.report;
  const auto before = std::exchange(report.certificate, std::move(split.certificate));
  report.certificate.n_moved += before.n_moved;
  report.certificate.n_cells_checked += before.n_cells_checked;
  report.certificate.back_off_rounds += before.back_off_rounds;
  report.cells_out = fine.info.n_global_cells;
  report.nodes_out = fine.info.n_global_nodes;
  report.neighbors = std::ssize(closed.borders.nodes.rank);
  return {std::move(fine), std::move(report), {}, {}};
}

}  // namespace pamr::adapt
