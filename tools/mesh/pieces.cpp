// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

using geometry::Triangulated;
using geometry::Vec3;

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

Pieces::Pieces(const std::shared_ptr<const Solid>& solid, const std::string& where) : solid_(solid) {
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    first_.push_back(static_cast<int>(piece_.size()));
    const auto* whole = dynamic_cast<const Triangulated*>(&solid->surface(i));
    whole_.push_back(whole);
    number_.emplace_back();
    if (whole != nullptr && whole->is_one_piece())
      throw Error(
          fmt::format("{}: expected whole triangulated surfaces in a region, found \"{}\" with the key near: "
                      "its pieces become patches of their own",
                      where, solid->name(i)));
    if (whole != nullptr && whole->n_patches() > 1) {
      add_pieces(i, *whole);
    } else {
      piece_.push_back({i, &solid->surface(i), -1, solid->name(i)});
    }
  }
}

void Pieces::add_pieces(int i, const Triangulated& whole) {
  std::vector<bool> is_used(whole.n_patches(), false);
  whole.for_each_triangle([&](int piece, Vec3 middle) {
    if (!is_used[at(piece)]) is_used[at(piece)] = bounds(i, whole.project(middle));
  });
  number_[at(i)].assign(whole.n_patches(), -1);
  for (std::size_t p = 0; p < is_used.size(); ++p) {
    if (!is_used[p]) continue;
    const auto number = static_cast<int>(p);
    number_[at(i)][p] = static_cast<int>(piece_.size());
    alone_.push_back(whole.piece(number));
    piece_.push_back({i, alone_.back().get(), number, fmt::format("{}_{}", solid_->name(i), number + 1)});
  }
}

bool Pieces::bounds(int i, Vec3 p) const {
  const Sides bit = Sides{1} << i, rest = solid_->sides(p) & ~bit;
  return solid_->region.contains(rest) != solid_->region.contains(rest | bit);
}

int Pieces::nearest(int i, Vec3 p) const {
  if (number_[at(i)].empty()) return first_[at(i)];
  const int number = number_[at(i)][at(whole_[at(i)]->piece_at(p))];
  return number >= 0 ? number : first_[at(i)];
}

std::vector<FeatureCurve> Pieces::creases() const {
  std::vector<FeatureCurve> result;
  for (int i = 0; i < solid_->n_surfaces(); ++i) {
    if (whole_[at(i)] == nullptr) continue;
    const auto& lines = whole_[at(i)]->creases().lines();
    for (std::size_t line = 0; line < lines.size(); ++line) {
      const auto& points = lines[line].polyline;
      const auto n_bounding = std::count_if(points.begin(), points.end(), [&](Vec3 p) { return bounds(i, p); });
      if (n_bounding == 0) continue;
      if (n_bounding != std::ssize(points))
        throw Error(
            fmt::format("expected sharp edges of \"{}\" that no other surface crosses, found one near ({:g}, "
                        "{:g}, {:g}) that leaves the region",
                        solid_->name(i), points[0].x, points[0].y, points[0].z));
      result.push_back({points, [solid = solid_, whole = whole_[at(i)], line](Vec3 p) {
                          return whole->creases().nearest_on_line(line, p);
                        }});
    }
  }
  return result;
}

}  // namespace pamr::meshing
