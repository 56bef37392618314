// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/locate/locator.hpp"
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
  std::vector<std::array<GlobalId, 4>> cells;      ///< rows of all points
  std::vector<std::array<GlobalId, 3>> triangles;  ///< likewise
  std::vector<std::int64_t> tags;                  ///< of the triangles
  std::map<std::int64_t, mesh::Patch> patch_of_tag;
  std::vector<mesh::Field> cell_fields, node_fields;
  std::string length_unit;
  std::vector<mesh::Region> regions;           ///< ascending
  std::vector<io::UnusedGroup> unused_groups;  ///< that have been left out already, on the first rank
  /// Of groups that stand for several, by dimension and tag, these in ascending order.
  std::map<std::pair<int, std::int64_t>, std::vector<mesh::Group>> joint;
  bool has_boundary = true;     ///< else faces without a triangle are no news
  bool has_orientation = true;  ///< else inverted cells are none
};

struct MadeMesh {
  std::shared_ptr<PythonMesh> mesh;
  std::int64_t n_turned = 0;
  std::vector<std::string> remarks;  ///< what was left out or is odd
};

/// A valid mesh from arrays, by the way in of all files (`io::mesh_of_elements`), whose errors begin with `source`.
/// Collective. Throws `Error` on every rank.
MadeMesh mesh_from_arrays(std::shared_ptr<const par::Comm> comm, MeshArrays arrays, const std::string& source,
                          const io::ElementOptions& options);

/// Warnings about a mesh that was read from a file or arrays of another program: things left out or changed, and
/// places where it is torn. Collective.
std::vector<std::string> remarks_on(const par::Comm& comm, const io::ElementMesh& read);

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
