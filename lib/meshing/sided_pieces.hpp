// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <set>
#include <vector>

#include "meshing/meshing_domain.hpp"
#include "meshing/pieces.hpp"
#include "meshing/solid.hpp"

namespace pamr::meshing {

/// The smooth pieces of a solid's surfaces, one for each two regions, or region and outside, that a piece divides.
class SidedPieces {
 public:
  struct Sided {
    int piece = 0;                     ///< of `Pieces`
    std::array<int, 2> region{0, -1};  ///< at its sides, as `Piece::region` of a domain
  };

  /// Each piece once, where the solid has one region. Otherwise it looks at the samples and at all sides of the curves.
  /// Throws `Error` for a surface that divides nothing, and for regions that overlap there.
  SidedPieces(const std::shared_ptr<const Solid>& solid, const std::shared_ptr<const Pieces>& pieces,
              const SurfaceSamples& samples, const std::vector<FeatureCurve>& curves);

  const std::vector<Sided>& all() const { return sided_; }
  /// The number of the piece between these regions; -1: none is known.
  int find(int piece, std::array<int, 2> region) const;
  /// That of the piece of surface `i` at a point of it; -1 where the surface divides nothing.
  int at_point(int i, geometry::Vec3 p) const;
  /// What lies behind a piece of surface `place.surface`, outside.
  int behind(const Solid::Place& place, geometry::Vec3 p) const;

 private:
  using Regions = std::set<std::array<int, 2>>;
  void look_at_samples(const SurfaceSamples& samples, std::vector<Regions>& beside) const;
  void look_at_curves(const std::vector<FeatureCurve>& curves, std::vector<Regions>& beside) const;

  std::shared_ptr<const Solid> solid_;
  std::shared_ptr<const Pieces> pieces_;
  std::vector<Sided> sided_;
  std::vector<std::size_t> first_;  ///< by piece, and the number of all
};

}  // namespace pamr::meshing
