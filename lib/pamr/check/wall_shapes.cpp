// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/wall_shapes.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/tet_shape.hpp"

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
  WallShapes result;
  const auto is_wall = described_walls(mesh.info);
  if (is_wall.empty()) return result;  // on all ranks
  std::vector<LocalId> worst;
  std::int64_t n_below = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& slots = mesh.cell_to_cell[at(c)];
    if (std::none_of(slots.begin(), slots.end(),
                     [&](LocalId slot) { return slot < 0 && is_wall[at(mesh::slot_to_patch(slot))]; }))
      continue;
    const double ratio = geometry::mean_ratio(mesh.points(c));
    n_below += ratio < limit ? 1 : 0;
    if (ratio < result.smallest) worst.clear();
    if (ratio <= result.smallest) worst.push_back(c);
    result.smallest = std::min(result.smallest, ratio);
  }
  result.n_below = comm.sum(n_below);
  const double here = result.smallest;
  result.smallest = comm.min(here);
  if (!comm.any(!worst.empty())) return result;
  if (here > result.smallest) worst.clear();
  const auto centroid = [&](LocalId c) {
    const auto p = mesh.points(c);
    return 0.25 * (p[0] + p[1] + p[2] + p[3]);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto c : worst) least = std::min(least, centroid(c)[k]);
    result.where[k] = comm.min(least);
    worst.erase(
        std::remove_if(worst.begin(), worst.end(), [&](LocalId c) { return centroid(c)[k] != result.where[k]; }),
        worst.end());
  }
  return result;
}

double limit_of_lost_shape(const WallShapes& before) {
  constexpr double kept = 0.7, poor = 0.2;
  return std::min(poor, kept * before.smallest);
}

}  // namespace pamr::check
