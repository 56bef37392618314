// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/tet.hpp"
#include "solvers/poisson_boltzmann/fem/node_map.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_elements.hpp"
#include "solvers/poisson_boltzmann/fem/sheet_sides.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::poisson_boltzmann {

/// Volume of a cell and the constant gradients of its four corner functions.
struct CellShape {
  double volume = 0;
  std::array<geometry::Vec3, 4> gradient;
};
inline CellShape shape_of(const geometry::TetPoints& p) {
  CellShape shape;
  shape.volume = geometry::volume(p);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& corner = mesh::tet::face_to_corner[i];  // its outward normal points away from corner i
    const auto &a = p[at(corner[0])], &b = p[at(corner[1])], &c = p[at(corner[2])];
    shape.gradient[i] = (-1.0 / (6.0 * shape.volume)) * cross(b - a, c - a);
  }
  return shape;
}

/// A triangle of the boundary, or one side of a triangle of a sheet. Lengths in Debye lengths.
struct BoundaryFace {
  LocalId cell = 0;
  int patch = 0;
  std::array<LocalId, 3> node{};
  double area = 0;
  geometry::Vec3 normal;  ///< unit, out of the liquid
  bool is_inside = false;

  /// The part of the face that this side counts for in areas and means.
  double weight() const { return is_inside ? 0.5 : 1; }
};

/// The part of a boundary patch that all ranks hold together.
struct PatchShape {
  double area = 0;
  std::int64_t n_faces = 0;  ///< those of sheets once for each side
  /// Axis (0, 1, 2) of the normal where the patch is flat and normal to an axis; -1 elsewhere.
  int axis = -1;
  double level = 0;         ///< its coordinate on that axis
  bool has_inside = false;  ///< it is a sheet, all of it or in part
  bool has_rim = false;     ///< ... that ends in the liquid
};

/// A mesh in Debye lengths with what the finite elements need: who owns which node, lumped volumes, boundary faces.
struct Domain {
  const mesh::DistMesh* mesh = nullptr;
  NodeMap nodes;
  double scale = 1;                         ///< Debye lengths in one length unit of the mesh
  std::vector<geometry::Vec3> point;        ///< n_nodes, Debye lengths
  std::vector<double> node_volume;          ///< n_nodes: a quarter of the cells around the node, summed over the ranks
  std::vector<std::uint64_t> node_patches;  ///< n_nodes: bit p is set where the node lies on patch p, on any rank
  std::vector<BoundaryFace> faces;          ///< of this rank; both sides of the faces of sheets, each with its cell
  std::vector<PatchShape> patches;          ///< one for each patch of the mesh
  /// Cells of second order; null: linear. All arrays of nodes then have entries for the mid-edge nodes too, whose
  /// lumped volumes are 0; areas of patches are those of the curved faces.
  std::shared_ptr<const QuadraticElements> quadratic = nullptr;
  std::shared_ptr<const SheetSides> sides = nullptr;  ///< null: no sheets

  CellShape shape(std::size_t cell) const { return shape_of(points(cell)); }
  /// Corners of a cell in arrays of gradients recovered at the nodes, after which come those at the sides of sheets.
  const mesh::CellNodes& recovery_nodes(std::size_t cell) const {
    return (sides ? sides->cell_to_node : mesh->cell_to_node)[cell];
  }
  geometry::TetPoints points(std::size_t cell) const {
    const auto& n = mesh->cell_to_node[cell];
    return {point[at(n[0])], point[at(n[1])], point[at(n[2])], point[at(n[3])]};
  }
  /// Of all nodes, those of second order included.
  GlobalId n_global_nodes() const { return quadratic ? quadratic->n_global_nodes : mesh->info.n_global_nodes; }
  const std::vector<GlobalId>& node_global() const { return quadratic ? quadratic->node_global : mesh->node_global; }
  /// Of a boundary face: its corners and, of second order, the middles of its edges.
  std::span<const LocalId> face_nodes(std::size_t face) const {
    return quadratic ? std::span<const LocalId>(quadratic->face_to_node[face]) : faces[face].node;
  }
  /// Number of a patch; -1 when the mesh has none of that name.
  int patch_number(std::string_view name) const;
};

/// Collective: a few exchanges and reductions. Throws `Error` on every rank when the mesh's length unit is unknown, a
/// patch of the mesh has no condition, the case names a patch that the mesh does not have, a patch does not lie on the
/// sphere or plate that the case says it is, or there are more than 64. Pre: `problem` comes from `with_sheets`, or no
/// patch of the mesh has faces inside.
Domain make_domain(const par::Comm& comm, const mesh::DistMesh& mesh, const Case& problem, const std::string& where);

/// What a solve will take on this rank, estimated from the counts of the mesh before anything is allocated. Bytes.
struct Memory {
  std::int64_t n_entries = 0;  ///< of the stiffness matrix that this rank's cells make; exact on a part without holes
  std::int64_t program = 0;    ///< PETSc, hypre and MPI, taken already
  std::int64_t mesh = 0;       ///< taken already
  std::int64_t solve = 0;      ///< matrices, vectors, estimates and fields; without buffers of files and of messages
  std::int64_t total() const { return program + mesh + solve; }
};
/// Local. O(cells).
Memory memory_needed(const mesh::DistMesh& mesh, const Case& problem);

}  // namespace pamr::poisson_boltzmann
