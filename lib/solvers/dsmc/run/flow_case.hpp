// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/mark/criteria.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/sampling/probes.hpp"

namespace pamr::dsmc {

/// How long a computation runs, in steps.
struct Schedule {
  std::optional<std::int64_t> transient;  ///< before averaging; none: until the flow is steady
  std::int64_t max_transient = 100000;    ///< averaging begins then at the latest
  std::int64_t sampling = 1000;           ///< of the averages
  std::int64_t block = 0;                 ///< of a block of the averages; 0: a twentieth of `sampling`
  double stop_error = 0;                  ///< stop once the relative standard error of C_D is below; 0: never
  std::int64_t window = 0;                ///< averages begin anew every so many steps; 0: never
};

/// How a computation adapts its mesh as it goes.
struct Adaptation {
  std::int64_t every = 0;  ///< steps, whole windows of the averages; 0: never
  std::string mark;        ///< the words of the case for the next
  mark::Request request;   ///< which cells to split, and which may be coarsened, by the averages of a window
  std::optional<std::int64_t> max_cells;  ///< of the adapted mesh
};

/// A case file: what is to be computed, before the mesh is known.
struct Case {
  std::string where;  ///< name of the file
  Gas gas;
  std::vector<Stream> stream;                         ///< the free stream first
  std::map<std::string, BoundaryCondition> boundary;  ///< by patch, or by a pattern of names (base/name_pattern.hpp)
  std::map<std::string, std::string> boundary_at;     ///< file and line of each, for messages
  std::map<std::string, std::string> partner;         ///< of periodic patches
  std::map<std::string, Facing> facing;               ///< of patches inside the gas, where the case tells
  int initial = 0;
  std::vector<Region> region;
  std::vector<std::string> region_at;  ///< file and line of each, for messages
  CollisionOptions collisions;
  std::optional<double> weight, per_cell, total;  ///< exactly one of them
  double dt = 0;                                  ///< s
  double cell_fraction = 0;  ///< variable time step: part of a cell that a fast molecule passes; 0: the same dt in all
  double collision_fraction = 0;  ///< variable time step: part of the mean collision time; 0: no bound
  bool from_fields = false;       ///< speed, collision time and density of each cell from the mesh's fields
  std::optional<double> unit;     ///< meters in the mesh's length unit
  std::uint64_t seed = 1;
  Schedule schedule;
  Adaptation adaptation;
  Reference reference;
  std::vector<Station> station;
  std::vector<ProbeLine> line;
  std::vector<ProbePlane> plane;      ///< [[plane]] with `points`
  std::vector<FluxPlane> flux_plane;  ///< [[plane]] without: what passes it is counted

  /// The condition of a patch in these groups: of its own name, of a group, or of the pattern that stands for it. Null
  /// if there is none; throws `Error` if two groups or two patterns stand for it.
  const BoundaryCondition* find_boundary(const std::string& patch, const std::vector<std::string>& groups = {}) const;
};

/// Reads a case file (docs/tools/pamr-dsmc.md). `where` is its name; species may come from a file beside it. Throws
/// `Error` with file and line for TOML errors, unknown keys, wrong types and values out of range. Local.
Case read_case(std::string_view text, const std::string& where);

}  // namespace pamr::dsmc
