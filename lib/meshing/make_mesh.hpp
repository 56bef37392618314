// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "meshing/mesh_case.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// Gets progress, warnings and notes; called on rank 0 only.
struct Listener {
  static constexpr int n_steps = 3;
  std::function<void(int steps_done, const char* next_step)> progress = [](int, const char*) {};
  std::function<void(const std::string&)> warn = [](const std::string&) {};
  std::function<void(const std::string&)> note = [](const std::string&) {};  ///< of time, names, pieces
};

/// A mesh of level 0; its wall ears are opened.
struct LevelZero {
  mesh::DistMesh mesh;
  double body_volume = 0;                         ///< of the body that was meshed, where that is known
  std::vector<double> region_volumes = {};        ///< of the solids of each region that has a name; 0: not known
  std::int64_t split_edges = 0, split_faces = 0;  ///< by `open_wall_ears`
};

/// Meshes a case. Rank 0 works while the others wait. If edges of the wanted length cannot resolve a narrow gap, it
/// meshes again with shorter ones in the gaps, and warns. Collective; the same mesh for any number of ranks.
/// Throws `Error` on every rank where the case cannot be meshed.
LevelZero make_mesh(const par::Comm& comm, const MeshCase& mesh_case, const Listener& listener = {});

/// The unit cube in n x n x n cubes of six cells. Collective.
LevelZero make_kuhn_cube(const par::Comm& comm, int n);

/// What a mesh is like; the same on every rank.
struct MeshSummary {
  double min_mean_ratio = 1;
  double volume = 0;
  std::vector<double> region_volumes;  ///< of each region that has a name
  std::vector<std::int64_t> faces;     ///< of each patch, on the boundary and inside
};
/// Collective: four reductions.
MeshSummary summary_of(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::meshing
