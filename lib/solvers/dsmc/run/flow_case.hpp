// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/dsmc/kernel/flow.hpp"

namespace pamr::dsmc {

/// What forces, moments and heat are made dimensionless with. Drag points along the stream, lift along stream x pitch
/// axis, the moment is that about the pitch axis.
struct Reference {
  double area = 1;    ///< m2
  double length = 1;  ///< m
  Vec3 point;         ///< m: moments are about it
  Vec3 pitch_axis{0, 1, 0};
  double multiplier = 1;             ///< of forces: 2 where the mesh is one half of a symmetric flow
  std::vector<std::string> patches;  ///< whose forces count; empty: all walls
};

/// A band of the walls round the x axis: a thermocouple, say. Meters.
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

/// A case file: what is to be computed, before the mesh is known.
struct Case {
  std::string where;  ///< name of the file
  Gas gas;
  std::vector<Stream> stream;                         ///< the free stream first
  std::map<std::string, BoundaryCondition> boundary;  ///< by patch
  std::map<std::string, std::string> boundary_at;     ///< file and line of each, for messages
  std::map<std::string, std::string> partner;         ///< of periodic patches
  int initial = 0;
  std::vector<Region> region;
  CollisionOptions collisions;
  std::optional<double> weight, per_cell, total;  ///< exactly one of them
  double dt = 0;                                  ///< s
  double cell_fraction = 0;  ///< variable time step: part of a cell that a fast molecule passes; 0: the same dt in all
  double collision_fraction = 0;  ///< variable time step: part of the mean collision time; 0: no bound
  bool from_fields = false;       ///< speed, collision time and density of each cell from the mesh's fields
  std::optional<double> unit;     ///< meters in the mesh's length unit
  std::uint64_t seed = 1;
  std::optional<std::int64_t> transient;  ///< steps before averaging; none: until steady
  std::int64_t most_transient = 100000;   ///< steps: averaging begins then at the latest
  std::int64_t sampling = 1000;           ///< steps
  std::int64_t block = 0;                 ///< steps of a block of the averages; 0: a twentieth of `sampling`
  double stop_error = 0;                  ///< stop when the relative standard error of C_D is below; 0: never
  Reference reference;
  std::vector<Station> station;
  std::vector<ProbeLine> line;
  std::vector<ProbePlane> plane;
};

/// Reads a case file (docs/tools/pamr-dsmc.md). `where` is its name; species may come from a file beside it. Throws
/// `Error` with file and line for TOML errors, unknown keys, wrong types and values out of range. Local.
Case read_case(std::string_view text, const std::string& where);

/// The case on a mesh. Throws `Error` for patches without a condition, conditions without a patch, and a length unit
/// that is not known in meters. Collective.
Setup make_setup(const par::Comm& comm, const Case& the_case, const mesh::DistMesh& mesh);

}  // namespace pamr::dsmc
