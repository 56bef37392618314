// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate_cells.hpp"

#include <cmath>

#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/validate/validate_faces.hpp"

namespace pamr::validate {

namespace {

/// True when the own neighbor `d` of a face names its cell across the same nodes, from the other side.
bool is_returned(const mesh::DistMesh& mesh, mesh::CellFace face, LocalId d) {
  for (int g = 0; g < 4; ++g) {
    const mesh::CellFace back{d, g};
    if (slot_at(mesh, back) == face.cell && mesh::face_key(mesh, back) == mesh::face_key(mesh, face))
      return face_sign(mesh, back) == -face_sign(mesh, face);
  }
  return false;
}

void check_family_at(const mesh::DistMesh& mesh, std::size_t c, std::size_t size, Findings& findings) {
  const auto first = mesh.lineage[c];
  bool is_whole = first.child() == 0 && c + size <= mesh.lineage.size();
  for (std::size_t k = 1; is_whole && k < size; ++k)
    is_whole = mesh.lineage[c + k] == mesh::sibling(first, static_cast<int>(k)) &&
               mesh.cell_global[c + k] == mesh.cell_global[c] + static_cast<GlobalId>(k);
  if (!is_whole || !mesh::fits_template(first, std::span<const mesh::CellNodes>(mesh.cell_to_node).subspan(c, size)))
    findings.add(Invariant::families_whole, mesh.cell_global[c]);
}

}  // namespace

int face_sign(const mesh::DistMesh& mesh, mesh::CellFace face) {
  const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(face.cell)];
  const auto& corner = mesh::tet::face_to_corner[static_cast<std::size_t>(face.slot)];
  const auto id = [&](std::size_t i) {
    return mesh.node_global[static_cast<std::size_t>(nodes[static_cast<std::size_t>(corner[i])])];
  };
  const int inversions =
      static_cast<int>(id(0) > id(1)) + static_cast<int>(id(0) > id(2)) + static_cast<int>(id(1) > id(2));
  return inversions % 2 == 0 ? 1 : -1;
}

bool is_far_from_flat(const geometry::TetPoints& p) {
  constexpr double far = 100 * min_mean_ratio;
  const auto u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
  const double determinant = dot(cross(u, v), w);
  const double bound = far * 5 * (dot(u, u) + dot(v, v) + dot(w, w)) / 12;
  return determinant > 0 && 0.25 * determinant * determinant > bound * bound * bound;
}

void check_shapes(const mesh::DistMesh& mesh, Findings& findings) {
  for (std::size_t n = 0; n < mesh.node_position.size(); ++n)
    if (!geometry::is_in_range(mesh.node_position[n])) findings.add(Invariant::finite_coordinates, mesh.node_global[n]);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    if (is_far_from_flat(p)) continue;
    if (!std::all_of(p.begin(), p.end(), geometry::is_finite)) continue;
    if (!geometry::is_positive(p[0], p[1], p[2], p[3]))
      findings.add(Invariant::orientation_positive, number_of(mesh, c));
    if (!(std::abs(geometry::mean_ratio(p)) >= min_mean_ratio)) findings.add(Invariant::not_flat, number_of(mesh, c));
  }
}

void check_own_neighbors(const mesh::DistMesh& mesh, Findings& findings) {
  if (own_faces_match(mesh)) return;
  const auto n_patches = static_cast<int>(mesh.info.patches.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto slot = slot_at(mesh, {c, f});
      if (slot < 0 && (slot == invalid_local || mesh::slot_to_patch(slot) >= n_patches))
        findings.add(Invariant::patches_in_range, number_of(mesh, c));
      if (mesh.is_own(slot) && !is_returned(mesh, {c, f}, slot))
        findings.add(Invariant::neighbors_reciprocal, number_of(mesh, c));
    }
  mesh::FaceGroups(mesh).for_each([&](std::span<const mesh::CellFace> faces) {
    const bool conforms = faces.size() == 1 ? !mesh.is_own(slot_at(mesh, faces[0]))
                          : faces.size() == 2
                              ? slot_at(mesh, faces[0]) == faces[1].cell && slot_at(mesh, faces[1]) == faces[0].cell
                              : false;
    if (!conforms) findings.add(Invariant::conforming, number_of(mesh, faces[0].cell));
  });
}

void check_families(const mesh::DistMesh& mesh, Findings& findings) {
  for (std::size_t c = 0; c < mesh.lineage.size();) {
    const auto lineage = mesh.lineage[c];
    if (!mesh::is_well_formed(lineage)) {
      findings.add(Invariant::families_whole, mesh.cell_global[c++]);
    } else if (!lineage.is_removable()) {
      ++c;
    } else {
      // A broken-off rest is reported at each of its cells; a family that begins here is stepped over as one.
      const auto size = static_cast<std::size_t>(lineage.family_size());
      check_family_at(mesh, c, size, findings);
      std::size_t step = 1;
      while (lineage.child() == 0 && step < size && c + step < mesh.lineage.size() &&
             mesh.lineage[c + step] == mesh::sibling(lineage, static_cast<int>(step)))
        ++step;
      c += step;
    }
  }
}

}  // namespace pamr::validate
