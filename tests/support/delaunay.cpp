// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/delaunay.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::test {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<GlobalId, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase>>;
using geometry::Vec3;
using Quad = std::array<GlobalId, 4>;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

struct Cloud {
  std::vector<Vec3> point;
  std::vector<Quad> cell;

  geometry::TetPoints points(const Quad& n) const {
    return {point[at(n[0])], point[at(n[1])], point[at(n[2])], point[at(n[3])]};
  }
};

/// Delaunay tetrahedra, ascending in their corners whatever the order in which CGAL holds them.
std::vector<Quad> tetrahedra(const std::vector<Vec3>& point) {
  std::vector<std::pair<Kernel::Point_3, GlobalId>> numbered;
  for (const auto& p : point)
    numbered.emplace_back(Kernel::Point_3(p.x, p.y, p.z), static_cast<GlobalId>(numbered.size()));
  const Delaunay delaunay(numbered.begin(), numbered.end());
  std::vector<Quad> cells;
  for (auto c = delaunay.finite_cells_begin(); c != delaunay.finite_cells_end(); ++c) {
    Quad n{};
    for (int i = 0; i < 4; ++i) n[at(i)] = c->vertex(i)->info();
    // the smallest number first, by even permutations: a swap of two pairs, then a turn of the last three
    const auto first = std::min_element(n.begin(), n.end()) - n.begin();
    if (first != 0) n = {n[at(first)], n[at(first ^ 1)], n[at(first ^ 2)], n[at(first ^ 3)]};
    std::rotate(n.begin() + 1, std::min_element(n.begin() + 1, n.end()), n.end());
    cells.push_back(n);
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

constexpr std::uint64_t n_kinds = 6;

std::vector<Vec3> random_points(Dice& dice, std::uint64_t kind) {
  std::vector<Vec3> point;
  const auto somewhere = [&dice] { return Vec3{dice.unit(), dice.unit(), dice.unit()}; };
  const auto n = 7 + dice.below(34);
  if (kind == 0)
    for (int draw = 0; draw < 200 && point.size() < n; ++draw) {
      const auto p = somewhere();
      if (std::all_of(point.begin(), point.end(), [&](Vec3 q) { return norm(p - q) > 0.3; })) point.push_back(p);
    }
  if (kind == 1)
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = 2.0 * somewhere() - Vec3{1, 1, 1};
      point.push_back(i % 3 == 0 || norm(p) < 0.1 ? 0.5 * p : 1 / norm(p) * p);
    }
  if (kind == 2)
    for (std::size_t i = 0; i < n; ++i) point.push_back({dice.unit(), 0.4 * dice.unit(), 0.15 * dice.unit()});
  if (kind >= 3) {
    const double shake = kind == 3 ? 0.0 : kind == 4 ? 0.05 : 0.12;
    const std::array<std::size_t, 3> size{2 + dice.below(2), 2 + dice.below(2), 2 + dice.below(2)};
    const auto add = [&](double x, double y, double z) {
      point.push_back(Vec3{x, y, z} + shake * (2.0 * somewhere() - Vec3{1, 1, 1}));
    };
    for (std::size_t i = 0; i < size[0]; ++i)
      for (std::size_t j = 0; j < size[1]; ++j)
        for (std::size_t k = 0; k < size[2]; ++k) {
          const auto x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
          add(x, y, z);
          const bool has_center = kind >= 4 && i + 1 < size[0] && j + 1 < size[1] && k + 1 < size[2];
          if (has_center) add(x + 0.5, y + 0.5, z + 0.5);
        }
  }
  dice.shuffle(point);
  return point;
}

/// To multiples of 2^-18.
void round_to_whole(std::vector<Vec3>& point) {
  for (auto& p : point)
    p = {std::round(p.x * 0x1p18) * 0x1p-18, std::round(p.y * 0x1p18) * 0x1p-18, std::round(p.z * 0x1p18) * 0x1p-18};
}

using Triangle = std::set<GlobalId>;

std::map<Triangle, int> boundary_faces(const std::vector<Quad>& cells) {
  std::map<Triangle, int> count;
  for (const auto& n : cells)
    for (std::size_t f = 0; f < 4; ++f) {
      Triangle triangle(n.begin(), n.end());
      triangle.erase(n[f]);
      ++count[triangle];
    }
  std::erase_if(count, [](const auto& entry) { return entry.second != 1; });
  return count;
}

bool touches_itself(const std::vector<Quad>& cells) {
  std::map<std::set<GlobalId>, int> faces_at_edge;
  for (const auto& [triangle, once] : boundary_faces(cells))
    for (const auto node : triangle) {
      auto edge = triangle;
      edge.erase(node);
      faces_at_edge[edge] += once;
    }
  return std::any_of(faces_at_edge.begin(), faces_at_edge.end(), [](const auto& entry) { return entry.second != 2; });
}

void remove_flat(Cloud& cloud, double min_mean_ratio) {
  std::erase_if(cloud.cell, [&](const Quad& n) {
    const auto p = cloud.points(n);
    return !geometry::is_positive(p[0], p[1], p[2], p[3]) || geometry::mean_ratio(p) < min_mean_ratio;
  });
}

/// Takes away each cell at the boundary with chance one in five.
void carve(Cloud& cloud, Dice& dice) {
  const auto outside = boundary_faces(cloud.cell);
  std::erase_if(cloud.cell, [&](const Quad& n) {
    bool is_outside = false;
    for (const auto node : n) {
      Triangle triangle(n.begin(), n.end());
      triangle.erase(node);
      is_outside = is_outside || outside.count(triangle) != 0;
    }
    return is_outside && dice.below(5) == 0;
  });
}

/// Cells, nodes and corners in random order, unused nodes left out.
void shuffle(Cloud& cloud, Dice& dice) {
  std::set<GlobalId> used;
  for (const auto& n : cloud.cell) used.insert(n.begin(), n.end());
  std::vector<GlobalId> order(used.begin(), used.end());
  dice.shuffle(order);
  std::map<GlobalId, GlobalId> to_new;
  std::vector<Vec3> point;
  for (const auto old : order) {
    to_new[old] = static_cast<GlobalId>(point.size());
    point.push_back(cloud.point[at(old)]);
  }
  dice.shuffle(cloud.cell);
  for (auto& n : cloud.cell) {
    for (auto& node : n) node = to_new.at(node);
    // even permutations: swaps of two pairs, then a turn of the last three
    const auto first = dice.below(4);
    n = {n[first], n[first ^ 1U], n[first ^ 2U], n[first ^ 3U]};
    std::rotate(n.begin() + 1, n.begin() + 1 + static_cast<std::ptrdiff_t>(dice.below(3)), n.end());
  }
  cloud.point = point;
}

mesh::BlockMesh to_block(const Cloud& cloud) {
  mesh::BlockMesh whole;
  whole.info.n_global_nodes = static_cast<GlobalId>(cloud.point.size());
  whole.info.n_global_cells = static_cast<GlobalId>(cloud.cell.size());
  whole.node_position = cloud.point;
  whole.cell_to_node = cloud.cell;
  whole.cell_to_cell = reference_neighbors(cloud.cell);
  return whole;
}

}  // namespace

