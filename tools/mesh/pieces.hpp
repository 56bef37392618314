// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh/domain.hpp"
#include "mesh/solid.hpp"
#include "pamr/geometry/triangulated.hpp"

namespace pamr::meshing {

/// The smooth pieces of which the boundary of a solid is made, and its patches: one for each surface, and for a
/// triangulated one that creases part into several, one for each of these that bounds the solid.
class Pieces {
 public:
  /// Throws `Error` that begins with `where` for one piece of a triangulated surface taken alone (it has no sides).
  Pieces(const std::shared_ptr<const Solid>& solid, const std::string& where);

  struct Piece {
    int surface = 0;
    const geometry::Surface* shape = nullptr;  ///< of the piece alone
    int number = -1;                           ///< among those of the triangulation, -1 for a surface in one piece
    std::string name;                          ///< of the patch: of the surface, or NAME_1, NAME_2, ... of its pieces
  };
  const std::vector<Piece>& all() const { return piece_; }

  /// The piece of surface `i` that is nearest to a point.
  int nearest(int i, geometry::Vec3 p) const;

  /// The creases of triangulated surfaces that are edges of the solid. Throws `Error` for one that another surface
  /// crosses.
  std::vector<FeatureCurve> creases() const;

 private:
  /// True when the point of surface `i` lies on the boundary of the solid.
  bool bounds(int i, geometry::Vec3 p) const;
  void add_pieces(int i, const geometry::Triangulated& whole);

  std::shared_ptr<const Solid> solid_;
  std::vector<Piece> piece_;
  std::vector<std::unique_ptr<const geometry::Triangulated>> alone_;
  std::vector<const geometry::Triangulated*> whole_;  ///< by surface; null for the other kinds
  std::vector<int> first_;                            ///< by surface
  std::vector<std::vector<int>> number_;              ///< by surface and piece of the triangulation, -1: bounds nothing
};

}  // namespace pamr::meshing
