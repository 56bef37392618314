// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// How often something was found, and the first place of it by coordinates.
struct Findings {
  std::int64_t count = 0;
  geometry::Vec3 where;
  bool operator==(const Findings&) const = default;
};

/// Faults of a mesh whose cells are each valid: parts that share no face, coincident nodes and faces, overlapping
/// cells. All but overlaps may be intended (two bodies, a crack).
struct Tears {
  std::int64_t n_pieces = 1;  ///< parts of the mesh that no face joins
  Findings coincident_nodes;  ///< boundary nodes that lie where one of smaller number does
  Findings coincident_faces;  ///< boundary faces that lie on another one; the place is the middle of the face
  Findings overlaps;          ///< boundary faces behind whose middle there is not only their own cell; likewise
  bool operator==(const Tears&) const = default;

  bool is_whole() const {
    return n_pieces <= 1 && coincident_nodes.count + coincident_faces.count + overlaps.count == 0;
  }
};

/// For each node the smallest number of the nodes in its place: its own, or that of another boundary node whose
/// coordinates differ by at most 1e-10 of the diagonal of the mesh's box. Collective: as `match_nodes`.
std::vector<GlobalId> nodes_by_place(const par::Comm& comm, const mesh::DistMesh& mesh);

/// The boundary faces of this rank by cell and slot, and whether others lie on them; `by_place`: see above. Collective:
/// two sparse exchanges.
struct PairedFaces {
  std::vector<mesh::CellFace> face;
  std::vector<std::uint8_t> is_paired;
};
PairedFaces pair_faces(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& by_place);

/// Parts of the mesh that no face joins. Collective: one exchange of border faces for each rank that a piece winds
/// through. Cost: O(cells).
std::int64_t count_pieces(const par::Comm& comm, const mesh::DistMesh& mesh);

/// Looks for tears and overlaps. An overlap is found where the middle of a boundary face lies inside of it, by exact
/// predicates. The same on any number of ranks. Collective: sparse exchanges of the boundary's nodes and faces, and
/// one exchange of border faces for each rank that a piece winds through. Cost: O(cells), O(boundary log(cells)).
Tears find_tears(const par::Comm& comm, const mesh::DistMesh& mesh);

/// In words, with numbers and places; empty where the mesh is whole. Local.
std::vector<std::string> remarks_of(const Tears& tears);

}  // namespace pamr::check
