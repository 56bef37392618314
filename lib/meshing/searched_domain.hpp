// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "meshing/crossing.hpp"
#include "meshing/meshing_domain.hpp"

// A `Domain` as CGAL's mesher asks for it. For mesh3.cpp alone.
namespace pamr::meshing {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using LabelledDomain = CGAL::Labeled_mesh_domain_3<Kernel>;

// CGAL's labels of space: 1 + r is region r, first_piece + p lies behind piece p. Its curves count from 1.
inline constexpr int first_region = 1;
inline int first_piece(const Domain& domain) { return first_region + domain.n_regions(); }

inline geometry::Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

inline bool is_far(const Domain& domain, geometry::Vec3 point) {
  return !(norm(point - domain.center) <= domain.radius);
}

/// What CGAL calls the part of space at a point. It asks far away, too: the dual of a facet between two cells that are
/// flat to rounding ends at 1e16 or at infinity, where a distance says nothing about sides. With "inside" for an answer
/// its bisection would look for the boundary between two neighboring numbers and never end. Nothing beyond the ball is
/// inside.
inline int label_of(const Domain& domain, geometry::Vec3 point) {
  if (is_far(domain, point)) return first_piece(domain);
  const int label = domain.label(point), region = Domain::region_of(label);
  return region >= 0 ? first_region + region : first_piece(domain) + label;
}

inline Domain::Ball ball_about(const Domain& domain, geometry::Vec3 point) {
  if (is_far(domain, point)) return {};
  return domain.around ? domain.around(point) : Domain::Ball{std::max(-1, Domain::region_of(domain.label(point)))};
}

/// The labels of the points asked for last: CGAL asks for the center of a cell's sphere once for the cell and once more
/// for each of its faces.
class KnownLabels {
 public:
  explicit KnownLabels(const Domain& domain) : domain_(&domain) {}

  int operator()(geometry::Vec3 point) {
    auto& entry = entry_[place_of(point)];
    if (!(entry.point == point)) entry = {point, label_of(*domain_, point)};
    return entry.label;
  }

 private:
  static constexpr int n_bits = 14;
  struct Entry {
    geometry::Vec3 point{std::numeric_limits<double>::quiet_NaN(), 0, 0};  // equal to none
    int label = 0;
  };

  static std::size_t place_of(geometry::Vec3 point) {
    constexpr std::uint64_t odd = 0x9e3779b97f4a7c15;  // 2^64 over the golden ratio
    std::uint64_t sum = 0;
    for (const double x : {point.x, point.y, point.z}) sum = (sum ^ std::bit_cast<std::uint64_t>(x)) * odd;
    return sum >> (64 - n_bits);
  }

  const Domain* domain_;
  std::vector<Entry> entry_{std::size_t{1} << n_bits};
};

/// Finds where ways cross the boundary by `find_crossing`: the places of CGAL's own bisection, to the last bit, from a
/// fraction of the searches for the nearest triangle where distances are known.
class SearchedDomain : public LabelledDomain {
 public:
  template <class... Arguments>
  explicit SearchedDomain(const Arguments&... arguments) : LabelledDomain(arguments...) {}

  void search(const Domain& domain, std::function<void(geometry::Vec3)> count) {
    domain_ = &domain;
    count_ = std::move(count);
  }

  class Construct_intersection {
   public:
    explicit Construct_intersection(const SearchedDomain& domain) : domain_(&domain) {}
    template <class Way>
    Intersection operator()(const Way& way) const {
      return domain_->intersection(way);
    }

   private:
    const SearchedDomain* domain_;
  };
  Construct_intersection construct_intersection_object() const { return Construct_intersection(*this); }

 private:
  Intersection intersection(const Segment_3& way) const {
    const std::array<geometry::Vec3, 2> end{from_cgal(way.source()), from_cgal(way.target())};
    const std::array<int, 2> label{this->function_(way.source()), this->function_(way.target())};
    if (label[0] == label[1] || (this->null(label[0]) && this->null(label[1]))) {
      count_(geometry::midpoint(end[0], end[1]));  // limits of questions were measured with CGAL's bisection
      return {};
    }
    const auto crossing = find_crossing(
        end, {region(label[0]), region(label[1])}, this->squared_error_bound_,
        [this](geometry::Vec3 p) { return ball_about(*domain_, p); }, count_);
    std::array<int, 2> found{};
    for (std::size_t i = 0; i < 2; ++i)
      found[i] = crossing.region[i] >= 0     ? first_region + crossing.region[i]
                 : crossing.end[i] == end[i] ? label[i]
                                             : label_of(*domain_, crossing.end[i]);
    const auto& [x, y, z] = crossing.point;
    return {Point_3(x, y, z), index_from_surface_patch_index(make_surface_index(found[0], found[1])), 2};
  }
  template <class Way>
  Intersection intersection(const Way& way) const {
    const auto clipped = CGAL::intersection(way, this->bbox_);
    if (!clipped) return {};
    const auto* inside = segment_in(*clipped);
    return inside != nullptr ? intersection(*inside) : Intersection{};
  }

  template <class Clipped>
  static const Segment_3* segment_in(const Clipped& clipped) {
    if constexpr (requires { std::get_if<Segment_3>(&clipped); })
      return std::get_if<Segment_3>(&clipped);  // CGAL 6
    else
      return boost::get<Segment_3>(&clipped);
  }

  int region(int label) const { return label < first_piece(*domain_) ? label - first_region : -1; }

  const Domain* domain_ = nullptr;
  std::function<void(geometry::Vec3)> count_;
};

}  // namespace pamr::meshing