mesh::BlockMesh random_delaunay(std::uint64_t seed, bool whole_numbers) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    Dice dice(combine(mix(seed), attempt));
    Cloud cloud;
    cloud.point = random_points(dice, seed % n_kinds);
    if (whole_numbers) round_to_whole(cloud.point);
    cloud.cell = tetrahedra(cloud.point);
    remove_flat(cloud, seed % n_kinds >= 4 ? 0.3 : (seed / n_kinds) % 2 == 0 ? 1e-6 : 0.1);
    if ((seed / n_kinds) % 3 == 0) carve(cloud, dice);
    if (cloud.cell.size() < 10 || touches_itself(cloud.cell)) continue;
    shuffle(cloud, dice);
    auto whole = to_block(cloud);
    whole.info.patches = {{"wall", "patch"}, {"inlet", "patch"}, {"outlet", "patch"}};
    for (auto& neighbors : whole.cell_to_cell)
      for (auto& neighbor : neighbors)
        if (neighbor < 0) neighbor = -1 - static_cast<GlobalId>(dice.below(3));
    return whole;
  }
}

mesh::BlockMesh random_ball(std::uint64_t seed) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    Dice dice(combine(mix(seed + 2), attempt));
    Cloud cloud;
    cloud.point = random_points(dice, 1);
    cloud.cell = tetrahedra(cloud.point);
    shuffle(cloud, dice);
    auto whole = to_block(cloud);  // reference_neighbors gives patch 0
    bool all_on_sphere = true;
    for (std::size_t c = 0; c < cloud.cell.size(); ++c)
      for (std::size_t f = 0; f < 4; ++f)
        for (std::size_t i = 0; i < 4; ++i)
          if (whole.cell_to_cell[c][f] < 0 && i != f)
            all_on_sphere = all_on_sphere && std::abs(norm(cloud.point[at(cloud.cell[c][i])]) - 1) < 1e-14;
    const bool is_good = std::all_of(cloud.cell.begin(), cloud.cell.end(),
                                     [&](const Quad& n) { return geometry::mean_ratio(cloud.points(n)) > 1e-3; });
    if (!is_good || !all_on_sphere || touches_itself(cloud.cell)) continue;
    whole.info.patches = {{"ball", "patch", 0}};
    whole.info.surfaces =
        surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");
    return whole;
  }
}

