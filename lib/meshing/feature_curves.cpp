// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/feature_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "meshing/curve_trace.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;
using Polyline = std::vector<Vec3>;

/// A part of a common curve between two corners, or all of it.
struct Arc {
  std::array<int, 2> piece{};
  Polyline point;

  bool is_closed() const { return point.front() == point.back(); }
};

std::string text_of(Vec3 p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

class Tracer {
 public:
  Tracer(const Solid& solid, const Pieces& pieces)
      : solid_(solid),
        pieces_(pieces),
        tolerance_(1e-9 * solid.radius()),
        n_crease_corners_(static_cast<std::ptrdiff_t>(pieces.crease_corners().size())),
        corners_(pieces.crease_corners()) {}

  std::vector<Arc> edges(const SurfaceSamples& samples) {
    for (int a = 0; a < solid_.n_surfaces(); ++a)
      for (int b = a + 1; b < solid_.n_surfaces(); ++b) {
        auto starts = samples[static_cast<std::size_t>(a)];
        const auto& others = samples[static_cast<std::size_t>(b)];
        starts.insert(starts.end(), others.begin(), others.end());
        trace_pieces(a, b, starts);
      }
    join();
    require_whole_corners();
    part_loops();
    return std::move(arcs_);
  }

 private:
  /// Each start serves the pieces that are nearest to it, each corner on creases the pieces that meet there.
  void trace_pieces(int a, int b, const Polyline& starts) {
    const auto of_a = pieces_.of(a), of_b = pieces_.of(b);
    std::map<std::array<int, 2>, Polyline> sorted;
    for (int p = of_a.begin; p < of_a.end; ++p)
      for (int q = of_b.begin; q < of_b.end; ++q) {
        auto& own = sorted[{p, q}];
        for (const Vec3 corner : pieces_.crease_corners())
          if (pieces_.at(p).shape->distance(corner) < tolerance_ && pieces_.at(q).shape->distance(corner) < tolerance_)
            own.push_back(corner);
      }
    for (const Vec3 start : starts) sorted[{pieces_.nearest(a, start), pieces_.nearest(b, start)}].push_back(start);
    for (const auto& [piece, own] : sorted) {
      const CommonCurve curve(solid_, pieces_, piece);
      for (auto& trace : curve.trace(own)) {
        if (!trace.is_closed) end_in_corners(trace.point);
        cut(curve, trace);
      }
    }
  }

  /// Lets a curve that comes to a crease end in the corner there.
  void end_in_corners(Polyline& points) const {
    const double near = 3e-6 * solid_.radius(), around = 1e-3 * solid_.radius();
    for (int end = 0; end < 2; ++end) {
      std::reverse(points.begin(), points.end());
      for (const Vec3 corner : pieces_.crease_corners()) {
        if (norm(points.back() - corner) > near) continue;
        while (points.size() > 1 && norm(points.back() - corner) < around) points.pop_back();
        points.push_back(corner);
        break;
      }
    }
  }

  /// The same corner for all that is nearer to it than rounding.
  Vec3 corner(Vec3 p) {
    for (const Vec3 known : corners_)
      if (norm(known - p) < tolerance_) return known;
    corners_.push_back(p);
    return p;
  }

  /// More points where a third surface may be crossed twice between two of them: the signed distance from it cannot
  /// change faster than one moves.
  void add_between(const CommonCurve& curve, Polyline& to, Vec3 end, int depth) const {
    const Vec3 begin = to.back();
    const double length = norm(end - begin);
    for (int d = 0; d < solid_.n_surfaces() && depth > 0; ++d) {
      if (d == curve.a() || d == curve.b()) continue;
      const double f = solid_.signed_distance(d, begin), g = solid_.signed_distance(d, end);
      if ((f < 0) != (g < 0) || std::abs(f) + std::abs(g) > 1.01 * length) continue;
      if (std::max(std::abs(f), std::abs(g)) < tolerance_) refuse_common(curve, d, begin);
      const auto middle = curve.project(midpoint(begin, end));
      if (!middle.is_on_curve) break;
      add_between(curve, to, middle.point, depth - 1);
      add_between(curve, to, end, depth - 1);
      return;
    }
    to.push_back(end);
  }

  [[noreturn]] void refuse_common(const CommonCurve& curve, int d, Vec3 p) const {
    throw Error(fmt::format("expected at most two surfaces in a curve, found \"{}\", \"{}\" and \"{}\" near {}",
                            solid_.name(curve.a()), solid_.name(curve.b()), solid_.name(d), text_of(p)));
  }

  /// Where surface `d` crosses the curve between two of its points on different sides of it.
  Vec3 crossing(const CommonCurve& curve, int d, Vec3 begin, Vec3 end) {
    const bool begins_behind = solid_.signed_distance(d, begin) < 0;
    for (int i = 0; i < 60; ++i) {
      const auto middle = curve.project(midpoint(begin, end));
      if (!middle.is_on_curve || middle.point == begin || middle.point == end) break;
      ((solid_.signed_distance(d, middle.point) < 0) == begins_behind ? begin : end) = middle.point;
    }
    std::array<int, 3> number{curve.a(), curve.b(), d};
    std::sort(number.begin(), number.end());
    std::array<const geometry::Surface*, 3> all{};
    std::transform(number.begin(), number.end(), all.begin(),
                   [&](int i) { return i == d ? &solid_.surface(d) : curve.shape()[i == curve.a() ? 0 : 1]; });
    const auto found = geometry::project_onto_all(all, begin);
    return corner(found.converged && norm(found.point - begin) < 1e3 * tolerance_
                      ? solid_.on_planes(number, found.point)
                      : begin);
  }

  /// Cuts at every third surface and keeps the parts that are edges of the solid.
  void cut(const CommonCurve& curve, const CommonCurve::Trace& trace) {
    Polyline fine{trace.point.front()};
    for (std::size_t i = 1; i < trace.point.size(); ++i) add_between(curve, fine, trace.point[i], 12);
    std::vector<Polyline> parts{{fine.front()}};
    for (std::size_t i = 1; i < fine.size(); ++i) {
      const auto before = solid_.sides(fine[i - 1]) ^ solid_.sides(fine[i]);
      std::vector<std::pair<double, Vec3>> crossings;
      for (int d = 0; d < solid_.n_surfaces(); ++d)
        if (d != curve.a() && d != curve.b() && (before >> d & 1U) != 0) {
          const Vec3 p = crossing(curve, d, fine[i - 1], fine[i]);
          crossings.emplace_back(norm(p - fine[i - 1]), p);
        }
      std::sort(crossings.begin(), crossings.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
      for (const auto& [distance, p] : crossings) {
        append(parts.back(), p);
        parts.push_back({p});
      }
      append(parts.back(), fine[i]);
    }
    if (trace.is_closed && parts.size() > 1) {
      auto& first = parts.front();
      parts.back().insert(parts.back().end(), first.begin() + 1, first.end());
      first = std::move(parts.back());
      parts.pop_back();
    }
    for (auto& part : parts)
      if (part.size() > 1) keep_if_edge(curve, std::move(part));
  }

  /// Leaves out a point that is equal to the last one to within rounding; corners stay.
  void append(Polyline& to, Vec3 p) {
    if (norm(to.back() - p) > 10 * tolerance_) {
      to.push_back(p);
    } else if (to.size() > 1) {
      to.back() = p;
    }
  }

  void keep_if_edge(const CommonCurve& curve, Polyline part) {
    if (part.size() == 2) {
      const auto middle = curve.project(midpoint(part[0], part[1]));
      if (middle.is_on_curve) part.insert(part.begin() + 1, middle.point);
    }
    if (!is_edge(curve, part[part.size() / 2])) return;
    const bool is_closed = part.front() == part.back();
    const auto is_corner = [this](Vec3 p) { return std::find(corners_.begin(), corners_.end(), p) != corners_.end(); };
    if (!is_closed && !(is_corner(part.front()) && is_corner(part.back())))
      throw Error(
          fmt::format("expected edges that close or end in corners inside the bounds, found one of \"{}\" and "
                      "\"{}\" that ends at {} and {}",
                      solid_.name(curve.a()), solid_.name(curve.b()), text_of(part.front()), text_of(part.back())));
    arcs_.push_back({curve.piece(), std::move(part)});
  }

  /// True when both surfaces bound the solid, or regions of it, here.
  bool is_edge(const CommonCurve& curve, Vec3 p) const {
    const Sides a = Sides{1} << curve.a(), b = Sides{1} << curve.b(), rest = solid_.sides(p) & ~(a | b);
    const auto in = [&](Sides sides) { return solid_.region_of(rest | sides); };  // -1: outside
    const int none = in(0), only_a = in(a), only_b = in(b), all = in(a | b);
    const bool depends_on_a = none != only_a || only_b != all, depends_on_b = none != only_b || only_a != all;
    if (!depends_on_a || !depends_on_b) return false;
    if ((none < 0 && all < 0 && only_a >= 0 && only_b >= 0) || (only_a < 0 && only_b < 0 && none >= 0 && all >= 0))
      throw Error(fmt::format("expected {}, found one that does where \"{}\" and \"{}\" meet at {}",
                              solid_.regions.size() == 1
                                  ? "a region that does not touch itself"
                                  : "no region that touches another one, or itself, along an edge alone",
                              solid_.name(curve.a()), solid_.name(curve.b()), text_of(p)));
    return true;
  }

  /// Arcs of the same surfaces become one where nothing else ends.
  void join() {
    for (bool has_joined = true; has_joined;) {
      has_joined = false;
      for (std::size_t i = 0; i < arcs_.size() && !has_joined; ++i)
        for (const bool at_end : {true, false}) {
          const auto j = only_other(i, at_end ? arcs_[i].point.back() : arcs_[i].point.front());
          if (j == arcs_.size()) continue;
          connect(i, j, at_end);
          has_joined = true;
          break;
        }
    }
  }

  /// The arc of the same surfaces that ends at p, when it is the only one to do so beside arc i; else the number of
  /// arcs.
  std::size_t only_other(std::size_t i, Vec3 p) const {
    if (arcs_[i].is_closed() || is_crease_corner(p)) return arcs_.size();
    std::size_t found = arcs_.size(), n_ends = 0;
    for (std::size_t j = 0; j < arcs_.size(); ++j) {
      if (j == i || (arcs_[j].point.front() != p && arcs_[j].point.back() != p)) continue;
      ++n_ends;
      found = j;
    }
    const bool is_same = n_ends == 1 && arcs_[found].piece == arcs_[i].piece;
    return is_same && !arcs_[found].is_closed() ? found : arcs_.size();
  }

  bool is_crease_corner(Vec3 p) const {
    const auto end = corners_.begin() + n_crease_corners_;
    return std::find(corners_.begin(), end, p) != end;
  }

  /// Where another surface ends a crease, a curve must go on along each side of it.
  void require_whole_corners() const {
    const auto creases = pieces_.creases();
    const auto n_ends = [](Vec3 p, const Polyline& line) { return (line.front() == p) + (line.back() == p); };
    for (const Vec3 corner : pieces_.crease_corners()) {
      int n_creases = 0, n_arcs = 0;
      for (const auto& crease : creases) n_creases += n_ends(corner, crease.polyline);
      for (const auto& arc : arcs_) n_arcs += n_ends(corner, arc.point);
      if ((n_creases == 1 && n_arcs < 2) || (n_creases == 0 && n_arcs == 1))
        throw Error(
            fmt::format("expected surfaces that meet at more than 5 degrees where one cuts a sharp edge of another, "
                        "found less at {}",
                        text_of(corner)));
    }
  }

  /// Parts a closed curve that begins and ends in a corner on a crease: closed ones have no corner.
  void part_loops() {
    for (std::size_t i = 0, n = arcs_.size(); i < n; ++i) {
      auto& loop = arcs_[i].point;
      if (loop.front() != loop.back() || !is_crease_corner(loop.front())) continue;
      const auto middle = loop.begin() + std::ssize(loop) / 2;
      Arc rest{arcs_[i].piece, {middle, loop.end()}};
      loop.erase(middle + 1, loop.end());
      arcs_.push_back(std::move(rest));
    }
  }

  void connect(std::size_t i, std::size_t j, bool at_end) {
    auto& to = arcs_[i].point;
    auto from = std::move(arcs_[j].point);
    if (!at_end) std::reverse(to.begin(), to.end());
    if (from.front() != to.back()) std::reverse(from.begin(), from.end());
    to.insert(to.end(), from.begin() + 1, from.end());
    arcs_.erase(arcs_.begin() + static_cast<std::ptrdiff_t>(j));
  }

  const Solid& solid_;
  const Pieces& pieces_;
  double tolerance_;
  std::ptrdiff_t n_crease_corners_;
  std::vector<Vec3> corners_;  ///< those on creases first
  std::vector<Arc> arcs_;
};

}  // namespace

std::vector<FeatureCurve> trace_feature_curves(const std::shared_ptr<const Solid>& solid,
                                               const std::shared_ptr<const Pieces>& pieces,
                                               const SurfaceSamples& samples) {
  std::vector<FeatureCurve> result;
  for (auto& arc : Tracer(*solid, *pieces).edges(samples))
    result.push_back({std::move(arc.point), [solid, pieces, piece = arc.piece](Vec3 p) {
                        return CommonCurve(*solid, *pieces, piece).project(p).point;
                      }});
  return result;
}

}  // namespace pamr::meshing
