// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "random_case.hpp"
#include "support/meshes.hpp"

/// What the tests of coarsening share.
namespace pamr::test {

inline constexpr std::int8_t go = -1;

inline std::vector<std::int8_t> all_may_go(const mesh::DistMesh& mesh) {
  return std::vector<std::int8_t>(at(mesh.n_cells()), go);
}

inline std::vector<std::int8_t> with_sign(const std::vector<std::uint8_t>& split) {
  return {split.begin(), split.end()};
}

/// The unit cube of random cells whose patch zmin is tied to a sphere that bulges into it by `bulge`.
inline mesh::BlockMesh bulging_cube(const par::Comm& comm, std::uint64_t seed, double bulge) {
  auto block = random_mesh(comm, seed, 3);
  const double radius = (0.5 + bulge * bulge) / (2 * bulge);
  block.info.surfaces = surfaces_of("[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, " +
                                    std::to_string(bulge - radius) + "]\nradius = " + std::to_string(radius) + "\n");
  for (auto& patch : block.info.patches)
    if (patch.name == "zmin") patch.surface = 0;
  return block;
}

/// Cells near the dome and a part of the others, by place.
inline std::vector<std::uint8_t> near_dome(const mesh::DistMesh& mesh, double height) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    flags.push_back(0.25 * (p[0].z + p[1].z + p[2].z + p[3].z) < height ? 1 : 0);
  }
  return flags;
}

}  // namespace pamr::test
