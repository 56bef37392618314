// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/level0.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pamr/adapt/pass.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/curved/off_walls.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/level0_map.hpp"

namespace pamr::adapt {

namespace {

/// Puts nodes that are off their surfaces onto them, by a pass that splits nothing. Collective.
mesh::DistMesh put_onto_surfaces(const par::Comm& comm, mesh::DistMesh mesh, std::vector<double> off,
                                 curved::Level0Report& report) {
  report.farthest_moved = comm.max(off.empty() ? 0.0 : *std::max_element(off.begin(), off.end()));
  std::erase_if(mesh.node_fields, [](const mesh::NodeField& field) { return field.name == mesh::off_surface_field; });
  mesh.node_fields.push_back(
      {mesh::off_surface_field, mesh.info.length_unit, 1, mesh::StorageType::float64, std::move(off)});
  auto origin = std::exchange(mesh.cell_origin, {});
  const refine::Options options{.parent_field = false};
  StepTimer timer;
  std::vector<std::uint8_t> no_requests(mesh.cell_to_node.size(), 0);
  auto closed = close_pass(comm, {std::move(mesh), std::move(no_requests), {}}, options, timer);
  auto made = split_pass(comm, closed, timer);
  auto result = transfer_pass(std::move(closed), std::move(made), options);
  report.n_moved = result.report.certificate.n_moved;
  result.mesh.cell_origin = std::move(origin);
  return std::move(result.mesh);
}

/// Gives a mesh of level 0 its map once its nodes lie on their walls. Collective.
curved::Level0Report make_map(const par::Comm& comm, mesh::DistMesh& mesh, refine::Bend bend) {
  curved::Level0Report moved;
  auto found = curved::find_nodes_off_walls(comm, mesh, mesh::find_borders(comm, mesh));
  if (comm.any(!found.off.empty()) && (bend == refine::Bend::all || curved::find_coarse_edges(comm, mesh).count > 0))
    mesh = put_onto_surfaces(comm, std::move(mesh), std::move(found.off), moved);
  auto report = curved::make_level0_map(comm, mesh, bend);
  report.n_moved = moved.n_moved;
  report.farthest_moved = moved.farthest_moved;
  if (found.any_stays && report.n_coarse_edges > 0)
    report.trouble =
        "nodes of level 0 lie off their coarse walls and stay there, farther off than a hundredth of an edge or beside "
        "a patch without a surface (pamr-convert --surfaces FILE --tolerance D records nodes within D, which are then "
        "moved)";
  return report;
}

}  // namespace

ReadyMesh with_level0_map(const par::Comm& comm, GivenMesh mesh, const refine::Options& options) {
  const bool has_map = mesh.get().info.level0 != nullptr;
  const bool is_wanted = options.project && (has_map || curved::needs_level0_map(comm, mesh.get(), options.bend));
  if (has_map == is_wanted) {
    curved::Level0Report report;
    if (!has_map && options.project && options.bend != refine::Bend::none)
      report.trouble = curved::trouble_without_map(comm, mesh.get());
    return {std::move(mesh), std::move(report)};
  }
  auto own = std::move(mesh).take();
  if (has_map) {
    mesh::drop_level0(own);
    return {std::move(own), {}};
  }
  auto report = make_map(comm, own, options.bend);
  return {std::move(own), std::move(report)};
}

ReadyMesh with_level0_map(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags,
                          const refine::Options& options) {
  const bool splits = std::any_of(flags.begin(), flags.end(), [](std::int8_t flag) { return flag > 0; });
  if (mesh.get().info.level0 == nullptr && !comm.any(splits)) return {std::move(mesh), {}};
  return with_level0_map(comm, std::move(mesh), options);
}

void make_level0(mesh::DistMesh& mesh) {
  mesh::drop_level0(mesh);
  std::fill(mesh.lineage.begin(), mesh.lineage.end(), mesh::Lineage{});
  mesh.info.cut_faces_conform = false;
}

void drop_level0_map_of_level0(const par::Comm& comm, mesh::DistMesh& mesh) {
  if (mesh.info.level0 == nullptr) return;
  const auto is_split = [](mesh::Lineage lineage) { return lineage.level() > 0 || lineage.is_closure(); };
  if (!comm.any(std::any_of(mesh.lineage.begin(), mesh.lineage.end(), is_split))) mesh::drop_level0(mesh);
}

}  // namespace pamr::adapt
