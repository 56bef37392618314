// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "pamr/curved/optimize_bulges.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"

/// Cells around walls that are coarse for their curvature, for tests of what bends their edges.
namespace pamr::test {

/// A mesh that every rank holds whole.
struct WholeCells {
  std::vector<geometry::Vec3> node;
  std::vector<std::array<std::size_t, 4>> cell;
};

/// Layers of prisms, in three cells each, between icosahedra on spheres of radii 1, 1.3, 1.8, 2.6 and 4 about the
/// origin: 240 cells, edges on the inner sphere longer than its radius.
WholeCells icosahedral_shell();

/// All cells as one zone without bulges or freedom, edges in ascending order of their nodes. `edge_to_node` as well.
struct WholeZone {
  curved::BulgeZone zone;
  std::vector<std::array<std::size_t, 2>> edge_to_node;
};
WholeZone zone_of(const WholeCells& cells);

/// The shell's zone: edges on its two spheres have their bulges, all others are free; with the residual of the walls.
curved::BulgeZone shell_zone();

/// What this rank holds of a whole zone without residual or with, cells drawn for the ranks below `n_owners` and all
/// numbering at random; with the number in the whole zone of each of its edges.
struct PartOfZone {
  curved::BulgeZone zone;
  std::vector<LocalId> edge_in_whole;
};
PartOfZone part_of(const par::Comm& comm, const curved::BulgeZone& whole, std::uint64_t seed, Rank n_owners);

}  // namespace pamr::test
