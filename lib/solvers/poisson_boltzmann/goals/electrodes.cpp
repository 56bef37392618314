// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/electrodes.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Centroid of the meshed surface of each. Collective: one reduction.
std::vector<Vec3> centroids(const par::Comm& comm, const Domain& domain, const std::vector<Electrode>& electrodes) {
  std::vector<par::ExactSum> sums(4 * electrodes.size());
  for (const auto& face : domain.faces) {
    Vec3 middle;
    for (const auto node : face.node) middle += (1.0 / 3) * domain.point[at(node)];
    for (std::size_t e = 0; e < electrodes.size(); ++e) {
      if (!electrodes[e].has(face.patch)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) sums[4 * e + axis].add(face.area * middle[axis]);
      sums[4 * e + 3].add(face.area);
    }
  }
  const auto totals = par::reproducible_sums(comm, sums);
  std::vector<Vec3> result(electrodes.size());
  for (std::size_t e = 0; e < electrodes.size(); ++e)
    if (totals[4 * e + 3] > 0)
      result[e] = (1 / totals[4 * e + 3]) * Vec3{totals[4 * e], totals[4 * e + 1], totals[4 * e + 2]};
  return result;
}

}  // namespace

std::vector<Electrode> find_electrodes(const par::Comm& comm, const Domain& domain, const Case& input) {
  const auto& patches = domain.mesh->info.patches;
  std::vector<Electrode> result;
  std::vector<std::optional<Vec3>> stated;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (!input.is_electrode(patches[p].name) || domain.patches[p].n_faces == 0) continue;
    auto& electrode = result.emplace_back();
    electrode.name = patches[p].name;
    electrode.patches = std::uint64_t{1} << p;
    for (const auto& sphere : input.spheres)
      if (sphere.patch == patches[p].name) electrode.sphere = &sphere;
    stated.push_back(electrode.sphere != nullptr ? std::optional(electrode.sphere->center) : std::nullopt);
    for (const auto& body : input.bodies)
      if (body.name == electrode.name && body.center) stated.back() = body.center;
  }
  for (const auto& body : input.bodies) {
    if (input.find_boundary(body.name) != nullptr) continue;  // the patch of that name alone
    auto& electrode = result.emplace_back();
    electrode.name = body.name;
    for (const auto& patch : body.patches)
      electrode.patches |= std::uint64_t{1} << static_cast<unsigned>(domain.patch_number(patch));
    stated.push_back(body.center);
  }

  std::vector<std::uint64_t> sets;
  for (const auto& electrode : result) sets.push_back(electrode.patches);
  const auto mirrors = find_mirrors(comm, domain, input, sets);
  const auto centroid = centroids(comm, domain, result);
  for (std::size_t e = 0; e < result.size(); ++e) {
    result[e].mirrors = mirrors[e];
    result[e].center = stated[e].value_or(centroid[e]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (mirrors[e].cut[axis]) result[e].center[axis] = mirrors[e].level[axis];
  }
  return result;
}

}  // namespace pamr::poisson_boltzmann
