// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/level0_shapes.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/quadratic_tet.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/uniform_shape.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::curved {

namespace {

using geometry::Vec3;
using mesh::tet::edge_to_corner;

constexpr int n_levels = Level0Shapes::n_levels;
constexpr int n_parts = 1 << n_levels;

/// A place in a bent cell: weights of the row's corners, in parts of `n_parts`.
using Weights = std::array<int, 4>;

/// The order of a row's corners in which the straight cell has positive volume.
std::array<std::size_t, 4> positive_order(const mesh::Level0Cell& row) {
  return geometry::volume(row.corner) > 0 ? std::array<std::size_t, 4>{0, 1, 2, 3}
                                          : std::array<std::size_t, 4>{0, 1, 3, 2};
}

geometry::QuadraticTet quadratic_part(const mesh::Level0Cell& row) {
  const auto order = positive_order(row);
  geometry::QuadraticTet tet;
  for (std::size_t i = 0; i < 4; ++i) tet[i][i] = row.corner[order[i]];
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      tet[i][j] = tet[j][i] =
          geometry::midpoint(tet[i][i], tet[j][j]) + row.bulge[at(mesh::tet::edge_of[order[i]][order[j]])];
  return tet;
}

/// The share of the walls in the Jacobian at a point of a cell.
JacobianRows residual_rows(const mesh::Level0Map& map, LocalId cell, const std::array<double, 4>& weight,
                           mesh::KnownSteps& known) {
  constexpr double step = 1e-5;
  const auto corner = at(std::find(weight.begin(), weight.end(), 1.0) - weight.begin());
  if (corner < 4) {  // along its edges: walls may end there
    std::array<Vec3, 4> slope{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto residual = [&](double share) {
        auto place = weight;
        place[i] = share;
        place[corner] = 1 - share;
        return map.wall_residual(cell, place, &known);
      };
      // not from the corner itself: a node of level 0 that is off its wall makes a step there
      if (i != corner) slope[i] = (0.5 / step) * (8 * residual(2 * step) - 5 * residual(step) - 3 * residual(3 * step));
    }
    return {slope[1] - slope[0], slope[2] - slope[0], slope[3] - slope[0]};
  }
  const double inward = map.has_wall_that_ends(cell) ? 1e-3 : 0;  // so that both steps lie inside
  JacobianRows rows{};
  auto here = weight;
  for (auto& w : here) w += inward * (0.25 - w);
  for (std::size_t i = 0; i < 3; ++i) {
    auto ahead = here, behind = here;
    ahead[i + 1] += step;
    ahead[0] -= step;
    behind[i + 1] -= step;
    behind[0] += step;
    rows[i] = (0.5 / step) * (map.wall_residual(cell, ahead, &known) - map.wall_residual(cell, behind, &known));
  }
  return rows;
}

/// The tetrahedron that the Jacobian at a sample point makes of the reference tetrahedron, walls included.
geometry::TetPoints image_of_jacobian(const mesh::Level0Cell& row, const SampledRows* walls, std::size_t q) {
  const auto& l = sample_points[q];
  auto image = walls != nullptr ? (*walls)[q] : JacobianRows{};
  for (std::size_t k = 0; k < 3; ++k) image[k] += row.corner[k + 1] - row.corner[0];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = edge_to_corner[e];
    std::array<double, 4> slope{};  // of 4 l_i l_j
    slope[at(i)] = 4 * l[at(j)];
    slope[at(j)] = 4 * l[at(i)];
    for (std::size_t k = 0; k < 3; ++k) image[k] += (slope[k + 1] - slope[0]) * row.bulge[e];
  }
  const auto order = positive_order(row);
  return {Vec3{}, image[order[1] - 1], image[order[2] - 1], image[order[3] - 1]};
}

