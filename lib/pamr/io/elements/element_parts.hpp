// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"

/// What a file of nodes, tetrahedra and tagged triangles says, before it becomes a mesh (`mesh_of_elements.hpp`). Every
/// rank reads its share.
namespace pamr::io {

/// A triangle or a tetrahedron by the tags of its nodes, and the number of the group that it belongs to.
struct TaggedTriangle {
  std::array<std::int64_t, 3> node{};
  std::int64_t group = 0;
};
struct TaggedTetrahedron {
  std::array<std::int64_t, 4> node{};
  std::int64_t group = 0;
};

/// One rank's share: the canonical block of the nodes, and any part of the triangles and tetrahedra, in the order of
/// the file.
struct ElementParts {
  std::int64_t n_nodes = 0;     ///< of the whole file
  std::int64_t n_elements = 0;  ///< of the whole file, points and lines too
  std::vector<std::int64_t> node_tag;
  std::vector<geometry::Vec3> position;
  std::vector<TaggedTriangle> triangle;
  std::vector<TaggedTetrahedron> tetrahedron;
  /// Elements of this rank that are neither kept nor cut nor points or lines: how many, by the type that Gmsh gives them
  /// (`element_type`).
  std::map<int, std::int64_t> refused;
  /// Likewise prisms, pyramids and quadrangles of first order that are among the tetrahedra and triangles already
  /// (`cut_elements.hpp`).
  std::map<int, std::int64_t> cut = {};
  /// Names of groups by dimension and number.
  std::map<std::pair<int, std::int64_t>, std::string> group_name;
  /// Sets of groups that elements are in together, by dimension and the number of the group that stands for the set.
  /// The same on every rank.
  std::map<std::pair<int, std::int64_t>, std::set<std::int64_t>> joint = {};
  /// Points and lines of this rank by dimension (0, 1) and physical group: a mesh has no place for these groups.
  std::map<std::pair<int, std::int64_t>, std::int64_t> n_in_group = {};
  std::int64_t n_untagged_triangles = 0;  ///< of this rank, which are left out already
  /// Sections of the file that are not read, by name with a count of what is lost. The same on every rank.
  std::map<std::string, std::int64_t> left_out = {};
  std::string why_empty = {};  ///< what may be the reason for named groups without any element
  /// Dimension, geometrical entity and physical group of elements that may be written once for each group.
  std::set<std::array<std::int64_t, 3>> entity_in_group = {};
  bool has_partitions = false;             ///< of this rank: elements say partitions that they are in
  bool has_regions = true;                 ///< groups of tetrahedra mean something: they become the field `region`
  bool has_signed_regions = false;         ///< groups of tetrahedra below 0 are regions too
  std::int64_t n_periodic_links = 0;       ///< between surfaces
  std::set<std::int64_t> linked_surfaces;  ///< geometrical surfaces that are linked as periodic, either side
  /// Groups of the geometrical surfaces that this rank knows.
  std::map<std::int64_t, std::int64_t> group_of_surface;
  std::vector<mesh::NodeField> node_fields = {};  ///< values of the block of nodes
  std::vector<mesh::CellField> cell_fields = {};  ///< values of this rank's tetrahedra
};

/// The share of one rank in `n` things of the file.
struct Share {
  Rank rank = 0, size = 1;
  par::BlockRange of(std::int64_t n) const { return par::block_range(n, rank, size); }
};

/// Numbers of element types, those of Gmsh.
namespace element_type {
inline constexpr int line = 1, point = 15, triangle = 2, quadrangle = 3, tetrahedron = 4, hexahedron = 5, prism = 6,
                     pyramid = 7, triangle_2 = 9, tetrahedron_2 = 11, polygon = 34;

/// The number of what VTK, and SU2 after it, calls by another one: 0 for what is not known.
int of_vtk(std::int64_t type);

/// Whether it becomes triangles, or tetrahedra: itself or by being cut.
constexpr bool is_face(int type) { return type == triangle || type == quadrangle; }
constexpr bool is_cell(int type) { return type == tetrahedron || type == prism || type == pyramid; }
}  // namespace element_type

/// From VTK's order of a prism's nodes, whose first triangle is seen counter-clockwise from outside, to that of the
/// others and back.
void turn_prism_of_vtk(std::span<std::int64_t, 6> nodes);

/// Nodes of an element of that type: 0 for a type that no Gmsh knows.
int n_nodes_of_type(int type);
/// The type in words.
std::string name_of_type(int type);

/// The remark on what is left out, by name with a count each (`ElementParts::left_out`).
std::string text_of_left_out(const std::map<std::string, std::int64_t>& counts);

/// The most nodes of an element that is kept or cut.
inline constexpr std::size_t max_nodes = 6;

/// Keeps an element that is a triangle or a tetrahedron of first order, cuts prisms, pyramids and quadrangles into these
/// (`tetrahedra_of` says the order of nodes), counts one that cannot be dealt with, and forgets points and lines.
void keep_element(ElementParts& parts, int type, std::span<const std::int64_t, max_nodes> nodes, std::int64_t group);

}  // namespace pamr::io
