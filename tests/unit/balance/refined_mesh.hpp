// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/hash.hpp"
#include "support/meshes.hpp"

namespace pamr::test {

/// A random mesh refined twice with random marks, so that it holds regular cells and closure families of both kinds;
/// with cell and node fields of both types. The same on any number of ranks.
inline mesh::DistMesh refined_mesh(const par::Comm& comm, std::uint64_t seed) {
  auto mesh = assemble::assemble(comm, random_mesh(comm, seed, 3));
  for (std::uint64_t level = 0; level < 2; ++level) {
    std::vector<std::uint8_t> flags;
    for (const auto id : mesh.cell_global)
      flags.push_back(combine(seed + level, static_cast<std::uint64_t>(id)) % 12 == 0 ? 1 : 0);
    mesh = adapt::refine(comm, mesh, flags, {.marks_field = ""}).mesh;
  }
  std::vector<double> vectors, potential;
  std::vector<std::int64_t> pairs;
  for (const auto id : mesh.cell_global) {
    const auto x = static_cast<double>(id);
    vectors.insert(vectors.end(), {x, 0.5 * x, -x});
  }
  for (const auto id : mesh.node_global) {
    potential.push_back(1.0 / static_cast<double>(id + 1));
    pairs.insert(pairs.end(), {id, -id});
  }
  mesh.cell_fields.push_back({"velocity", "m/s", 3, mesh::StorageType::float32, std::move(vectors)});
  mesh.node_fields.push_back({"potential", "V", 1, mesh::StorageType::float64, std::move(potential)});
  mesh.node_fields.push_back({"pair", "", 2, mesh::StorageType::int32, std::move(pairs)});
  return mesh;
}

/// A rank for each cell by its number, whole families together. `n_used`: ranks that get any.
inline std::vector<Rank> random_ranks(const mesh::DistMesh& mesh, std::uint64_t seed, Rank n_used) {
  std::vector<Rank> rank;
  for (std::size_t c = 0; c < mesh.cell_global.size(); ++c) {
    const auto lineage = mesh.lineage[c];
    const auto first = c - (lineage.is_removable() ? static_cast<std::size_t>(lineage.child()) : 0);
    rank.push_back(static_cast<Rank>(combine(seed, static_cast<std::uint64_t>(mesh.cell_global[first])) %
                                     static_cast<std::uint64_t>(n_used)));
  }
  return rank;
}

}  // namespace pamr::test
