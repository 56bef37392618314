// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/inside_grid.hpp"

#include <cmath>
#include <utility>

#include "meshing/cad_body.hpp"

namespace pamr::meshing {

using geometry::Vec3;

InsideGrid::InsideGrid(std::shared_ptr<const Solid> solid, std::function<int(Vec3)> region)
    : solid_(std::move(solid)), region_(std::move(region)), ball_(static_cast<std::size_t>(n) * n * n, {-1, -1, {}}) {}

bool InsideGrid::is_exact_for(const Solid& solid) {
  bool has_cad = false;
  for (int i = 0; i < solid.n_surfaces(); ++i) {
    const bool is_cad = dynamic_cast<const CadBody*>(&solid.surface(i)) != nullptr;
    if (!is_cad && !solid.surface(i).is_flat()) return false;
    has_cad = has_cad || is_cad;
  }
  return has_cad;
}

Domain::Ball InsideGrid::around(Vec3 point) {
  std::size_t number = 0;
  Vec3 place;
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = (solid_->high[k] - solid_->low[k]) / n, at = (point[k] - solid_->low[k]) / step;
    if (!(at >= 0 && at < n)) return {};
    const double cell = std::floor(at);
    number = number * n + static_cast<std::size_t>(cell);
    (k == 0 ? place.x : k == 1 ? place.y : place.z) = solid_->low[k] + (cell + 0.5) * step;
  }
  auto& ball = ball_[number];
  if (ball.radius < 0) ball = ball_at(place);
  return ball.holds(point) ? ball : Domain::Ball{};
}

Domain::Ball InsideGrid::ball_at(Vec3 place) const {
  const auto found = solid_->sides_around(place);
  const int region = solid_->region_of(found.sides);
  if (region < 0) return {};
  return {region_ ? region_(place) : region, found.radius, place};
}

}  // namespace pamr::meshing
