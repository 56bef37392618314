// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/curve_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/curved/edge_nodes.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/transfer.hpp"

namespace pamr::curved {

namespace {

/// The distances that the mesh knows of its nodes, for the field to be made anew.
std::vector<refine::OffSurface> off_surface_before(const mesh::DistMesh& mesh) {
  std::vector<refine::OffSurface> nodes;
  const auto* field = mesh.find_node_field(mesh::off_surface_field);
  if (field == nullptr || field->holds_integers() || field->n_components != 1) return nodes;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node)
    if (const double distance = field->real()[at(node)]; distance > 0) nodes.push_back({node, distance});
  return nodes;
}

/// What is off its surface or its facets, and the counts of it in the report. Collective: two reductions.
refine::Certificate certificate_of(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::MeshInfo& info,
                                   const std::vector<refine::Movable>& movables, const std::vector<std::uint8_t>& step,
                                   const std::vector<std::uint8_t>& is_mine, Report& report) {
  refine::Certificate certificate;
  certificate.off_surface = off_surface_before(mesh);
  std::array<std::int64_t, 3> sum{0, 0, static_cast<std::int64_t>(certificate.off_surface.size())};
  double largest = 0;
  for (std::size_t i = 0; i < movables.size(); ++i) {
    const auto& m = movables[i];
    const auto way = std::ldexp(1.0, -static_cast<int>(step[i]));
    const bool stays = step[i] >= not_at_all;
    if (m.off_facets > 0 && !stays) {
      certificate.off_facets.push_back({m.node, way * m.off_facets});
      sum[1] += is_mine[at(m.node)];
    }
    if (m.patch[0] < 0 || (step[i] == 0 && m.is_reachable)) continue;
    const auto on = refine::surfaces_of_node(info, *info.surfaces, m.patch);
    const auto point = stays ? m.base : m.base + way * (m.target - m.base);
    const double distance = geometry::distance_from_all(on.surface, point);
    certificate.off_surface.push_back({m.node, distance});
    sum[0] += is_mine[at(m.node)];
    largest = std::max(largest, distance);
  }
  comm.sum_in_place(sum);
  report.n_off_surface = sum[0];
  report.max_off_surface = comm.max(largest);
  certificate.n_off_surface = sum[0] + sum[2];
  certificate.n_off_facets = sum[1];
  return certificate;
}

/// Collective: one reduction.
void count_curved(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<refine::Movable>& movables,
                  const mesh::SecondOrder& nodes, const std::vector<std::uint8_t>& is_mine, Report& report) {
  std::vector<std::uint8_t> is_curved(nodes.node_position.size(), 0);
  std::array<std::int64_t, 2> sum{0, 0};
  for (const auto& m : movables) {
    if (nodes.node_position[at(m.node)] == m.base) continue;
    is_curved[at(m.node)] = 1;
    sum[0] += is_mine[at(m.node)];
  }
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& mid = nodes.cell_to_mid[at(c)];
    sum[1] += std::any_of(mid.begin(), mid.end(), [&](LocalId n) { return is_curved[at(n)] != 0; }) ? 1 : 0;
  }
  comm.sum_in_place(sum);
  report.n_curved_edges = sum[0];
  report.n_curved_cells = sum[1];
}

}  // namespace

CurvedCells curve_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const Options& options) {
  if (!(options.min_jacobian > 0 && options.min_jacobian < 1))
    throw Error("second order: expected a smallest Jacobian in (0, 1) of the straight cell's");
  auto edges = place_edge_nodes(comm, mesh, mesh::find_borders(comm, mesh));
  const auto& [info, closure, numbering, movables, placed] = edges;
  const refine::NumberedMesh numbered{mesh, closure, numbering};

  CurvedCells result;
  auto& nodes = result.nodes;
  nodes.node_position = std::move(edges.placed.position);
  nodes.node_global = std::move(edges.placed.global);
  nodes.cell_to_mid = std::move(edges.numbering.edge_to_node);  // all cells are marked, so rows are cells
  nodes.n_global_nodes = numbering.n_global_nodes;

  const auto straightened = straighten(comm, mesh, movables, placed.shared, options, nodes);
  auto& report = result.report;
  report.straightening = straightened.report;
  report.n_edges = numbering.n_global_nodes - mesh.info.n_global_nodes;
  const auto is_mine = par::held_first_here(par::Exchange(comm, placed.shared), nodes.node_position.size());
  count_curved(comm, mesh, movables, nodes, is_mine, report);
  const auto certificate = certificate_of(comm, mesh, info, movables, straightened.step, is_mine, report);
  nodes.node_fields = refine::transfer_to_nodes(numbered, certificate);
  nodes.shared = std::move(edges.placed.shared);
  return result;
}

}  // namespace pamr::curved