/// Splits a bent cell into eight, and these again.
class Splitter {
 public:
  Splitter(const mesh::Level0Map& map, LocalId cell, int last_level = n_levels)
      : map_(&map), row_(&map.cells()[at(cell)]), cell_(cell), last_level_(last_level) {
    const auto order = positive_order(*row_);
    std::array<Weights, 4> corner{};
    geometry::TetPoints points;
    for (std::size_t i = 0; i < 4; ++i) {
      corner[i][order[i]] = n_parts;
      points[i] = row_->corner[order[i]];
    }
    add(points, 0);
    split(corner, 1);
    for (auto& worst : worst_) worst.value = std::cbrt(worst.value);
  }

  /// Smallest mean ratio of each level, with the centroid of its cell.
  const std::array<mesh::WorstPlace, n_levels + 1>& worst() const { return worst_; }

 private:
  static constexpr std::size_t a_side = n_parts + 1, size = a_side * a_side * a_side;

  void add(const geometry::TetPoints& p, int level) {
    auto& worst = worst_[at(level)];
    const double cubed = refine::cube_of_shape * refine::shape(p);
    if (cubed < worst.value) worst = {cubed, geometry::centroid(p)};
  }

  void split(const std::array<Weights, 4>& corner, int level) {
    std::array<Weights, 10> node{};
    refine::SplitPoints points;
    for (std::size_t i = 0; i < 4; ++i) node[i] = corner[i];
    for (std::size_t e = 0; e < 6; ++e)
      for (std::size_t i = 0; i < 4; ++i)
        node[4 + e][i] = (corner[at(edge_to_corner[e][0])][i] + corner[at(edge_to_corner[e][1])][i]) / 2;
    for (std::size_t code = 0; code < 10; ++code) points[code] = point(node[code]);
    const int state = refine::regular_state + refine::choose_diagonal(points, false);
    for (int child = 0; child < refine::max_children; ++child) {
      add(refine::child_points(points, state, child), level);
      if (level == last_level_) continue;
      const auto& code = refine::split_pattern[at(state)].child_to_node[at(child)];
      split({node[at(code[0])], node[at(code[1])], node[at(code[2])], node[at(code[3])]}, level + 1);
    }
  }

  const Vec3& point(const Weights& w) {
    const auto place = at((w[0] * (n_parts + 1) + w[1]) * (n_parts + 1) + w[2]);
    if (!is_known_[place]) {
      is_known_[place] = true;
      point_[place] = find_point(w);
    }
    return point_[place];
  }

  Vec3 find_point(const Weights& w) {
    mesh::CornerWeights weight{};
    Vec3 straight;
    for (std::size_t i = 0; i < 4; ++i) {
      if (w[i] == n_parts) return row_->corner[i];
      weight[i] = std::int64_t{w[i]} << (mesh::Level0Key::one - n_levels);
      straight += (1.0 / n_parts * w[i]) * row_->corner[i];
    }
    const auto placed = map_->place(cell_, weight, &known_);
    return placed ? placed->point : straight;  // edges and faces that are not bent are straight
  }

  const mesh::Level0Map* map_;
  const mesh::Level0Cell* row_;
  LocalId cell_;
  int last_level_;
  std::array<Vec3, size> point_;  // left as they are until known
  std::bitset<size> is_known_;
  mesh::KnownSteps known_;
  std::array<mesh::WorstPlace, n_levels + 1> worst_;  ///< the third power of the ratio until the last is known
};

/// The smallest at all levels.
mesh::WorstPlace over_all_levels(const std::array<mesh::WorstPlace, n_levels + 1>& level,
                                 const std::array<geometry::TetPoints, sample_points.size()>& image,
                                 const geometry::QuadraticTet& tet) {
  const auto by_value = [](const mesh::WorstPlace& a, const mesh::WorstPlace& b) { return a.value < b.value; };
  auto worst = *std::min_element(level.begin(), level.end(), by_value);
  const auto& last = level[n_levels];
  if (const double lost = level[n_levels - 1].value - last.value; last.value - lost < worst.value)
    worst = {last.value - lost, last.where};
  for (std::size_t q = 0; q < image.size(); ++q)
    if (const double limit = mesh::worst_uniform_shape(image[q], worst.value); limit < worst.value)
      worst = {limit, geometry::point_at(tet, sample_points[q])};
  return worst;
}

