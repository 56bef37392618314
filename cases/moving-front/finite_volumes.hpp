// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <pamr/pamr.hpp>
#include <vector>

/// Finite volumes for dc/dt + velocity . grad c = 0 on a mesh of PAMR: cells, their neighbors across faces, and the
/// cells behind faces between ranks (ghosts).
namespace front {

using pamr::LocalId;
using pamr::geometry::Vec3;

/// What a cell is to its neighbors: its value, and the slopes by which the value changes away from its centroid.
struct Cell {
  double value = 0;
  Vec3 slope;
};

/// Linear in each cell, upwind at faces: second order in space where the solution is smooth. Slopes are those of least
/// squares over the neighbors across faces, limited so that no face has a value beyond those of the cells around (T.
/// Barth and D. Jespersen, The design and application of upwind schemes on unstructured meshes, AIAA 89-0366). What
/// flows in has the value 0.
///
/// Each cell adds up its faces in their order, so that results are the same, bit for bit, on any number of ranks.
class FiniteVolumes {
 public:
  /// Volumes, centroids and areas; keeps a reference to the mesh. Collective.
  FiniteVolumes(const pamr::par::Comm& comm, const pamr::mesh::DistMesh& mesh, Vec3 velocity);

  LocalId n_cells() const { return mesh_.n_cells(); }
  double volume(LocalId cell) const { return volume_[at(cell)]; }
  Vec3 centroid(LocalId cell) const { return centroid_[at(cell)]; }
  const std::vector<Vec3>& centroids() const { return centroid_; }

  /// The largest stable time step, times `courant`. Collective.
  double time_step(double courant) const;
  /// One step by Heun's method, which keeps bounds (two Euler steps, then the mean). Returns what has left through the
  /// boundary on this rank. Collective.
  double advance(double dt, std::vector<double>& value) const;
  /// The slopes, cell by cell. Collective.
  std::vector<Vec3> slopes(const std::vector<double>& value) const;
  /// The largest difference of each cell from a neighbor. Collective.
  std::vector<double> jumps(const std::vector<double>& value) const;

  /// Items of the cells behind the faces between ranks. Collective.
  template <class T>
  std::vector<T> ghosts(const std::vector<T>& of_cell) const {
    return pamr::mesh::ghost_values(comm_, mesh_, of_cell);
  }

 private:
  static std::size_t at(LocalId i) { return static_cast<std::size_t>(i); }
  /// One Euler step.
  double step(double dt, std::vector<double>& value) const;
  Vec3 limited_slope(LocalId cell, const std::vector<double>& value, const std::vector<double>& ghost) const;

  const pamr::par::Comm& comm_;
  const pamr::mesh::DistMesh& mesh_;
  std::vector<double> volume_;
  std::vector<Vec3> centroid_, ghost_centroid_;
  std::vector<std::array<double, 4>> flow_;  ///< volume through each face in a unit of time, positive outwards
  std::vector<std::array<Vec3, 4>> middle_;  ///< of each face
  std::vector<double> outflow_;              ///< of each cell: the sum of what is positive
};

}  // namespace front
