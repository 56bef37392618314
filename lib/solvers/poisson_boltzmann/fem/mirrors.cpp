// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/mirrors.hpp"

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

namespace {

std::uint64_t bit(std::size_t patch) { return std::uint64_t{1} << patch; }

/// Of each patch those that share nodes with it. Collective: one reduction.
std::vector<std::uint64_t> neighbors_of_patches(const par::Comm& comm, const Domain& domain) {
  const auto n = domain.mesh->info.patches.size();
  std::vector<std::int64_t> common(n * n, 0);
  for (const auto node : domain.node_patches) {
    if (node == 0) continue;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = 0; q < n; ++q)
        if (p != q && (node & bit(p)) != 0 && (node & bit(q)) != 0) common[p * n + q] = 1;
  }
  comm.max_in_place(common);
  std::vector<std::uint64_t> result(n, 0);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < n; ++q)
      if (common[p * n + q] != 0) result[p] |= bit(q);
  return result;
}

/// Adds a mirror that cuts the set. Those in one plane, by their levels and the largest coordinate, count once.
void add_mirror(Mirrors& mirrors, const PatchShape& shape, std::size_t patch, double largest) {
  const auto axis = at(shape.axis);
  mirrors.patches |= bit(patch);
  if (mirrors.between[axis]) return;
  if (!mirrors.cut[axis]) {
    mirrors.cut[axis] = true;
    mirrors.level[axis] = shape.level;
    mirrors.factor *= 2;
  } else if (std::abs(mirrors.level[axis] - shape.level) > 1e-9 * largest) {
    mirrors.cut[axis] = false;
    mirrors.between[axis] = true;
    mirrors.factor /= 2;
  }
}

}  // namespace

geometry::Vec3 Mirrors::complete_torque(geometry::Vec3 torque) const {
  const int n = int{vanishes(0)} + int{vanishes(1)} + int{vanishes(2)};
  if (n == 0) return torque;
  geometry::Vec3 result;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (n == 1 && vanishes(axis)) result[axis] = factor * torque[axis];
  return result;
}

std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input,
                                  std::span<const std::uint64_t> sets) {
  const auto& patches = domain.mesh->info.patches;
  const auto neighbors = neighbors_of_patches(comm, domain);
  double largest = 0;
  for (const auto p : domain.point) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  largest = comm.max(largest);
  std::vector<Mirrors> result(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (std::size_t q = 0; q < patches.size(); ++q) {
      if ((sets[s] & bit(q)) != 0) continue;
      const auto& shape = domain.patches[q];
      const auto* b = input.find_boundary(patches[q].name);
      const bool is_mirror = b != nullptr && b->condition == Condition::symmetry && shape.axis >= 0;
      bool touches = false, cuts = false;
      for (std::size_t p = 0; p < patches.size(); ++p) {
        if ((sets[s] & bit(p)) == 0 || (neighbors[p] & bit(q)) == 0) continue;
        touches = true;
        cuts = cuts || (is_mirror && domain.patches[p].axis != shape.axis);
      }
      if (touches) result[s].neighbors |= bit(q);
      if (cuts) add_mirror(result[s], shape, q, largest);
    }
  }
  return result;
}

std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input) {
  std::vector<std::uint64_t> sets;
  for (std::size_t p = 0; p < domain.mesh->info.patches.size(); ++p) sets.push_back(bit(p));
  return find_mirrors(comm, domain, input, sets);
}

}  // namespace pamr::poisson_boltzmann