/// The images at the sample points of a cell, of which the worst is added.
std::array<geometry::TetPoints, sample_points.size()> sample(const mesh::Level0Cell& row, const SampledRows* walls,
                                                             mesh::WorstPlaces& worst) {
  std::array<geometry::TetPoints, sample_points.size()> image;
  const auto tet = quadratic_part(row);
  for (std::size_t q = 0; q < image.size(); ++q) {
    image[q] = image_of_jacobian(row, walls, q);
    worst.add(geometry::mean_ratio(image[q]), geometry::point_at(tet, sample_points[q]));
  }
  return image;
}

}  // namespace

double smallest_child(const mesh::Level0Map& map, LocalId cell) {
  const auto worst = Splitter(map, cell, 1).worst();
  return std::min(worst[0].value, worst[1].value);
}

SampledWalls sample_walls(const mesh::Level0Map& map) {
  SampledWalls walls;
  for (std::size_t c = 0; c < map.cells().size(); ++c) {
    const auto& patch = map.cells()[c].edge_patch;
    const bool has_any = std::any_of(patch.begin(), patch.end(), [](const auto& p) { return p[0] >= 0; });
    walls.cell_to_rows.push_back(has_any ? static_cast<LocalId>(walls.rows.size()) : -1);
    if (!has_any) continue;
    auto& rows = walls.rows.emplace_back();
    mesh::KnownSteps known;
    for (std::size_t q = 0; q < rows.size(); ++q)
      rows[q] = residual_rows(map, static_cast<LocalId>(c), sample_points[q], known);
  }
  return walls;
}

mesh::WorstPlace sampled_jacobian(const par::Comm& comm, const mesh::Level0Map& map, const SampledWalls& walls) {
  PAMR_EXPECTS(walls.cell_to_rows.size() == map.cells().size());
  mesh::WorstPlaces worst;
  for (std::size_t c = 0; c < map.cells().size(); ++c) sample(map.cells()[c], walls.of(c), worst);
  return worst.over(comm);
}

Level0Shapes level0_shapes(const par::Comm& comm, const mesh::Level0Map& map, const SampledWalls& walls) {
  PAMR_EXPECTS(walls.cell_to_rows.size() == map.cells().size());
  mesh::WorstPlaces determinant, mean_ratio, all_splits;
  mesh::WorstPlaces sampled;
  std::array<mesh::WorstPlaces, n_levels + 1> split;
  for (std::size_t c = 0; c < map.cells().size(); ++c) {
    const auto& row = map.cells()[c];
    const auto tet = quadratic_part(row);
    const auto image = sample(row, walls.of(c), sampled);
    const auto bounds = geometry::bound_map(tet);
    determinant.add(bounds.determinant.value / std::abs(6 * geometry::volume(row.corner)),
                    geometry::point_at(tet, bounds.determinant.near));
    mean_ratio.add(bounds.mean_ratio.value, geometry::point_at(tet, bounds.mean_ratio.near));
    const auto worst = Splitter(map, static_cast<LocalId>(c)).worst();
    for (std::size_t l = 0; l < split.size(); ++l) split[l].add(worst[l].value, worst[l].where);
    const auto over_all = over_all_levels(worst, image, tet);
    all_splits.add(over_all.value, over_all.where);
  }
  Level0Shapes shapes;
  shapes.determinant = determinant.over(comm);
  shapes.mean_ratio = mean_ratio.over(comm);
  shapes.sampled = sampled.over(comm);
  for (std::size_t l = 0; l < split.size(); ++l) shapes.split[l] = split[l].over(comm).value;
  shapes.all_splits = all_splits.over(comm);
  return shapes;
}

}  // namespace pamr::curved
