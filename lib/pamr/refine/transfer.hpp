// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::refine {

/// The fields of the refined mesh.
struct Fields {
  std::vector<mesh::NodeField> of_nodes;
  std::vector<mesh::CellField> of_cells;
};

using ReleaseField = std::function<void(const mesh::Field&)>;
inline void keep_field(const mesh::Field&) {}

/// Gives the fields of the old mesh to the children, whose nodes are `cell_to_node`.
/// - Nodal fields: old values stay, a new node gets the mean of the ends of its edge (P1); integers that of the end
///   that comes first by coordinates.
/// - Cell fields: a child has its parent's value; the children of a family that was taken back have the volume-weighted
///   mean of its members (integers: the value of `parent`).
/// - Patches of inner faces are not carried here, see `inner_faces.hpp`.
/// - `level0_key` of a new node is the middle of those of the ends.
/// - `off_surface` is made anew from the certificate; in `off_facets` old nodes keep their values, and new ones have
///   those of the certificate. The field of marks is dropped.
/// - `parent` is added if the options ask for it: the input cell (`mesh::DistMesh::cell_origin`) that holds the new
///   cell's centroid while new nodes still lie on their edges, the smallest number among equals.
///
/// `release` is called for each field of the old mesh when it is not looked at any more: its values may be freed then,
/// so that no more than one field is there twice.
///
/// Local. Cost: O(children) for each field.
Fields transfer(const NumberedMesh& old, const std::vector<mesh::CellNodes>& cell_to_node,
                const Certificate& certificate, const Options& options, const ReleaseField& release = keep_field);

/// Whether `transfer` looks at this cell field of the old mesh: not at the marks, nor at numbers of parents that are
/// replaced. Local.
bool is_inherited(const mesh::CellField& field, const Options& options);

/// The node fields alone. Local.
std::vector<mesh::NodeField> transfer_to_nodes(const NumberedMesh& old, const Certificate& certificate,
                                               const ReleaseField& release = keep_field);

/// The centroid of a child while new nodes still lie on their edges. Local.
geometry::Vec3 straight_centroid(const NumberedMesh& old, const mesh::CellNodes& child);

/// The one of the cells from `first` to before `end` that holds a point. To rounding: the first in which the point lies
/// no deeper outside than 2^-40 of its height, else the one in which it lies least outside. Local.
LocalId cell_that_holds(const mesh::DistMesh& mesh, LocalId first, LocalId end, geometry::Vec3 point);

/// The same among the members of the family beginning at `first`, for a point of the family's parent. Local.
LocalId member_that_holds(const mesh::DistMesh& mesh, LocalId first, geometry::Vec3 point);

/// For each child the old cell that holds its centroid. Local.
std::vector<LocalId> parents_of(const NumberedMesh& old, const std::vector<mesh::CellNodes>& cell_to_node);

}  // namespace pamr::refine
