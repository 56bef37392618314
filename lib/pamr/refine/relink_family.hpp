// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/relink_border.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// Links the children of families that are taken back: their siblings by table, then each face of the parent as a whole
/// to what is behind it now. The parts of such a face are called by the corners that they keep, which both sides know,
/// so nothing is searched, not even between two families. Writes the links of both sides, also into children of cells
/// that are split by their own pattern. Local. Cost: constant for each child.
class FamilyLinker {
 public:
  /// `links` has room for all children. Faces on the rank border are added to `border`.
  FamilyLinker(const NumberedMesh& old, const Children& children, std::vector<mesh::CellNeighbors>& links,
               std::vector<BorderFace>& border);

  /// Links the family `closure.rebuilt[i]`; of two families side by side the later one links both. Call for all,
  /// ascending or not.
  void link(std::size_t i);

 private:
  /// A parent that is split anew, with what is needed to find a child by the face and the part that it shows.
  struct Parent {
    LocalId first_member = invalid_local;
    int before = 0;  ///< state by which it was split in the old mesh
    int now = 0;
    std::array<const SplitPattern*, max_children> child{};  ///< how each child is split once more
    std::array<LocalId, max_children> start{};              ///< first grandchild of each child
    std::array<LocalId, 10> node{};                         ///< old nodes by code: corners and midpoints there were
  };
  /// A part of a triangle: the corner node that it keeps, or `name_center`, or `name_whole`.
  using Name = LocalId;
  static constexpr Name name_center = -2;
  static constexpr Name name_whole = -3;
  /// A face in four parts: those at three corners, which the names say, then the center.
  struct Quarters {
    std::array<mesh::CellFace, 4> part{};
    std::array<Name, 3> name{};
  };
  /// All parts of a parent's face.
  static constexpr int all_places = -1;

  Parent gather(const RebuiltFamily& family) const;
  const RebuiltFamily& family_of(LocalId first_member) const;
  void prefetch_neighbors(LocalId first) const;
  void prefetch_children_behind(LocalId first) const;
  void link_siblings(const Parent& parent);
  void link_split_child(const Parent& parent, int c);
  void link_face(const Parent& parent, int face);
  bool link_region(const Parent& parent, int face, int place, mesh::CellFace behind);
  LocalId lowest_border_face(const Parent& parent, int face) const;
  bool link_to_family(const Parent& parent, int face, int place, LocalId next, int face_there);
  bool find_quarters(const Parent& parent, int face, Quarters& quarters) const;
  mesh::CellFace find(const Parent& parent, int face, int place, Name first, Name second) const;
  template <class Visit>
  void for_each_part(const Parent& parent, int face, int place, Visit&& visit) const;

  void set(mesh::CellFace face, LocalId neighbor) { link_[at(face.cell)][at(face.slot)] = neighbor; }
  void set_both(mesh::CellFace a, mesh::CellFace b) {
    set(a, b.cell);
    set(b, a.cell);
  }

  const mesh::DistMesh& old_;
  const Closure& closure_;
  const Numbering& numbering_;
  const Children& children_;
  std::vector<mesh::CellNeighbors>& link_;  ///< of each child
  std::vector<BorderFace>& border_;
  std::vector<LocalId> block_to_family_;  ///< of each block of old cells: its first family or one after it
};

}  // namespace pamr::refine
