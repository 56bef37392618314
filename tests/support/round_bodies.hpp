// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Coarse meshes of bodies with one patch `wall` on a surface.
namespace pamr::test {

/// The unit ball by 20 cells about its center, with the corners of an icosahedron on the sphere.
mesh::BlockMesh ball(const par::Comm& comm);

/// A solid torus of radii 1 and 0.4: `n_sections` times around, hexagons across.
mesh::BlockMesh solid_torus(const par::Comm& comm, int n_sections);

/// A tetrahedron with corners at distance `outer` around a hole whose four corners lie on the unit sphere about the
/// center: 12 cells, far too coarse for the sphere unless `outer` is large. The outer faces are a patch `boundary` of
/// no surface.
mesh::BlockMesh tetrahedral_shell(const par::Comm& comm, double outer);

/// A random cube with patch `zmin` on a sphere that bulges into it by `bulge`; the other five patches are flat and not
/// described.
mesh::BlockMesh bulging_cube(const par::Comm& comm, std::uint64_t seed, double bulge);

/// The same, its nodes moved along z so that those of `zmin` lie on the sphere.
mesh::BlockMesh domed_cube(const par::Comm& comm, std::uint64_t seed, double bulge);

}  // namespace pamr::test
