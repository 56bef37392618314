// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/view_selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/check/extract.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::check {

namespace {

constexpr int finest_grid = 4096;    // boxes a side; a key of three such numbers fits 64 bits
constexpr double near_plane = 1e-6;  // part of the box: more than rounding a view's coordinates moves a node
constexpr double narrowest_window = 1.0 / 1024;  // part of the box

std::array<double, 3> coordinates(geometry::Vec3 p) { return {p.x, p.y, p.z}; }

bool has_finite_corners(const mesh::DistMesh& mesh, LocalId cell) {
  const auto points = mesh.points(cell);
  return std::all_of(points.begin(), points.end(), geometry::is_finite);
}

std::array<LocalId, 3> corners_of(const mesh::DistMesh& mesh, const BoundaryFace& face) {
  std::array<LocalId, 3> node{};
  for (std::size_t i = 0; i < 3; ++i)
    node[i] = mesh.cell_to_node[at(face.cell)][at(mesh::tet::face_to_corner[at(face.slot)][i])];
  return node;
}

bool keeps_its_corners(const mesh::DistMesh& mesh, const NodeNames& names, const BoundaryFace& face) {
  const auto node = corners_of(mesh, face);
  const auto a = names.name(mesh, node[0]), b = names.name(mesh, node[1]), c = names.name(mesh, node[2]);
  return a != b && b != c && c != a;
}

/// Whether a cell touches one of the planes through the middle of the box, inside of the window around it.
bool is_at_planes(const geometry::TetPoints& points, const geometry::Box& box, double window) {
  const auto of_cell = geometry::box_of(points);
  bool is_inside = true, touches = false;
  for (std::size_t d = 0; d < 3; ++d) {
    const double middle = 0.5 * (box.low[d] + box.high[d]), side = box.high[d] - box.low[d];
    const double low = of_cell.low[d], high = of_cell.high[d];
    touches = touches || (low <= middle + near_plane * side && high >= middle - near_plane * side);
    is_inside = is_inside && low <= middle + 0.5 * window * side && high >= middle - 0.5 * window * side;
  }
  return touches && is_inside;
}

}  // namespace

geometry::Box view_box(const par::Comm& comm, const mesh::DistMesh& mesh) {
  geometry::Box box;
  for (const auto p : mesh.node_position)
    if (geometry::is_finite(p)) box.extend(p);
  box = mesh::box_over_ranks(comm, box);
  return box.is_empty() ? geometry::Box{{0, 0, 0}, {0, 0, 0}} : box;
}

std::vector<BoundaryFace> boundary_faces(const mesh::DistMesh& mesh) {
  std::vector<BoundaryFace> faces;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (int slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(cell)][at(slot)];
      if (neighbor >= 0 || mesh::slot_to_patch(neighbor) >= std::ssize(mesh.info.patches)) continue;
      if (has_finite_corners(mesh, cell)) faces.push_back({cell, slot, mesh::slot_to_patch(neighbor)});
    }
  return faces;
}

GlobalId NodeNames::name(const mesh::DistMesh& mesh, Exact<LocalId> node) const {
  if (!are_merged()) return mesh.node_global[at(node)];
  const auto x = coordinates(mesh.point(node));
  GlobalId key = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double side = box_->high[d] - box_->low[d];
    const double place = side > 0 ? (x[d] - box_->low[d]) / side : 0;
    key = key * (finest_grid + 1) + static_cast<GlobalId>(std::floor(place * boxes_));
  }
  return -1 - key;
}

NodeNames merge_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const geometry::Box& box,
                      Exact<std::int64_t> limit, std::vector<BoundaryFace>& faces) {
  NodeNames names(box);
  if (comm.sum(std::ssize(faces)) <= limit) return names;
  for (int boxes = finest_grid; boxes >= 1; boxes = boxes * 4 / 5) {
    names = NodeNames(box, boxes);
    const auto left = std::count_if(faces.begin(), faces.end(),
                                    [&](const BoundaryFace& face) { return keeps_its_corners(mesh, names, face); });
    if (comm.sum(left) <= limit) break;
  }
  std::erase_if(faces, [&](const BoundaryFace& face) { return !keeps_its_corners(mesh, names, face); });
  return names;
}

