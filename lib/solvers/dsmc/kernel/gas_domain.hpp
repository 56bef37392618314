// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/kernel/inner_wall.hpp"

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

/// A face of the domain's boundary, or one side of a wall inside.
struct BoundaryFace {
  LocalId cell = 0;
  int slot = 0;
  int patch = 0;
  double area = 0;               ///< m2
  Vec3 normal;                   ///< unit, out of the gas
  std::array<Vec3, 3> corner{};  ///< m
  LocalId across = -1;           ///< periodic patch: the cell behind the face, as in `GasDomain::link`

  Vec3 center() const { return (1.0 / 3) * (corner[0] + corner[1] + corner[2]); }
};

/// A cell, or a face of the boundary, of another rank.
struct Place {
  std::int32_t neighbor = 0;  ///< index of the rank in `GasDomain::neighbor`
  LocalId number = 0;         ///< of the cell or boundary face there
};

/// What particles need to know of a rank's part of a mesh, in meters; 148 bytes a cell beside the mesh. After the own
/// cells come those of the halo (`add_halo`), in `planes`, `link` and `dt`.
///
/// The two cells of a face hold bitwise opposite planes for it, on all ranks, because planes are computed from the
/// nodes in the order of their global numbers: rounding can never send a particle back through a face.
struct GasDomain {
  std::vector<CellPlanes> planes;
  /// Four each: an own cell; n_cells + k: cell k abroad (before there is a halo: face k of the rank border); -(b+1):
  /// boundary face b, after the own ones those of the halo.
  std::vector<std::array<LocalId, 4>> link;
  std::vector<double> volume;  ///< m3
  std::vector<double> dt;      ///< s
  std::vector<double> fnum;    ///< F_num: real molecules per particle; its ratio to dt is the same in every cell
  /// Global numbers of the cells, counted from the mesh's first (`MeshInfo::first_id`), so that they begin at 0.
  std::vector<GlobalId> cell_global;
  std::vector<BoundaryFace> boundary;
  std::vector<Vec3> shift;  ///< of each patch, m, added to what crosses it; empty: no patch is periodic
  bool uniform_dt = true;

  std::vector<Rank> neighbor;               ///< ranks that particles may come to from here, and come from, ascending
  std::vector<Place> abroad;                ///< the cells of the halo, and after them those behind it
  std::vector<BoundaryFace> halo_boundary;  ///< without cell, area and corners
  std::vector<Place> halo_boundary_place;

  std::vector<Rank> border_rank;  ///< as in DistMesh; periodic faces whose partners lie elsewhere come after the mesh's
  std::vector<std::size_t> border_offset{0};
  std::vector<mesh::CellFace> border_face;

  LocalId n_cells() const { return static_cast<LocalId>(volume.size()); }
  /// `b`: as in `link`.
  const BoundaryFace& boundary_face(std::size_t b) const {
    return b < boundary.size() ? boundary[b] : halo_boundary[b - boundary.size()];
  }
};

/// Global numbers of a rank's cells less that of the mesh's first.
std::vector<GlobalId> cells_from_0(const mesh::DistMesh& mesh);

/// Corners of a cell in meters.
geometry::TetPoints corners(const mesh::DistMesh& mesh, double unit, LocalId cell);

/// The domain of a mesh whose length unit is `unit` meters, with the same time step and F_num in all cells. Faces of
/// `walls` inside part the gas: each of their two cells has a boundary face there. Local. O(cells) time.
GasDomain make_gas_domain(const mesh::DistMesh& mesh, double unit, double dt, double fnum,
                          std::span<const InnerWall> walls = {});

/// True when `position` is in the cell, to within `tolerance` meters. Local.
bool is_inside(const GasDomain& domain, LocalId cell, Vec3 position, double tolerance);

}  // namespace pamr::dsmc
