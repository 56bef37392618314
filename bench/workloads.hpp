// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::bench {

/// Unit cube of n^3 cubes of 6 tetrahedra, in blocks over the ranks. Collective.
mesh::DistMesh cube(const par::Comm& comm, int n);

/// Makes a tenth of the faces inside of `cube(n)` a patch of their own: the planes between the layers of cubes, three
/// of five. Local.
void tag_planes(mesh::DistMesh& mesh, int n);

/// Cells whose centroid lies within `width` of the sphere of radius `radius` about the middle of the unit cube. Local.
std::vector<std::uint8_t> mark_shell(const mesh::DistMesh& mesh, double radius, double width);

/// Cells cut by the sphere of that radius about the middle: least corner distance < radius < greatest. Local.
std::vector<std::uint8_t> mark_crossing(const mesh::DistMesh& mesh, double radius);
/// The same of any sphere. Local.
std::vector<std::uint8_t> mark_crossing(const mesh::DistMesh& mesh, geometry::Vec3 center, double radius);

/// Cells whose centroid lies in a box. Local.
std::vector<std::uint8_t> mark_box(const mesh::DistMesh& mesh, geometry::Vec3 low, geometry::Vec3 high);

/// Memory of this process now, bytes.
std::size_t resident_bytes();
/// Forgets the peak so far where the system allows it, so that `peak_bytes` means what comes next.
void reset_peak();
/// Peak since the last reset, bytes.
std::size_t peak_bytes();

}  // namespace pamr::bench
