// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/crease_cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "meshing/divided_surface.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;
using Polyline = std::vector<Vec3>;

class Cutter {
 public:
  explicit Cutter(const Solid& solid) : solid_(solid), tolerance_(1e-9 * solid.radius()) {}

  CutCreases cut() {
    for (surface_ = 0; surface_ < solid_.n_surfaces(); ++surface_) {
      whole_ = divided(solid_.surface(surface_));
      if (whole_ == nullptr) continue;
      for (line_ = 0; line_ < whole_->n_lines(); ++line_) cut_line(whole_->line(line_));
    }
    return std::move(result_);
  }

 private:
  Vec3 on_line(Vec3 p) const { return whole_->nearest_on_line(line_, p); }

  bool is_on(int d, Vec3 p) const { return d != surface_ && std::abs(solid_.signed_distance(d, p)) <= tolerance_; }

  /// The same corner for all that is nearer to it than rounding.
  Vec3 corner(Vec3 p) {
    for (const Vec3 known : result_.corners)
      if (norm(known - p) < tolerance_) return known;
    result_.corners.push_back(p);
    return p;
  }

  /// More points where another surface may be crossed twice between two of them: the signed distance from it cannot
  /// change faster than one moves.
  void add_between(Polyline& to, Vec3 end, int depth) const {
    const Vec3 begin = to.back();
    const double length = norm(end - begin);
    for (int d = 0; d < solid_.n_surfaces() && depth > 0; ++d) {
      if (d == surface_) continue;
      const double f = solid_.signed_distance(d, begin), g = solid_.signed_distance(d, end);
      if ((f < 0) != (g < 0) || std::abs(f) + std::abs(g) > 1.01 * length) continue;
      if (std::max(std::abs(f), std::abs(g)) <= tolerance_) continue;
      const Vec3 middle = on_line(midpoint(begin, end));
      add_between(to, middle, depth - 1);
      add_between(to, end, depth - 1);
      return;
    }
    to.push_back(end);
  }

  Vec3 crossing(int d, Vec3 begin, Vec3 end) {
    const bool begins_behind = solid_.signed_distance(d, begin) < 0;
    for (int i = 0; i < 60; ++i) {
      const Vec3 middle = on_line(midpoint(begin, end));
      if (middle == begin || middle == end) break;
      ((solid_.signed_distance(d, middle) < 0) == begins_behind ? begin : end) = middle;
    }
    return corner(solid_.on_planes(std::array{d}, begin));
  }

  /// A point of the crease, moved to the corner where it lies on another surface.
  std::pair<Vec3, bool> settled(Vec3 p) {
    std::vector<int> among;
    for (int d = 0; d < solid_.n_surfaces(); ++d)
      if (is_on(d, p)) among.push_back(d);
    if (among.empty()) return {p, false};
    return {corner(solid_.on_planes(among, p)), true};
  }

  void cut_line(const Polyline& line) {
    Polyline fine{line.front()};
    for (std::size_t i = 1; i < line.size(); ++i) add_between(fine, line[i], 12);
    const auto [first, is_first_cut] = settled(fine.front());
    std::vector<Polyline> parts{{first}};
    const auto part_at = [&](Vec3 p) {
      parts.back().push_back(p);
      parts.push_back({p});
    };
    for (std::size_t i = 1; i < fine.size(); ++i) {
      std::vector<std::pair<double, Vec3>> crossings;
      for (int d = 0; d < solid_.n_surfaces(); ++d) {
        if (d == surface_ || is_on(d, fine[i - 1]) || is_on(d, fine[i])) continue;
        if ((solid_.signed_distance(d, fine[i - 1]) < 0) == (solid_.signed_distance(d, fine[i]) < 0)) continue;
        const Vec3 p = crossing(d, fine[i - 1], fine[i]);
        crossings.emplace_back(norm(p - fine[i - 1]), p);
      }
      std::sort(crossings.begin(), crossings.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
      for (const auto& [distance, p] : crossings)
        if (p != parts.back().front() || parts.back().size() > 1) part_at(p);
      const auto [next, is_cut] = settled(fine[i]);
      if (is_cut && i + 1 < fine.size()) {
        part_at(next);
      } else {
        parts.back().push_back(next);
      }
    }
    if (line.front() == line.back() && parts.size() > 1 && !is_first_cut) {
      auto& begin = parts.front();
      parts.back().insert(parts.back().end(), begin.begin() + 1, begin.end());
      begin = std::move(parts.back());
      parts.pop_back();
    }
    for (auto& part : parts) keep(std::move(part));
  }

  void keep(Polyline part) {
    if (part.size() == 2) part.insert(part.begin() + 1, on_line(midpoint(part[0], part[1])));
    const Vec3 middle = part[part.size() / 2];
    Sides undecided = 0;
    for (int d = 0; d < solid_.n_surfaces(); ++d)
      if (is_on(d, middle)) undecided |= Sides{1} << d;
    const Sides sides = solid_.sides(middle);
    if (undecided != 0 && (solid_.divides(surface_, sides & ~undecided) || solid_.divides(surface_, sides | undecided)))
      throw Error(
          fmt::format("expected sharp edges of \"{}\" that other surfaces cross or leave alone, found one at ({:g}, "
                      "{:g}, {:g}) that lies in another surface",
                      solid_.name(surface_), middle.x, middle.y, middle.z));
    if (solid_.divides(surface_, sides)) result_.parts.push_back({surface_, line_, std::move(part)});
  }

  const Solid& solid_;
  double tolerance_;
  int surface_ = 0;
  std::shared_ptr<const DividedSurface> whole_;
  std::size_t line_ = 0;
  CutCreases result_;
};

}  // namespace

CutCreases cut_creases(const Solid& solid) { return Cutter(solid).cut(); }

}  // namespace pamr::meshing
