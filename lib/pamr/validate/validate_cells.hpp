// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/validate/findings.hpp"

namespace pamr::validate {

/// Smallest mean ratio of a cell; in rounded arithmetic cells that have it are positive, too.
inline constexpr double min_mean_ratio = 1e-8;

/// Whether the mean ratio is at least some 100 times that, told without a root: true of nearly every cell. All six
/// squared edges are at most five times the three at a corner together. False where a coordinate is not finite.
bool is_far_from_flat(const geometry::TetPoints& p);

/// Coordinates, orientation, shape. Local.
void check_shapes(const mesh::DistMesh& mesh, Findings& findings);

/// Patches, own neighbors, own faces. Local.
void check_own_neighbors(const mesh::DistMesh& mesh, Findings& findings);

/// Closure families. Local.
void check_families(const mesh::DistMesh& mesh, Findings& findings);

/// -1 or 1: whether the face's nodes, in the order whose normal points out of the cell, are an odd or even permutation
/// of their ascending global numbers. Cells on the two sides of a face have opposite signs.
int face_sign(const mesh::DistMesh& mesh, mesh::CellFace face);

}  // namespace pamr::validate
