// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pamr/locate/locator.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::python {

/// What Python holds of a mesh. Arrays of Python show its memory, so nothing that they may show is ever freed before
/// it.
struct PythonMesh {
  std::shared_ptr<const par::Comm> comm;
  mesh::DistMesh mesh;
  std::vector<GlobalId> node_origin;  ///< of each node its number in the arrays it was made of; empty: its number
  std::vector<mesh::Field> retired;   ///< fields that were replaced or removed
  std::unique_ptr<locate::Locator> locator;  ///< made when it is first needed
};

/// Arrays as Python hands them over, the same on every rank but for the values; rows follow one another over the ranks.
struct MeshArrays {
  std::vector<geometry::Vec3> points;
  std::vector<std::array<GlobalId, 4>> cells;  ///< rows of all points
  mesh::BoundaryTriangles boundary;
  std::vector<mesh::Patch> patches;
  std::vector<mesh::Field> cell_fields, node_fields;
  std::string length_unit;
};

enum class Order : std::uint8_t { automatic, keep, curve };

/// A valid mesh from arrays: inverted cells are turned over, and cells and nodes are put in order along a curve where
/// that pays, or as told. Also the number of cells that were turned. Collective. Throws `Error` on every rank.
std::pair<std::shared_ptr<PythonMesh>, std::int64_t> mesh_from_arrays(std::shared_ptr<const par::Comm> comm,
                                                                      MeshArrays arrays, Order order);

/// Puts a field into the mesh, in the memory of the one that it replaces where that fits. Local.
void put_field(PythonMesh& mesh, bool on_cells, mesh::Field field);
/// Takes a field out of the mesh; its memory stays. Local.
void remove_field(PythonMesh& mesh, bool on_cells, const std::string& name);

/// Positions of this rank's canonical block of the nodes. Collective.
std::vector<geometry::Vec3> node_block(const PythonMesh& mesh);

}  // namespace pamr::python
