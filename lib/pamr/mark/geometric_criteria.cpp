// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/geometric_criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mark {

namespace {

constexpr double wanted = std::numeric_limits<double>::infinity();

template <class Predicate>
Indicator cells_where(const mesh::DistMesh& mesh, Predicate&& holds) {
  Indicator indicator(mesh.cell_to_node.size(), 0);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    if (holds(cell)) indicator[at(cell)] = wanted;
  return indicator;
}

/// The patches for which the name stands.
std::vector<int> patches_of(const mesh::DistMesh& mesh, std::string_view name) {
  const auto& patches = mesh.info.patches;
  auto named = mesh::find_patches(patches, std::string(name));
  if (!named.empty()) return named;
  throw Error(
      fmt::format("expected the name of a patch (the mesh has: {}), found \"{}\"", mesh::list_patches(patches), name));
}

}  // namespace

Indicator all_cells(const mesh::DistMesh& mesh) { return Indicator(mesh.cell_to_node.size(), wanted); }

Indicator crossing_sphere(const mesh::DistMesh& mesh, const Sphere& sphere) {
  return cells_where(mesh, [&](LocalId cell) {
    double least = std::numeric_limits<double>::infinity(), greatest = 0;
    for (const auto corner : mesh.points(cell)) {
      const double distance = geometry::norm(corner - sphere.center);
      least = std::min(least, distance);
      greatest = std::max(greatest, distance);
    }
    return least < sphere.radius && sphere.radius < greatest;
  });
}

Indicator centroid_in_shell(const mesh::DistMesh& mesh, const Sphere& sphere, double width) {
  return cells_where(mesh, [&](LocalId cell) {
    return std::abs(geometry::norm(centroid(mesh, cell) - sphere.center) - sphere.radius) < width;
  });
}

Indicator centroid_in_box(const mesh::DistMesh& mesh, geometry::Vec3 low, geometry::Vec3 high) {
  const geometry::Box box{low, high};
  return cells_where(mesh, [&](LocalId cell) { return box.contains(centroid(mesh, cell)); });
}

Indicator near_patch(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view patch, Exact<int> layers) {
  const auto wanted_patches = patches_of(mesh, patch);
  const mesh::InnerPatches patches(mesh);
  if (layers < 1) throw Error(fmt::format("expected at least 1 layer of cells, found {}", layers));
  auto indicator = cells_where(mesh, [&](LocalId cell) {
    bool is_at = false;
    for (int slot = 0; slot < 4; ++slot)
      is_at = is_at || std::find(wanted_patches.begin(), wanted_patches.end(), patches.of_any({cell, slot})) !=
                           wanted_patches.end();
    return is_at;
  });
  if (layers == 1) return indicator;

  const auto borders = mesh::find_borders(comm, mesh);
  const par::Exchange exchange(comm, borders.nodes);
  std::vector<std::uint8_t> node_flag(mesh.node_position.size(), 0);
  for (int layer = 1; layer < layers; ++layer) {
    for (std::size_t cell = 0; cell < indicator.size(); ++cell)
      if (indicator[cell] > 0)
        for (const LocalId node : mesh.cell_to_node[cell]) node_flag[at(node)] = 1;
    par::fold_flags(exchange, node_flag);
    bool is_any_new = false;
    for (std::size_t cell = 0; cell < indicator.size(); ++cell) {
      if (indicator[cell] > 0) continue;
      for (const LocalId node : mesh.cell_to_node[cell])
        if (node_flag[at(node)] != 0) indicator[cell] = wanted;
      is_any_new = is_any_new || indicator[cell] > 0;
    }
    if (!comm.any(is_any_new)) break;
  }
  return indicator;
}

}  // namespace pamr::mark
