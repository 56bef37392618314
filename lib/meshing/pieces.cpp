// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Triangulated;
using geometry::Vec3;

}  // namespace

Pieces::Pieces(const std::shared_ptr<const Solid>& solid, const SurfaceSamples& samples) : solid_(solid) {
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    const auto* triangulated = dynamic_cast<const Triangulated*>(&solid->surface(i));
    if (triangulated != nullptr && triangulated->is_one_piece())
      throw Error(
          fmt::format("expected whole triangulated surfaces in a region, found \"{}\" with the key near: "
                      "its pieces become patches of their own",
                      solid->name(i)));
    whole_.push_back(divided(solid->surface(i)));
  }
  creases_ = cut_creases(*solid);
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    first_.push_back(static_cast<int>(piece_.size()));
    number_.emplace_back();
    const auto* whole = whole_[pamr::at(i)].get();
    if (whole != nullptr && whole->n_pieces() > 1) {
      add_pieces(i, *whole, samples[pamr::at(i)]);
    } else {
      piece_.push_back({i, &solid->surface(i), -1, solid->name(i), {}});
    }
  }
  first_.push_back(static_cast<int>(piece_.size()));
}

std::string Pieces::name_of(int i, const std::string& part, int number) const {
  if (!part.empty())
    for (const auto& piece : piece_)
      if (piece.surface == i && piece.part == part) return piece.name;
  const auto is_taken = [&](const std::string& name) {
    for (int j = 0; j < solid_->n_surfaces(); ++j)
      if (j != i && solid_->name(j) == name) return true;
    return std::any_of(piece_.begin(), piece_.end(), [&](const Piece& piece) { return piece.name == name; });
  };
  auto name = part.empty() ? fmt::format("{}_{}", solid_->name(i), number + 1) : part;
  if (!part.empty() && is_taken(name)) name = solid_->name(i) + "_" + part;
  while (is_taken(name)) name += '_';
  return name;
}

void Pieces::add_pieces(int i, const DividedSurface& whole, const std::vector<Vec3>& samples) {
  std::vector<bool> is_used(whole.n_pieces(), false);
  const auto look = [&](int piece, Vec3 p) {
    if (!is_used[pamr::at(piece)]) is_used[pamr::at(piece)] = solid_->divides(i, solid_->sides(p));
  };
  whole.for_each_sample(look);
  // where other surfaces leave little of large triangles
  for (const Vec3 p : samples) look(whole.piece_at(p), p);
  for (const auto& part : creases_.parts)
    if (part.surface == i)
      for (const int piece : whole.pieces_of_line(part.line))
        if (piece >= 0) is_used[pamr::at(piece)] = true;
  if (std::find(is_used.begin(), is_used.end(), true) == is_used.end())
    throw Error(
        fmt::format("expected surfaces that bound the region, found no place where \"{}\" does", solid_->name(i)));
  number_[pamr::at(i)].assign(whole.n_pieces(), -1);
  for (std::size_t p = 0; p < is_used.size(); ++p) {
    if (!is_used[p]) continue;
    const auto number = static_cast<int>(p);
    number_[pamr::at(i)][p] = static_cast<int>(piece_.size());
    alone_.push_back(whole.piece(number));
    const auto part = whole.part_of(number);
    piece_.push_back({i, alone_.back().get(), number, name_of(i, part, number), part});
  }
}

int Pieces::nearest(int i, Vec3 p) const {
  return number_[pamr::at(i)].empty() ? first_[pamr::at(i)] : of_part(i, whole_[pamr::at(i)]->piece_at(p));
}

int Pieces::of_part(int i, int piece) const {
  const int number = number_[pamr::at(i)].empty() ? -1 : number_[pamr::at(i)][pamr::at(piece)];
  return number >= 0 ? number : first_[pamr::at(i)];
}

std::vector<FeatureCurve> Pieces::creases() const {
  std::vector<FeatureCurve> result;
  for (const auto& part : creases_.parts)
    result.push_back({part.polyline, [solid = solid_, whole = whole_[pamr::at(part.surface)],
                                      line = part.line](Vec3 p) { return whole->nearest_on_line(line, p); }});
  return result;
}

}  // namespace pamr::meshing
