// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt.hpp"

#include <array>
#include <memory>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/fine_nodes.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/relink.hpp"
#include "pamr/refine/settle.hpp"
#include "pamr/refine/subdivide.hpp"
#include "pamr/refine/transfer.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

mesh::DistMesh put_together(const refine::NumberedMesh& old, const mesh::MeshInfo& info, refine::FineNodes nodes,
                            refine::Children children, refine::Links links) {
  mesh::DistMesh fine;
  fine.info = info;
  fine.info.n_global_nodes = old.numbering.n_global_nodes;
  fine.info.n_global_cells = old.numbering.n_global_cells;
  fine.info.halves_are_paired = old.closure.halves_are_paired;
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

/// A mesh that is marked and closed.
struct Closed {
  mesh::MeshInfo info;                                   ///< of the mesh; flat patches that meet others have planes
  std::shared_ptr<const geometry::SurfaceSet> surfaces;  ///< that nodes are put on
  mesh::Borders borders;
  refine::Closure closure;
  Report report;  ///< of what was done so far
};

Closed close(const par::Comm& comm, const mesh::DistMesh& mesh, const DepthLimited& limited,
             const refine::Options& options, StepTimer& timer) {
  const auto& flags = limited.flags;
  Closed closed{mesh.info, geometry::no_surfaces(), mesh::find_borders(comm, mesh), {}, {}};
  if (options.project) {
    closed.info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh, closed.borders));
    closed.surfaces = closed.info.surfaces;
  }
  timer.lap("preprocessing");
  closed.closure = refine::close(comm, mesh, closed.borders, flags, options.quality_control);
  require_depth(comm, mesh, closed.closure);
  std::array<std::int64_t, 2> sums{refine::count_not_split(mesh, flags, closed.closure), limited.n_left_out};
  comm.sum_in_place(sums);
  closed.report.marked_not_split = sums[0];
  closed.report.marked_too_deep = sums[1];
  closed.report.neighbors_closing = std::ssize(closed.borders.nodes.rank);
  timer.lap("close");
  return closed;
}

/// The refined mesh without fields, and what `transfer` needs to give it its fields.
struct Split {
  mesh::DistMesh fine;
  refine::Numbering numbering;
  refine::Certificate certificate;
};

Split split(const par::Comm& comm, const mesh::DistMesh& mesh, const Closed& closed, StepTimer& timer) {
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

/// Gives the refined mesh its fields and completes the report but for times.
RefineResult transfer(const mesh::DistMesh& mesh, Closed closed, Split&& split, const refine::Options& options) {
  auto& [fine, numbering, certificate] = split;
  auto fields = refine::transfer({mesh, closed.closure, numbering}, fine.cell_to_node, certificate, options);
  fine.node_fields = std::move(fields.of_nodes);
  fine.cell_fields = std::move(fields.of_cells);

  auto& report = closed.report;
  report.cells_in = mesh.info.n_global_cells;
  report.nodes_in = mesh.info.n_global_nodes;
  report.cells_out = fine.info.n_global_cells;
  report.nodes_out = fine.info.n_global_nodes;
  report.closure = closed.closure.report;
  report.certificate = std::move(certificate);
  report.neighbors = std::ssize(closed.borders.nodes.rank);
  return {std::move(fine), std::move(report)};
}

RefineResult complete(const par::Comm& comm, RefineResult result, const StepTimer& timer, const Traffic& before) {
  PAMR_ENSURES_AUDIT(validate::validate(comm, result.mesh).empty());
  result.report.steps = timer.steps();
  result.report.traffic = comm.traffic() - before;
  return result;
}

}  // namespace

RefineResult refine(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                    const refine::Options& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  require_flags(comm, mesh, flags);
  auto closed = close(comm, mesh, limit_depth(mesh, flags), options, timer);
  auto made = split(comm, mesh, closed, timer);
  auto result = transfer(mesh, std::move(closed), std::move(made), options);
  timer.lap("transfer");
  return complete(comm, std::move(result), timer, before);
}

RefineResult refine(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                    const Options& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  require_flags(comm, mesh, flags);
  const auto limited = limit_depth(mesh, flags);
  auto closed = close(comm, mesh, limited, options.refinement, timer);
  auto [parents, balance] =
      balance_parents(comm, {std::move(mesh), std::move(closed.borders), std::move(closed.closure)}, limited.flags,
                      options.balancing, timer);
  timer.lap("balance");
  closed.borders = std::move(parents.borders);
  closed.closure = std::move(parents.closure);
  closed.report.balance = balance;
  auto made = split(comm, parents.mesh, closed, timer);
  parents.mesh.cell_to_cell = {};  // the children have links of their own, and fields need room
  auto result = transfer(parents.mesh, std::move(closed), std::move(made), options.refinement);
  timer.lap("transfer");
  return complete(comm, std::move(result), timer, before);
}

}  // namespace pamr::adapt
