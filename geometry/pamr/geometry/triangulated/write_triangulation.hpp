// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// How triangles are written down. All keep every bit of a coordinate but `stl_single`.
enum class SurfaceFormat {
  stl,         ///< text; points are not shared
  stl_single,  ///< bytes, single precision; points are not shared
  obj,         ///< text
  ply,         ///< bytes, double precision
  off,         ///< text
};

/// The format that the extension of a name says, in either case: .stl (text), .obj, .ply, .off. Throws `Error` for
/// others.
SurfaceFormat surface_format_of(const std::filesystem::path& file);

/// The parts of a file, one after another: head, points, triangles, end. Points of formats that do not share them, and
/// corners of those that do, are ignored. Numbers of points count from 0. Pre: what PLY can count, fewer than 2^31.
std::string surface_head(SurfaceFormat format, std::int64_t n_points, std::int64_t n_triangles);
void append_points(std::string& text, SurfaceFormat format, std::span<const Vec3> points);
void append_triangle(std::string& text, SurfaceFormat format, const std::array<std::int64_t, 3>& point,
                     const std::array<Vec3, 3>& corner);
std::string surface_end(SurfaceFormat format);

/// A whole file. Local; linear.
std::string to_bytes(const Triangulation& surface, SurfaceFormat format);

}  // namespace pamr::geometry
