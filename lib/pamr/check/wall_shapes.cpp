// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/wall_shapes.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/worst_place.hpp"

namespace pamr::check {
namespace {

/// By patch: whether it lies on a surface; empty where none of these is curved.
std::vector<bool> described_walls(const mesh::MeshInfo& info) {
  std::vector<bool> result;
  bool has_curved = false;
  for (const auto& patch : info.patches) {
    const auto* surface = info.surfaces->get(patch.surface);
    result.push_back(surface != nullptr);
    if (surface != nullptr && !surface->is_flat()) has_curved = true;
  }
  if (!has_curved) result.clear();
  return result;
}

}  // namespace

WallShapes wall_shapes(const par::Comm& comm, const mesh::DistMesh& mesh, double limit) {
  const auto is_wall = described_walls(mesh.info);
  if (is_wall.empty()) return {};  // on all ranks
  mesh::WorstPlaces worst;
  std::int64_t n_below = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& slots = mesh.cell_to_cell[at(c)];
    if (std::none_of(slots.begin(), slots.end(),
                     [&](LocalId slot) { return slot < 0 && is_wall[at(mesh::slot_to_patch(slot))]; }))
      continue;
    const auto p = mesh.points(c);
    const double ratio = geometry::mean_ratio(p);
    n_below += ratio < limit ? 1 : 0;
    worst.add(ratio, geometry::centroid(p));
  }
  const auto [smallest, where] = worst.over(comm);
  return {smallest, where, comm.sum(n_below)};
}

double limit_of_lost_shape(const WallShapes& before) {
  constexpr double kept = 0.7, poor = 0.2;
  return std::min(poor, kept * before.smallest);
}

}  // namespace pamr::check
