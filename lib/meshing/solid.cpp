// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::meshing {

using geometry::Vec3;

namespace {

constexpr Sides bit(int i) { return Sides{1} << i; }

}  // namespace

Vec3 Solid::on_planes(std::span<const int> among, Vec3 p) const {
  for (const int i : among)
    if (surface(i).is_flat()) p = surface(i).project(p);
  return p;
}

Solid::SidesAround Solid::sides_around(Vec3 p) const {
  constexpr double rounding = 1e-9;
  SidesAround result{0, std::numeric_limits<double>::infinity()};
  for (int i = 0; i < n_surfaces(); ++i) {
    const double distance = signed_distance(i, p);
    if (distance >= 0) result.sides |= bit(i);
    result.radius = std::min(result.radius, (1 - rounding) * std::abs(distance));
  }
  return result;
}

int Solid::region_of(Sides sides) const {
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (regions[r].contains(sides)) return static_cast<int>(r);
  return -1;
}

void Solid::require_apart(Sides sides, Vec3 p) const {
  const int first = region_of(sides);
  for (auto r = static_cast<std::size_t>(first) + 1; first >= 0 && r < regions.size(); ++r)
    if (regions[r].contains(sides))
      throw Error(fmt::format("expected regions that do not overlap, found {} in {} and in {}", geometry::decimal(p),
                              region_names[at(first)], region_names[r]));
}

std::array<int, 2> Solid::regions_beside(int i, Sides sides) const {
  const int a = region_of(sides & ~bit(i)), b = region_of(sides | bit(i));
  if (a < 0 || b < 0) return {std::max(a, b), -1};
  return {std::min(a, b), std::max(a, b)};
}

Solid::Place Solid::place(Vec3 p) const {
  std::array<double, Region::max_surfaces> distance{};
  Sides here = 0;
  const int n = n_surfaces();
  for (int i = 0; i < n; ++i) {
    const double d = signed_distance(i, p);
    if (d >= 0) here |= bit(i);
    distance[static_cast<std::size_t>(i)] = std::abs(d);
  }
  if (const int region = region_of(here); region >= 0) return {-1, region};
  std::array<int, Region::max_surfaces> order{};
  const auto end = order.begin() + n;
  std::iota(order.begin(), end, 0);
  std::sort(order.begin(), end, [&](int a, int b) {
    const double da = distance[static_cast<std::size_t>(a)], db = distance[static_cast<std::size_t>(b)];
    return da < db || (da == db && a < b);
  });
  // Up to three surfaces meet in a corner, so near the solid three crossings are enough.
  for (auto k = order.begin(); k != end; ++k) {
    const Sides last = here ^ bit(*k);
    if (const int region = region_of(last); region >= 0) return {*k, region};
    for (auto j = order.begin(); j != k; ++j) {
      if (const int region = region_of(last ^ bit(*j)); region >= 0) return {*k, region};
      for (auto i = order.begin(); i != j; ++i)
        if (const int region = region_of(last ^ bit(*j) ^ bit(*i)); region >= 0) return {*k, region};
    }
  }
  return {order[static_cast<std::size_t>(n - 1)], -1};
}

SurfaceSamples sample_surfaces(const Solid& solid) {
  constexpr int n = 24;
  SurfaceSamples result(static_cast<std::size_t>(solid.n_surfaces()));
  const Vec3 side = solid.high - solid.low;
  for (int k = 0; k < n * n * n; ++k) {
    // off the middle, because symmetric places have no unique nearest points
    const int x = k % n, y = k / n % n, z = k / n / n;
    const Vec3 p = solid.low + Vec3{(x + 0.47) / n * side.x, (y + 0.52) / n * side.y, (z + 0.49) / n * side.z};
    for (int i = 0; i < solid.n_surfaces(); ++i)
      result[static_cast<std::size_t>(i)].push_back(solid.surface(i).project(p));
  }
  return result;
}

}  // namespace pamr::meshing
