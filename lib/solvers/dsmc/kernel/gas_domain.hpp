// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// The four face planes of a cell: outside of face f where x nx[f] + y ny[f] + z nz[f] > d[f]. Unit normals.
struct alignas(32) CellPlanes {
  std::array<double, 4> nx, ny, nz, d;

  Vec3 normal(int face) const {
    const auto f = static_cast<std::size_t>(face);
    return {nx[f], ny[f], nz[f]};
  }
  /// Distance to the plane of the face, positive inside.
  double depth(int face, Vec3 p) const {
    const auto f = static_cast<std::size_t>(face);
    return d[f] - (nx[f] * p.x + ny[f] * p.y + nz[f] * p.z);
  }
};

/// A face of the domain's boundary.
struct BoundaryFace {
  LocalId cell = 0;
  int slot = 0;
  int patch = 0;
  double area = 0;               ///< m2
  Vec3 normal;                   ///< unit, out of the gas
  std::array<Vec3, 3> corner{};  ///< m
  LocalId across = -1;           ///< of a periodic patch: where the way goes on, as in `Domain::link`
};

/// What particles need of a rank's part of a mesh, in meters: 148 bytes a cell besides the mesh. The planes of a face
/// are the exact negatives of one another in its two cells, on all ranks, because they are computed from the nodes in
/// the order of their global numbers: a particle that has passed a face cannot turn back through it by rounding.
struct Domain {
  std::vector<CellPlanes> planes;
  /// n_cells x 4: an own cell, a face ghost (n_cells + k: face k of the rank border), or -(b+1): boundary face b.
  std::vector<std::array<LocalId, 4>> link;
  std::vector<double> volume;     ///< m3
  std::vector<double> dt;         ///< s
  std::vector<double> molecules;  ///< real molecules that one particle stands for; over dt the same in every cell
  /// Global numbers of the cells, counted from the mesh's first (`MeshInfo::first_id`), so that they begin at 0.
  std::vector<GlobalId> cell_global;
  std::vector<BoundaryFace> boundary;
  std::vector<Vec3> shift;  ///< of each patch, m: what goes on across a periodic one is shifted by it; empty: none is
  bool uniform_dt = true;

  std::vector<Rank> border_rank;  ///< as in DistMesh; periodic faces whose partners lie elsewhere come after the mesh's
  std::vector<std::size_t> border_offset{0};
  std::vector<mesh::CellFace> border_face;

  LocalId n_cells() const { return static_cast<LocalId>(planes.size()); }
};

/// Global numbers of a rank's cells less that of the mesh's first.
std::vector<GlobalId> cells_from_0(const mesh::DistMesh& mesh);

/// Corners of a cell in meters.
geometry::TetPoints corners(const mesh::DistMesh& mesh, double unit, LocalId cell);

/// Builds the domain of a mesh whose length unit is `unit` meters, with the same time step and weight in all cells.
/// Local. O(cells) time.
Domain make_domain(const mesh::DistMesh& mesh, double unit, double dt, double molecules);

/// Checks that `position` is in the cell to within `tolerance` meters.
bool is_inside(const Domain& domain, LocalId cell, Vec3 position, double tolerance);

}  // namespace pamr::dsmc
