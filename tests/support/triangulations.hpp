// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::testing {

/// An icosahedron in the unit sphere, each triangle split into four `levels` times with all points on the sphere:
/// 20 * 4^levels triangles, seen counter-clockwise from outside.
geometry::Triangulation icosphere(int levels);
/// The cube [-1, 1]^3 with a round hole of radius 0.5 along z, its circle made of `n` chords (a multiple of 4), walls
/// as a CAD program exports them: no points between the two rims.
geometry::Triangulation bored_cube(int n);
/// Two caps of spheres, of this height each, on the unit circle of z = 0 with `n` chords: rings of `n` points, equally
/// far from each other, so that triangles are thin towards the tops.
geometry::Triangulation lens(int n, int n_rings, double height);

/// The same surface as the text or the bytes of a file.
std::string as_stl_text(const geometry::Triangulation& surface);
std::string as_stl_bytes(const geometry::Triangulation& surface);
std::string as_obj(const geometry::Triangulation& surface);
std::string as_off(const geometry::Triangulation& surface);
std::string as_ply_text(const geometry::Triangulation& surface);
std::string as_ply_bytes(const geometry::Triangulation& surface);

}  // namespace pamr::testing
