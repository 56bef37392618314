// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/adapt/given_mesh.hpp"
#include "pamr/curved/make_level0_map.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// A mesh that can be split.
struct ReadyMesh {
  GivenMesh mesh;
  curved::Level0Report level0;
};

/// A mesh of level 0 gets the map that places new nodes near coarse walls, if it needs one (`curved::make_level0_map`):
/// of one that is lent a copy. Its nodes that lie off their surfaces (`curved::distances_off_walls`) are put onto them
/// first, as far as all cells stay positive. Where nothing is put onto surfaces a map is dropped. Collective.
ReadyMesh with_level0_map(const par::Comm& comm, GivenMesh mesh, const refine::Options& options);

/// The same where some cell shall be split (a flag above 0): without a map another mesh stays as it is. Collective.
ReadyMesh with_level0_map(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags,
                          const refine::Options& options);

/// Makes cells of level 0 of all cells: they have neither ancestors nor a map any more. Local.
void make_level0(mesh::DistMesh& mesh);

/// Drops the map where all cells are of level 0 again: then it is made anew when they are split. Collective.
void drop_level0_map_of_level0(const par::Comm& comm, mesh::DistMesh& mesh);

}  // namespace pamr::adapt
