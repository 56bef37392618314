// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pamr/locate/locator.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::python {

struct PythonMesh;

/// What keeps the memory of a field that arrays of Python show: the mesh, and the values themselves once they are no
/// longer in it.
struct ShownField {
  std::shared_ptr<const PythonMesh> mesh;
  decltype(mesh::Field::value) values;
};

/// What Python holds of a mesh. Arrays of Python show its memory, which nothing but they themselves writes into: a
/// field that is set gets other memory, and the old one lives as long as the arrays that show it.
struct PythonMesh {
  std::shared_ptr<const par::Comm> comm;
  mesh::DistMesh mesh;
  std::vector<GlobalId> node_origin;  ///< of each node its number in the arrays it was made of; empty: its number
  /// Fields that arrays show, by whether they are on cells and by name.
  std::map<std::pair<bool, std::string>, std::weak_ptr<ShownField>> shown;
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
  std::vector<mesh::Region> regions;  ///< ascending
};

enum class Order : std::uint8_t { automatic, keep, curve };

/// A valid mesh from arrays: inverted cells are turned over where all are or `repair` asks for it (`assemble::orient`),
/// and cells and nodes are put in order along a curve where that pays, or as told. Also the number of cells that were
/// turned. Collective. Throws `Error` on every rank.
std::pair<std::shared_ptr<PythonMesh>, std::int64_t> mesh_from_arrays(std::shared_ptr<const par::Comm> comm,
                                                                      MeshArrays arrays, Order order, bool repair);

/// What an array of Python that shows this field has to hold. Local.
std::shared_ptr<ShownField> show_field(const std::shared_ptr<PythonMesh>& mesh, bool on_cells, const std::string& name);
/// Puts a field into the mesh, instead of one of the same name. Local.
void put_field(PythonMesh& mesh, bool on_cells, mesh::Field field);
/// Takes a field out of the mesh. Local.
void remove_field(PythonMesh& mesh, bool on_cells, const std::string& name);
/// Gives a field memory that no array shows, for what changes fields of a mesh itself. Nothing where there is no such
/// field. Local.
void unshare_field(PythonMesh& mesh, bool on_cells, const std::string& name);

/// Positions of this rank's canonical block of the nodes. Collective.
std::vector<geometry::Vec3> node_block(const PythonMesh& mesh);

}  // namespace pamr::python
