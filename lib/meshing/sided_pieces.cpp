// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/sided_pieces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"

namespace pamr::meshing {

using geometry::Vec3;

SidedPieces::SidedPieces(const std::shared_ptr<const Solid>& solid, const std::shared_ptr<const Pieces>& pieces,
                         const SurfaceSamples& samples, const std::vector<FeatureCurve>& curves)
    : solid_(solid), pieces_(pieces) {
  std::vector<Regions> beside(pieces->all().size());
  if (solid->regions.size() == 1) {
    std::fill(beside.begin(), beside.end(), Regions{{0, -1}});
  } else {
    look_at_samples(samples, beside);
    look_at_curves(curves, beside);
  }
  for (std::size_t k = 0; k < beside.size(); ++k) {
    first_.push_back(sided_.size());
    for (const auto& regions : beside[k]) sided_.push_back({static_cast<int>(k), regions});
  }
  first_.push_back(sided_.size());
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    const auto own = pieces->of(i);
    if (first_[at(own.begin)] == first_[at(own.end)])
      throw Error(
          fmt::format("expected surfaces that bound a region, found no place where \"{}\" does", solid->name(i)));
  }
}

void SidedPieces::look_at_samples(const SurfaceSamples& samples, std::vector<Regions>& beside) const {
  const Vec3 margin = 1e-6 * solid_->radius() * Vec3{1, 1, 1};
  const geometry::Box box{solid_->low - margin, solid_->high + margin};
  for (int i = 0; i < solid_->n_surfaces(); ++i) {
    const auto look = [&](int piece, Vec3 p) {
      if (!box.contains(p)) return;
      const auto regions = solid_->regions_beside(i, solid_->sides(p));
      if (regions[0] != regions[1]) beside[at(piece)].insert(regions);
    };
    for (const Vec3 p : samples[at(i)]) look(pieces_->nearest(i, p), p);
    if (const auto whole = divided(solid_->surface(i)))
      whole->for_each_sample([&](int piece, Vec3 p) { look(pieces_->of_part(i, piece), p); });
  }
}

void SidedPieces::look_at_curves(const std::vector<FeatureCurve>& curves, std::vector<Regions>& beside) const {
  const double tolerance = 1e-9 * solid_->radius();
  for (const auto& curve : curves) {
    const Vec3 p = curve.polyline[curve.polyline.size() / 2];
    std::vector<int> here;
    for (int i = 0; i < solid_->n_surfaces(); ++i)
      if (std::abs(solid_->signed_distance(i, p)) < tolerance) here.push_back(i);
    Sides sides = solid_->sides(p);
    for (std::uint32_t some = 0; some < (1U << here.size()); ++some) {
      for (std::size_t n = 0; n < here.size(); ++n) {
        const Sides bit = Sides{1} << here[n];
        sides = (some >> n & 1U) != 0 ? sides | bit : sides & ~bit;
      }
      solid_->require_apart(sides, p);
      for (const int i : here) {
        const auto regions = solid_->regions_beside(i, sides);
        if (regions[0] == regions[1]) continue;
        for (int k = pieces_->of(i).begin; k < pieces_->of(i).end; ++k)
          if (pieces_->at(k).shape->distance(p) < tolerance) beside[at(k)].insert(regions);
      }
    }
  }
}

int SidedPieces::find(int piece, std::array<int, 2> region) const {
  for (auto s = first_[at(piece)]; s < first_[at(piece) + 1]; ++s)
    if (sided_[s].region == region) return static_cast<int>(s);
  return -1;
}

int SidedPieces::at_point(int i, Vec3 p) const {
  const auto regions = solid_->regions_beside(i, solid_->sides(p));
  return regions[0] == regions[1] ? -1 : find(pieces_->nearest(i, p), regions);
}

int SidedPieces::behind(const Solid::Place& place, Vec3 p) const {
  const int piece = pieces_->nearest(place.surface, p), found = find(piece, {place.region, -1});
  return std::max(0, found >= 0 ? found : static_cast<int>(first_[at(piece)]));
}

}  // namespace pamr::meshing
