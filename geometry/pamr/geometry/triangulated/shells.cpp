// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/shells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"
#include "pamr/geometry/triangulated/groups.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"

namespace pamr::geometry {

namespace {

std::array<Vec3, 3> corners_of(const Triangulation& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return {surface.points[at(a)], surface.points[at(b)], surface.points[at(c)]};
}

/// The angle in space under which a triangle is seen, positive from its back.
/// Source: A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983.
double solid_angle(const std::array<Vec3, 3>& p, Vec3 from) {
  const Vec3 a = p[0] - from, b = p[1] - from, c = p[2] - from;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

SelfIntersections find_contacts(const Triangulation& surface, Shells& shells,
                                const std::function<void(const Cut&)>& use) {
  SelfIntersections found;
  std::map<std::pair<int, int>, Vec3> first;
  for_each_cut(surface, [&](const Cut& cut) {
    found.add(cut);
    if (use) use(cut);
    const int a = shells.of_triangle[at(cut.first)], b = shells.of_triangle[at(cut.second)];
    if (a != b) first.try_emplace(std::minmax(a, b), cut.where);
  });
  for (const auto& [pair, where] : first) {
    shells.contact.push_back({pair.first, pair.second, where});
    shells.shell[at(pair.first)].is_apart = shells.shell[at(pair.second)].is_apart = false;
  }
  return found;
}

void find_depths(const Triangulation& surface, Shells& shells) {
  std::vector<std::vector<std::size_t>> triangles(shells.shell.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) triangles[at(shells.of_triangle[t])].push_back(t);
  for (std::size_t i = 0; i < shells.shell.size(); ++i) {
    auto& inner = shells.shell[i];
    if (!inner.is_closed || !inner.is_apart) continue;
    for (std::size_t j = 0; j < shells.shell.size(); ++j) {
      if (j == i || !shells.shell[j].is_closed || !shells.shell[j].box.contains(inner.where)) continue;
      double angle = 0;
      for (const auto t : triangles[j]) angle += solid_angle(corners_of(surface, t), inner.where);
      if (std::abs(angle) > 2 * std::numbers::pi) ++inner.depth;
    }
  }
}

std::string place_of(const Shell& shell) {
  return fmt::format("a shell of {} triangles at {}", shell.n_triangles, decimal(shell.where));
}

/// Why shells have no inside in `bounds`, where `within` cuts were found; what was expected begins it.
std::optional<std::string> fault_of(const Shells& shells, const SelfIntersections& within, const Box& bounds) {
  const auto contact = std::find_if(shells.contact.begin(), shells.contact.end(),
                                    [&](const Contact& c) { return bounds.contains(c.where); });
  if (contact != shells.contact.end())
    return fmt::format(
        "shells that are clear of one another, found {} that touches or cuts {} near {}: what is "
        "inside is not defined there; unite the two where they were made",
        place_of(shells.shell[at(contact->first)]), place_of(shells.shell[at(contact->second)]),
        decimal(contact->where));
  if (within.n_pairs > 0)
    return fmt::format(
        "triangles that do not cut each other, found some near {}: what is inside is not defined "
        "there; `pamr-surface repair` mends small places",
        decimal(within.first.where));
  const auto turned = turned_shells(shells);
  if (turned.empty() || turned_shells(shells, true).empty()) return std::nullopt;
  const auto& shell = shells.shell[at(turned.front())];
  return fmt::format(
      "shells that face outwards, those inside of others inwards, found {} {}: what is inside is "
      "not defined; `pamr-surface repair` turns it",
      place_of(shell),
      shell.depth == 0 ? "that faces inwards and lies in no other"
                       : fmt::format("that lies inside of {} and faces {}",
                                     shell.depth == 1 ? "another" : std::to_string(shell.depth) + " others",
                                     shell.volume > 0 ? "outwards" : "inwards"));
}

}  // namespace

Shells find_shells(const Triangulation& surface) {
  Shells result;
  const auto n = surface.triangles.size();
  Groups groups(n);
  std::vector<char> has_open_edge(n, 0);
  EdgeTable(surface).for_each_edge([&](std::span<const Side> sides) {
    if (sides.size() == 1) has_open_edge[at(sides[0].triangle)] = 1;
    for (std::size_t i = 1; i < sides.size(); ++i) groups.join(sides[0].triangle, sides[i].triangle);
  });
  std::vector<int> number(n, -1);
  for (std::size_t t = 0; t < n; ++t) {
    auto& known = number[at(groups.of(static_cast<int>(t)))];
    const auto p = corners_of(surface, t);
    if (known < 0) {
      known = static_cast<int>(result.shell.size());
      result.shell.push_back({.where = p[0], .box = {}});
    }
    result.of_triangle.push_back(known);
    auto& shell = result.shell[at(known)];
    ++shell.n_triangles;
    const Vec3 twice = cross(p[1] - p[0], p[2] - p[0]);
    shell.area += 0.5 * norm(twice);
    shell.volume += dot(p[0] - shell.where, twice) / 6;
    if (has_open_edge[t] != 0) shell.is_closed = false;
    shell.box.merge(box_of(p));
  }
  return result;
}

SelfIntersections nest_shells(const Triangulation& surface, Shells& shells,
                              const std::function<void(const Cut&)>& use) {
  const auto found = find_contacts(surface, shells, use);
  find_depths(surface, shells);
  return found;
}

std::vector<int> turned_shells(const Shells& shells, Exact<bool> outside_in) {
  std::vector<int> turned;
  for (std::size_t i = 0; i < shells.shell.size(); ++i) {
    const auto& shell = shells.shell[i];
    if (!shell.is_closed || !shell.is_apart) continue;
    const bool faces_inwards = (shell.depth % 2 == 1) != outside_in;
    if (faces_inwards ? shell.volume > 0 : shell.volume < 0) turned.push_back(static_cast<int>(i));
  }
  return turned;
}

Inside find_inside(const Triangulation& surface, const Box& bounds) {
  auto shells = find_shells(surface);
  SelfIntersections within;
  Inside result;
  result.self_intersections = nest_shells(surface, shells, [&](const Cut& cut) {
    if (bounds.contains(cut.where)) within.add(cut);
  });
  result.fault = fault_of(shells, within, bounds);
  if (result.fault) result.fault = fmt::format("surface \"{}\": expected {}", surface.name, *result.fault);
  return result;
}

}  // namespace pamr::geometry
