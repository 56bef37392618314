// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "meshing/crease_cut.hpp"
#include "meshing/divided_surface.hpp"
#include "meshing/meshing_domain.hpp"
#include "meshing/solid.hpp"

namespace pamr::meshing {

/// The smooth pieces that make up the boundary of a solid. A surface is one piece, but a divided one (see
/// `DividedSurface`) is several: those that bound the solid.
class Pieces {
 public:
  /// `samples` are those of `sample_surfaces`. Throws `Error` for a triangulated surface that is one piece taken
  /// alone (it has no sides), or of which no piece bounds the solid, and as `cut_creases` does.
  Pieces(const std::shared_ptr<const Solid>& solid, const SurfaceSamples& samples);

  struct Piece {
    int surface = 0;
    const geometry::Surface* shape = nullptr;  ///< of the piece alone
    int number = -1;                           ///< among those of a divided surface, -1 for a surface in one piece
    /// Of the patch: of the surface, NAME_1, NAME_2, ... of its pieces, or of their part, which may be several pieces.
    std::string name;
    std::string part;  ///< its name in the file of the surface, or empty
  };
  const std::vector<Piece>& all() const { return piece_; }

  const Piece& at(int number) const { return piece_[static_cast<std::size_t>(number)]; }
  /// Numbers of the pieces of surface `i`, one after another.
  struct Range {
    int begin = 0, end = 0;
  };
  Range of(int i) const { return {first_[static_cast<std::size_t>(i)], first_[static_cast<std::size_t>(i) + 1]}; }

  /// The piece of surface `i` that is nearest to a point.
  int nearest(int i, geometry::Vec3 p) const;
  /// The piece that is number `piece` of the divided surface `i`, or the first of `i` where that one bounds nothing.
  int of_part(int i, int piece) const;

  /// The creases of triangulated surfaces, or parts of them, that are edges of the solid.
  std::vector<FeatureCurve> creases() const;
  /// Where other surfaces meet creases.
  const std::vector<geometry::Vec3>& crease_corners() const { return creases_.corners; }

 private:
  std::string name_of(int i, const std::string& part, int number) const;
  void add_pieces(int i, const DividedSurface& whole, const std::vector<geometry::Vec3>& samples);

  std::shared_ptr<const Solid> solid_;
  CutCreases creases_;
  std::vector<Piece> piece_;
  std::vector<std::shared_ptr<const geometry::Surface>> alone_;
  std::vector<std::shared_ptr<const DividedSurface>> whole_;  ///< by surface; null for the other kinds
  std::vector<int> first_;                                    ///< by surface, and the number of all pieces
  std::vector<std::vector<int>> number_;                      ///< by surface and its piece, -1: bounds nothing
};

}  // namespace pamr::meshing
