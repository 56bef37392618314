// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/dsmc/run/run.hpp"
#include "solvers/dsmc/run/wall_file.hpp"
#include "solvers/dsmc/sampling/sample.hpp"

namespace pamr::dsmc {

/// Means of p and q over the faces of the walls whose middle lies within `half_width` of the circle (x, r) about the x
/// axis, weighted by their area; of the nearest face where there is none. Local, for the rank that has the faces.
std::string station_rows(const std::vector<Station>& stations, const std::vector<FaceRow>& faces);

/// A place in the gas at which the flow is shown.
struct ProbePoint {
  std::string name;
  double s = 0;  ///< m: way from the beginning of the line, or along the first edge of the plane
  Vec3 at;       ///< m
};

/// The points of lines, then those of planes, the first edge running fastest.
std::vector<ProbePoint> points_of(const std::vector<ProbeLine>& lines, const std::vector<ProbePlane>& planes);

/// The flow at points: the values of the cell that holds each (the one of the smallest number where it lies on a face),
/// nothing outside the domain. Text on rank 0. Collective. O(cells log points + points in the cells' extents along x).
std::string point_rows(const par::Comm& comm, const std::vector<ProbePoint>& points, const mesh::DistMesh& mesh,
                       double unit, const Domain& domain, const std::vector<CellQuantity>& fields);

inline constexpr const char* probe_header = "name,s,x,y,z,quantity,value,stderr\n";

}  // namespace pamr::dsmc