std::vector<WorstCell> find_worst_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> count) {
  const auto chosen = worst_cells(comm, mesh, count);
  std::vector<WorstCell> here;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    if (chosen[at(cell)] == 0) continue;
    WorstCell worst{mesh.cell_global[at(cell)], geometry::mean_ratio(mesh.points(cell)), {}};
    for (std::size_t i = 0; i < 4; ++i) worst.node[i] = mesh.node_global[at(mesh.cell_to_node[at(cell)][i])];
    here.push_back(worst);
  }
  auto all = par::gather_few(comm, std::move(here));
  const auto value = [](const WorstCell& w) { return std::isnan(w.mean_ratio) ? -2 : w.mean_ratio; };
  std::sort(all.begin(), all.end(), [&](const WorstCell& a, const WorstCell& b) {
    return std::tuple(value(a), a.cell) < std::tuple(value(b), b.cell);
  });
  return all;
}

CellSelection select_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const geometry::Box& box,
                           const std::vector<WorstCell>& worst, const ViewLimits& limits) {
  CellSelection selection;
  selection.is_all = mesh.info.n_global_cells <= limits.all_cells;
  std::vector<GlobalId> near;
  for (const auto& cell : worst) near.insert(near.end(), cell.node.begin(), cell.node.end());
  std::sort(near.begin(), near.end());
  const auto is_near = [&](const mesh::CellNodes& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [&](LocalId node) {
      return std::binary_search(near.begin(), near.end(), mesh.node_global[at(node)]);
    });
  };
  while (true) {
    selection.cell.clear();
    for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
      if (has_finite_corners(mesh, cell) &&
          (selection.is_all || is_at_planes(mesh.points(cell), box, selection.window) ||
           is_near(mesh.cell_to_node[at(cell)])))
        selection.cell.push_back(cell);
    if (selection.is_all || selection.window <= narrowest_window ||
        comm.sum(std::ssize(selection.cell)) <= limits.cut_cells)
      break;
    selection.window *= 0.5;
  }
  return selection;
}

std::vector<OffSurfaceNode> find_off_surface_nodes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                   const std::vector<BoundaryFace>& faces, double tolerance,
                                                   std::int64_t count) {
  std::vector<std::pair<int, LocalId>> of_patch;
  for (const auto& face : faces)
    if (mesh.info.surface_of(face.patch) != nullptr)
      for (const auto node : corners_of(mesh, face)) of_patch.emplace_back(face.patch, node);
  std::sort(of_patch.begin(), of_patch.end());
  of_patch.erase(std::unique(of_patch.begin(), of_patch.end()), of_patch.end());
  std::vector<OffSurfaceNode> off;
  for (const auto& [patch, node] : of_patch) {
    const auto position = mesh.point(node);
    const double distance = mesh.info.surface_of(patch)->distance(position);
    if (distance > tolerance) off.push_back({mesh.node_global[at(node)], patch, distance, position});
  }
  const auto key = [](const OffSurfaceNode& n) { return std::tuple(-n.distance, n.node, n.patch); };
  const auto before = [&](const OffSurfaceNode& a, const OffSurfaceNode& b) { return key(a) < key(b); };
  const auto keep_the_farthest = [&] {
    std::sort(off.begin(), off.end(), before);
    const auto same = [&](const OffSurfaceNode& a, const OffSurfaceNode& b) { return key(a) == key(b); };
    off.erase(std::unique(off.begin(), off.end(), same), off.end());
    if (std::ssize(off) > count) off.resize(at(count));
  };
  keep_the_farthest();
  off = par::gather_few(comm, std::move(off));
  keep_the_farthest();
  return off;
}

}  // namespace pamr::check
