// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Patches of faces inside the domain: thin sheets, interfaces between materials, ports. Such a face has cells on both
/// sides, and each of the two names its patch, an entry of `MeshInfo::patches` as those of the boundary are.
namespace pamr::mesh {

/// Integer cell field with the patches of the four faces of a cell, 16 bits each, that of slot 0 lowest: patch + 1, 0
/// for none. Faces of the boundary have 0 here. Absent where no face inside has a patch.
inline constexpr const char* inner_patch_field = "inner_patch";
/// Most patches of a mesh that has some inside.
inline constexpr int max_inner_patches = 0xffff;

/// The patch of one face, -1 for none.
constexpr int inner_patch(std::int64_t word, int slot) {
  return static_cast<int>(static_cast<std::uint64_t>(word) >> (16 * slot) & 0xffffU) - 1;
}
/// The word with another patch of that face.
constexpr std::int64_t with_inner_patch(std::int64_t word, int slot, int patch) {
  const auto cleared = static_cast<std::uint64_t>(word) & ~(std::uint64_t{0xffff} << (16 * slot));
  return static_cast<std::int64_t>(cleared | static_cast<std::uint64_t>(patch + 1) << (16 * slot));
}

inline bool is_inner_patch_field(const Field& field) { return field.name == inner_patch_field; }

/// The patches of a mesh's faces inside. Only references; local.
class InnerPatches {
 public:
  explicit InnerPatches(const DistMesh& mesh);

  bool is_empty() const { return word_ == nullptr; }
  /// Of all four faces of a cell.
  std::int64_t word(LocalId cell) const { return word_ == nullptr ? 0 : (*word_)[at(cell)]; }
  /// -1: the face has none.
  int of(CellFace face) const { return inner_patch(word(face.cell), face.slot); }
  /// The patch of any face, of the boundary or inside; -1: it has none.
  int of_any(CellFace face) const {
    const auto next = mesh_->cell_to_cell[at(face.cell)][at(face.slot)];
    return next < 0 ? slot_to_patch(next) : of(face);
  }
  /// Whether a face is to be counted from this side: true for the cell with the lower number of the two.
  bool is_first_side(CellFace face) const;
  /// Calls `visit(CellFace, patch)` for each inner face of this rank's cells that has a patch, from each of these cells.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (LocalId cell = 0; cell < (is_empty() ? 0 : mesh_->n_cells()); ++cell)
      for (int slot = 0; slot < 4 && word(cell) != 0; ++slot)
        if (const int patch = of({cell, slot}); patch >= 0) visit(CellFace{cell, slot}, patch);
  }

 private:
  const DistMesh* mesh_;
  const std::vector<std::int64_t>* word_ = nullptr;
};

/// The field, made with 0 everywhere if there is none. Local.
std::vector<std::int64_t>& make_inner_patches(DistMesh& mesh);

/// Faces of each patch inside, each face once. Collective: one reduction.
std::vector<std::int64_t> count_inner_faces(const par::Comm& comm, const DistMesh& mesh);

/// Of each patch whether it has faces inside and none on the boundary. Collective: one reduction, two where
/// there are faces inside with a patch.
std::vector<bool> patches_inside_alone(const par::Comm& comm, const DistMesh& mesh);

/// Throws `Error` where a field of that name is none of these: not one integer, a patch that is not there. Local.
void require_inner_patches(const Field& field, std::size_t n_patches);

}  // namespace pamr::mesh
