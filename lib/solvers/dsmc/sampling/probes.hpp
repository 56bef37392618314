// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/sampling/wall_averages.hpp"

namespace pamr::dsmc {

/// A band of the walls around the x axis, for instance a thermocouple. Meters.
struct Station {
  std::string name;
  double x = 0, r = 0, half_width = 0;
};

/// Points in the gas at equal distances, meters.
struct ProbeLine {
  std::string name;
  Vec3 from, to;
  std::int64_t n_points = 1;
};

/// A grid of points in the gas: `n_along` x `n_across` of them, from a corner to the ends of two edges, meters.
struct ProbePlane {
  std::string name;
  Vec3 corner, along, across;
  std::int64_t n_along = 2, n_across = 2;
};

/// CSV rows of p and q at the stations: means, weighted by area, over the wall faces whose center lies within
/// `half_width` of the circle (x, r) around the x axis; if there is none, of the nearest face. `faces`: of this rank.
/// Text on rank 0, empty elsewhere. Collective: one sparse exchange. Memory on rank 0: the wall faces of all ranks.
std::string station_rows(const par::Comm& comm, const std::vector<Station>& stations,
                         const std::vector<FaceRow>& faces);

/// A point in the gas at which the flow is written.
struct ProbePoint {
  std::string name;
  double s = 0;  ///< m, distance from the start of the line, or along the first edge of the plane
  Vec3 at;       ///< m
};

/// The points of the lines, then those of the planes, whose first edge varies fastest. Local.
std::vector<ProbePoint> points_of(const std::vector<ProbeLine>& lines, const std::vector<ProbePlane>& planes);

/// Fields of a flow on the cells of its mesh. Only references.
struct FlowFields {
  const mesh::DistMesh& mesh;
  double unit = 1;  ///< of the mesh, m
  const GasDomain& domain;
  const std::vector<mesh::CellField>& fields;
};

/// CSV rows of the fields at the points: the values of the cell that contains a point (on a face, of the cell with the
/// smallest number), no rows for a point outside the domain. Text on rank 0, empty elsewhere. Collective: one sparse
/// exchange. O(cells log points + points in the cells' extents along x).
std::string point_rows(const par::Comm& comm, const std::vector<ProbePoint>& points, const FlowFields& flow);

inline constexpr const char* probe_header = "name,s,x,y,z,quantity,value,stderr\n";

}  // namespace pamr::dsmc
