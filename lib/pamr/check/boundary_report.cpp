// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/boundary_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/plane_fit.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/par/mailbox.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::check {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A node of a group, by its global number.
struct GroupNode {
  GlobalId node = 0;
  std::int64_t group = 0;
  friend constexpr auto operator<=>(const GroupNode&, const GroupNode&) = default;
};

/// How many different nodes each group has over all ranks. A node meets its copies on a rank chosen by its number.
std::vector<std::int64_t> count_distinct(const par::Comm& comm, const std::vector<GroupNode>& here,
                                         std::size_t n_groups) {
  par::Mailbox<GroupNode> meeting(comm);
  for (const auto& item : here) {
    const auto to = mix(static_cast<std::uint64_t>(item.node)) % static_cast<std::uint64_t>(comm.size());
    meeting.add(static_cast<Rank>(to), item);
  }
  auto met = meeting.send().item;
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  std::vector<std::int64_t> counts(n_groups, 0);
  for (const auto& item : met) ++counts[static_cast<std::size_t>(item.group)];
  comm.sum_in_place(counts);
  return counts;
}

/// A face of a cell: its middle, and its normal as long as twice its area.
struct Facet {
  geometry::Vec3 middle, normal;
};
Facet facet_of(const mesh::DistMesh& mesh, LocalId cell, std::size_t face) {
  const auto p = mesh.points(cell);
  const auto [i, j, k] = mesh::tet::face_to_corner[face];
  const auto a = p[static_cast<std::size_t>(i)], b = p[static_cast<std::size_t>(j)], c = p[static_cast<std::size_t>(k)];
  return {(1.0 / 3) * (a + b + c), cross(b - a, c - a)};
}

/// Angle between two directions, whichever way they point, degrees from 0 to 90; 90 where one is no direction.
double angle_between(geometry::Vec3 a, geometry::Vec3 b) {
  const double along = std::abs(dot(a, b)), across = norm(cross(a, b));
  if (!std::isfinite(along) || !std::isfinite(across) || (along == 0 && across == 0)) return 90;
  return std::atan2(across, along) * 180 / std::numbers::pi;
}

/// Patch of a face of the boundary or inside, of the latter from one side; -1 where it has none of the mesh's.
std::ptrdiff_t patch_of(const mesh::DistMesh& mesh, const mesh::InnerPatches& patches, mesh::CellFace face) {
  const std::ptrdiff_t patch = patches.of_any(face);
  return patch < std::ssize(mesh.info.patches) && patches.is_first_side(face) ? patch : -1;
}

/// Local nodes of each patch, each once.
std::vector<std::vector<LocalId>> nodes_of_patches(const mesh::DistMesh& mesh) {
  std::vector<std::vector<LocalId>> nodes(mesh.info.patches.size());
  const mesh::InnerPatches patches(mesh);
  for (std::size_t cell = 0; cell < mesh.cell_to_cell.size(); ++cell)
    for (std::size_t face = 0; face < 4; ++face) {
      const auto patch = patch_of(mesh, patches, {static_cast<LocalId>(cell), static_cast<int>(face)});
      if (patch < 0) continue;
      auto& of_patch = nodes[static_cast<std::size_t>(patch)];
      for (const int corner : mesh::tet::face_to_corner[face])
        of_patch.push_back(mesh.cell_to_node[cell][static_cast<std::size_t>(corner)]);
    }
  for (auto& list : nodes) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return nodes;
}

/// The worst cells with a face in each patch, of a patch inside on either side. Collective.
void measure_cells_at(const par::Comm& comm, const mesh::DistMesh& mesh, std::vector<PatchReport>& reports) {
  const mesh::InnerPatches patches(mesh);
  std::vector<double> worst(reports.size(), infinity);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (int face = 0; face < 4; ++face) {
      const std::ptrdiff_t patch = patches.of_any({cell, face});
      if (patch < 0 || patch >= std::ssize(reports)) continue;
      const double shape = geometry::mean_ratio(mesh.points(cell));
      auto& smallest = worst[static_cast<std::size_t>(patch)];
      smallest = std::min(smallest, std::isnan(shape) ? 0 : shape);
    }
  for (std::size_t p = 0; p < reports.size(); ++p) {
    const double smallest = comm.min(worst[p]);
    reports[p].min_mean_ratio = smallest < infinity ? smallest : 0;
  }
}

