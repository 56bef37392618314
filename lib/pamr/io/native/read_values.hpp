// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/slab_reader.hpp"

/// The parts of the native file that hold values: points, fields, triangulated surfaces. All functions are collective
/// and throw the same `Error` on every rank.
namespace pamr::io {

/// Rows of a dataset of points, finite. Compares the checksum.
std::vector<geometry::Vec3> read_points(SlabReader& reader, const Dataset& dataset, Rows rows);

/// Rows of a field. `verify`: compare the checksum.
mesh::Field read_field(SlabReader& reader, const Layout& layout, const FieldEntry& entry, Rows rows, bool verify);

/// A triangulated surface, whole on every rank: the first one reads it and sends it to the others.
geometry::Triangulation read_triangulation(SlabReader& reader, const TriangulationEntry& entry);

}  // namespace pamr::io