mesh::BlockMesh random_dome(std::uint64_t seed) {
  constexpr double radius = 4;
  const auto height = [](double x, double y) { return std::sqrt(radius * radius - x * x - y * y) - radius; };
  for (std::uint64_t attempt = 0;; ++attempt) {
    Dice dice(combine(mix(seed + 1), attempt));
    Cloud cloud;
    // a lattice with centers, its uppermost nodes on the dome
    constexpr double step = 1.0 / 3, shake = 0.02;
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; j <= 3; ++j)
        for (int k = 0; k <= 2; ++k) {
          const double x = step * i - 0.5 + shake * dice.symmetric(), y = step * j - 0.5 + shake * dice.symmetric();
          const double z = -step * k + (k == 1 ? shake * dice.symmetric() : 0);
          cloud.point.push_back({x, y, k == 0 ? height(x, y) : z});
          if (i < 3 && j < 3 && k < 2) cloud.point.push_back({x + step / 2, y + step / 2, z - step / 2});
        }
    cloud.cell = tetrahedra(cloud.point);
    remove_flat(cloud, 0.3);
    if (touches_itself(cloud.cell)) continue;
    shuffle(cloud, dice);
    auto whole = to_block(cloud);
    whole.info.patches = {{"wall", "patch"}, {"dome", "patch", 0}};
    whole.info.surfaces =
        surfaces_of("[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = [0, 0, -4]\nradius = 4\n");
    const auto lies_on_dome = [&](const Vec3& p) { return std::abs(p.z - height(p.x, p.y)) < 1e-14; };
    for (std::size_t c = 0; c < whole.cell_to_cell.size(); ++c)
      for (std::size_t f = 0; f < 4; ++f) {
        bool all = true;
        for (std::size_t i = 0; i < 4; ++i) all = all && (i == f || lies_on_dome(cloud.point[at(cloud.cell[c][i])]));
        if (whole.cell_to_cell[c][f] < 0 && all) whole.cell_to_cell[c][f] = -2;
      }
    return whole;
  }
}

}  // namespace pamr::test
