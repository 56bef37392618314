// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/mirrors.hpp"

#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input) {
  const auto& patches = domain.mesh->info.patches;
  const auto n = patches.size();
  std::vector<std::int64_t> common(n * n, 0);
  for (std::size_t i = 0; i < domain.point.size(); ++i) {
    if (!domain.nodes.is_owned(i) || domain.node_patches[i] == 0) continue;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = 0; q < n; ++q)
        if (p != q && (domain.node_patches[i] >> p & 1U) != 0 && (domain.node_patches[i] >> q & 1U) != 0)
          ++common[p * n + q];
  }
  comm.sum_in_place(common);
  std::vector<Mirrors> result(n);
  std::vector<int> n_mirrors(3 * n, 0);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < n; ++q) {
      const auto* b = input.find_boundary(patches[q].name);
      const int axis = domain.patches[q].axis;
      if (common[p * n + q] == 0 || b == nullptr || b->condition != Condition::symmetry || axis < 0) continue;
      if (domain.patches[p].axis == axis) continue;
      ++n_mirrors[3 * p + at(axis)];
    }
  for (std::size_t p = 0; p < n; ++p)
    for (int axis = 0; axis < 3; ++axis)
      if (n_mirrors[3 * p + at(axis)] == 1) {
        result[p].cut[axis] = true;
        result[p].factor *= 2;
      }
  return result;
}

}  // namespace pamr::poisson_boltzmann
