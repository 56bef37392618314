// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

using LocalEdge = std::pair<std::int32_t, std::int32_t>;  ///< nodes, the smaller one first
using LocalFace = std::array<std::int32_t, 3>;            ///< nodes, ascending

LocalEdge edge_between(std::int32_t a, std::int32_t b);
LocalFace face_of(const RawMesh& mesh, std::int32_t cell, int slot);
std::array<LocalEdge, 3> edges_of(const LocalFace& face);
geometry::Vec3 middle_of(const RawMesh& mesh, LocalEdge edge);

/// A cell with two faces on one piece: the edge they share, and the one inside.
struct Ear {
  std::int32_t cell = 0;
  int piece = 0;
  LocalEdge outer, inner;
  std::array<int, 2> shown{}, hidden{};  ///< slots of the two faces on the piece, and of the other two
};

/// The cells with exactly two of `faces`, both on one piece, ascending. Local.
std::vector<Ear> find_ears(const RawMesh& mesh, std::span<const BoundaryFace> faces);

}  // namespace pamr::meshing
