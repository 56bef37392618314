// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "solvers/dsmc/kernel/flux_planes.hpp"
#include "solvers/dsmc/kernel/inner_wall.hpp"

namespace pamr::dsmc {

/// A part of space that is filled with a stream's gas at the start: a sphere if `radius` is positive, otherwise a box.
struct Region {
  Vec3 low, high;  ///< m
  Vec3 center;     ///< m
  double radius = 0;
  int stream = 0;

  bool holds(Vec3 p) const {
    if (radius > 0) return norm(p - center) <= radius;
    return geometry::Box{low, high}.contains(p);
  }
};

inline Vec3 centroid_of(const geometry::TetPoints& corner) {
  return 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
}

/// Everything that a computation needs in addition to the mesh, in SI units.
struct Setup {
  Gas gas;
  std::vector<Stream> stream;            ///< the first is the free stream
  std::vector<BoundaryCondition> patch;  ///< one for each patch of the mesh, then those of sides of walls inside
  std::vector<mesh::Patch> patches;      ///< their names; empty: those of the mesh, of which none is a wall inside
  std::vector<InnerWall> inner_wall;
  int initial = 0;               ///< stream that fills the domain at the start; -1: vacuum
  std::vector<Region> region;    ///< filled differently at the start; where they overlap the last one counts
  std::vector<FluxPlane> plane;  ///< through which molecules are counted
  CollisionOptions collisions;
  double fnum = 1;              ///< F_num: real molecules per particle where the time step is `dt`
  double dt = 0;                ///< s, the largest time step
  std::vector<double> cell_dt;  ///< s, of each own cell; empty: `dt` in all. F_num varies with it
  double mean_dt_ratio = 1;     ///< `dt` over the cell's time step, mean over the volume
  double unit = 1;              ///< meters in the mesh's length unit
  std::uint64_t seed = 1;
  double expected_particles = 0;  ///< in a domain full of free stream (with `from_fields`: of the gas in the fields)

  /// The patches that the conditions are of.
  const std::vector<mesh::Patch>& patches_on(const mesh::DistMesh& mesh) const {
    return patches.empty() ? mesh.info.patches : patches;
  }

  /// The region that fills a cell with these corners at the start; -1: none.
  int region_at_start(const geometry::TetPoints& corner) const {
    const auto center = centroid_of(corner);
    for (auto r = static_cast<int>(region.size()) - 1; r >= 0; --r)
      if (region[static_cast<std::size_t>(r)].holds(center)) return r;
    return -1;
  }

  /// The stream that does; null: vacuum.
  const Stream* stream_at_start(const geometry::TetPoints& corner) const {
    const int found = region_at_start(corner);
    const int which = found < 0 ? initial : region[static_cast<std::size_t>(found)].stream;
    return which < 0 ? nullptr : &stream[static_cast<std::size_t>(which)];
  }
};

}  // namespace pamr::dsmc
