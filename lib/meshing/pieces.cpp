// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"

namespace pamr::meshing {
namespace {

using geometry::Triangulated;
using geometry::Vec3;

}  // namespace

Pieces::Pieces(const std::shared_ptr<const Solid>& solid, const SurfaceSamples& samples) : solid_(solid) {
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    whole_.push_back(dynamic_cast<const Triangulated*>(&solid->surface(i)));
    if (whole_.back() != nullptr && whole_.back()->is_one_piece())
      throw Error(
          fmt::format("expected whole triangulated surfaces in a region, found \"{}\" with the key near: "
                      "its pieces become patches of their own",
                      solid->name(i)));
  }
  creases_ = cut_creases(*solid);
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    first_.push_back(static_cast<int>(piece_.size()));
    number_.emplace_back();
    const auto* whole = whole_[pamr::at(i)];
    if (whole != nullptr && whole->n_patches() > 1) {
      add_pieces(i, *whole, samples[pamr::at(i)]);
    } else {
      piece_.push_back({i, &solid->surface(i), -1, solid->name(i)});
    }
  }
  first_.push_back(static_cast<int>(piece_.size()));
}

void Pieces::add_pieces(int i, const Triangulated& whole, const std::vector<Vec3>& samples) {
  std::vector<bool> is_used(whole.n_patches(), false);
  const auto look = [&](int piece, Vec3 p) {
    if (!is_used[pamr::at(piece)]) is_used[pamr::at(piece)] = solid_->divides(i, solid_->sides(p));
  };
  whole.for_each_triangle([&](int piece, Vec3 middle) { look(piece, whole.project(middle)); });
  // where other surfaces leave little of large triangles
  for (const Vec3 p : samples) look(whole.piece_at(p), p);
  for (const auto& part : creases_.parts)
    if (part.surface == i)
      for (const int piece : whole.crease_net().lines()[part.line].piece)
        if (piece >= 0) is_used[pamr::at(piece)] = true;
  if (std::find(is_used.begin(), is_used.end(), true) == is_used.end())
    throw Error(
        fmt::format("expected surfaces that bound the region, found no place where \"{}\" does", solid_->name(i)));
  number_[pamr::at(i)].assign(whole.n_patches(), -1);
  for (std::size_t p = 0; p < is_used.size(); ++p) {
    if (!is_used[p]) continue;
    const auto number = static_cast<int>(p);
    number_[pamr::at(i)][p] = static_cast<int>(piece_.size());
    alone_.push_back(whole.piece(number));
    piece_.push_back({i, alone_.back().get(), number, fmt::format("{}_{}", solid_->name(i), number + 1)});
  }
}

int Pieces::nearest(int i, Vec3 p) const {
  if (number_[pamr::at(i)].empty()) return first_[pamr::at(i)];
  const int number = number_[pamr::at(i)][pamr::at(whole_[pamr::at(i)]->piece_at(p))];
  return number >= 0 ? number : first_[pamr::at(i)];
}

std::vector<FeatureCurve> Pieces::creases() const {
  std::vector<FeatureCurve> result;
  for (const auto& part : creases_.parts)
    result.push_back({part.polyline, [solid = solid_, whole = whole_[pamr::at(part.surface)], line = part.line](
                                         Vec3 p) { return whole->crease_net().nearest_on_line(line, p); }});
  return result;
}

}  // namespace pamr::meshing