/// Says of each patch without a surface how flat it is, and how far refinements moved its nodes off its faces.
/// Collective.
void measure_undescribed(const par::Comm& comm, const mesh::DistMesh& mesh,
                         const std::vector<std::vector<LocalId>>& nodes, std::vector<PatchReport>& reports) {
  std::vector<bool> is_wanted;
  for (const auto& patch : mesh.info.patches) is_wanted.push_back(patch.surface < 0);
  const auto planes = mesh::fit_planes(comm, mesh, is_wanted);
  const auto* field = mesh.find_node_field(mesh::off_facets_field);
  if (field != nullptr && (field->holds_integers() || field->n_components != 1)) field = nullptr;
  std::vector<GroupNode> moved;
  std::vector<double> worst(reports.size(), 0);
  for (std::size_t p = 0; p < reports.size(); ++p) {
    if (!is_wanted[p]) continue;
    reports[p].is_flat = planes[p].is_flat;
    reports[p].worst_plane_distance = planes[p].distance;
    if (field == nullptr) continue;
    for (const auto node : nodes[p]) {
      const double off = field->real()[static_cast<std::size_t>(node)];
      if (!(off > 0)) continue;
      moved.push_back({mesh.node_global[static_cast<std::size_t>(node)], static_cast<std::int64_t>(p)});
      worst[p] = std::max(worst[p], off);
    }
  }
  if (field == nullptr) return;
  const auto counts = count_distinct(comm, moved, reports.size());
  for (std::size_t p = 0; p < reports.size(); ++p) {
    reports[p].off_facets_nodes = counts[p];
    reports[p].worst_off_facets = comm.max(worst[p]);
  }
}

}  // namespace

double bounding_box_diagonal(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto box = mesh::box_of_nodes(comm, mesh);
  return box.is_empty() ? 0 : box.diagonal();
}

std::vector<PatchReport> measure_patches(const par::Comm& comm, const mesh::DistMesh& mesh, double tolerance) {
  const std::size_t n_patches = mesh.info.patches.size();
  std::vector<const geometry::Surface*> surface;
  for (const auto& patch : mesh.info.patches) surface.push_back(mesh.info.surfaces->get(patch.surface));
  std::vector<par::ExactSum> area(n_patches), turned_area(n_patches);
  std::vector<double> worst_turn(n_patches, 0);
  std::vector<std::int64_t> faces(n_patches, 0);
  const mesh::InnerPatches patches(mesh);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (std::size_t face = 0; face < 4; ++face) {
      const auto patch = patch_of(mesh, patches, {cell, static_cast<int>(face)});
      if (patch < 0) continue;
      const auto p = static_cast<std::size_t>(patch);
      const auto facet = facet_of(mesh, cell, face);
      const double here = 0.5 * norm(facet.normal);
      ++faces[p];
      area[p].add(here);
      if (surface[p] == nullptr) continue;
      const double turn = is_finite(facet.middle) ? angle_between(facet.normal, surface[p]->normal(facet.middle)) : 90;
      worst_turn[p] = std::max(worst_turn[p], turn);
      turned_area[p].add(here * turn);
    }

  const auto nodes = nodes_of_patches(mesh);
  std::vector<double> worst(n_patches, 0);
  std::vector<GroupNode> off;
  for (std::size_t patch = 0; patch < n_patches; ++patch) {
    if (surface[patch] == nullptr) continue;
    for (const LocalId node : nodes[patch]) {
      const auto point = mesh.point(node);
      const double distance = is_finite(point) ? surface[patch]->distance(point) : infinity;
      worst[patch] = std::max(worst[patch], distance);
      if (!(distance <= tolerance))
        off.push_back({mesh.node_global[static_cast<std::size_t>(node)], static_cast<std::int64_t>(patch)});
    }
  }

  const auto total_area = par::reproducible_sums(comm, area), total_turn = par::reproducible_sums(comm, turned_area);
  comm.sum_in_place(faces);
  const auto off_nodes = count_distinct(comm, off, n_patches);
  std::vector<PatchReport> reports;
  for (std::size_t patch = 0; patch < n_patches; ++patch) {
    const auto& info = mesh.info.patches[patch];
    const double worst_of_all = comm.max(worst[patch]);
    const double mean_turn = total_area[patch] > 0 ? total_turn[patch] / total_area[patch] : 0;
    auto& report = reports.emplace_back();
    report.name = info.name;
    report.surface = mesh.info.surface_name(info);
    report.faces = faces[patch];
    report.area = total_area[patch];
    report.worst_distance = worst_of_all;
    report.off_surface_nodes = off_nodes[patch];
    report.mean_normal_deviation = mean_turn;
    report.worst_normal_deviation = comm.max(worst_turn[patch]);
  }
  measure_cells_at(comm, mesh, reports);
  measure_undescribed(comm, mesh, nodes, reports);
  return reports;
}

OffSurface read_off_surface(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto* field = mesh.find_node_field(mesh::off_surface_field);
  if (field == nullptr || field->holds_integers() || field->n_components != 1) return {};
  std::vector<GroupNode> off;
  double worst = 0;
  for (std::size_t node = 0; node < field->real().size(); ++node) {
    if (!(field->real()[node] > 0)) continue;
    worst = std::max(worst, field->real()[node]);
    off.push_back({mesh.node_global[node], 0});
  }
  return {count_distinct(comm, off, 1).front(), comm.max(worst)};
}

}  // namespace pamr::check
