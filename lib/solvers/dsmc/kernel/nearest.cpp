// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/geometry/box.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::uint32_t few = 12;    ///< particles that are looked at one by one in any case
constexpr std::uint32_t many = 512;  ///< from which on a search by boxes is faster than one through the filter
static_assert(many <= NearFilter::max_points);
constexpr std::int64_t worth_filter = 2, worth_grid = 16;  ///< searches that pay for the preparation
constexpr int max_boxes = 64;                              ///< along a side

}  // namespace

void NearestInCell::start(const Particles& particles, std::uint32_t begin, std::uint32_t n, std::int64_t n_searches) {
  particles_ = &particles;
  begin_ = begin;
  n_ = n;
  way_ = Way::one_by_one;
  if (n <= few || n_searches < worth_filter) return;
  const auto of_cell = [&](const std::vector<double>& rows) { return std::span(rows).subspan(begin, n); };
  if (n > many && n_searches >= worth_grid) {
    if (make_grid()) way_ = Way::grid;
  } else if (n <= NearFilter::max_points &&
             filter_.start(of_cell(particles.x), of_cell(particles.y), of_cell(particles.z))) {
    way_ = Way::filter;
  }
}

/// False when all particles are in one place.
bool NearestInCell::make_grid() {
  geometry::Box around;
  for (std::uint32_t k = 0; k < n_; ++k) around.extend(particles_->position(begin_ + k));
  low_ = {around.low.x, around.low.y, around.low.z};
  const auto size = around.size();
  double volume = 1, longest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    volume *= size[d];
    longest = std::max(longest, size[d]);
  }
  side_ = std::max(std::cbrt(volume / n_), longest / max_boxes);
  if (!(side_ > 0)) return false;
  std::size_t n_boxes = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    boxes_[d] = std::max(1, static_cast<int>(std::ceil(size[d] / side_)));
    n_boxes *= static_cast<std::size_t>(boxes_[d]);
  }
  first_.assign(n_boxes + 1, 0);
  member_.resize(n_);
  const auto number = [&](std::uint32_t k) {
    const auto box = box_of(particles_->position(begin_ + k));
    return number_of(box[0], box[1], box[2]);
  };
  for (std::uint32_t k = 0; k < n_; ++k) ++first_[number(k) + 1];
  for (std::size_t b = 0; b < n_boxes; ++b) first_[b + 1] += first_[b];
  for (std::uint32_t k = n_; k-- > 0;)
    member_[--first_[number(k) + 1]] = {particles_->position(begin_ + k), tag_of(particles_->id[begin_ + k]), k};
  // Filling from behind has moved every beginning one box on.
  std::rotate(first_.begin(), first_.begin() + 1, first_.end());
  first_.back() = n_;
  return true;
}

std::array<int, 3> NearestInCell::box_of(const Vec3& position) const {
  const std::array<double, 3> x{position.x, position.y, position.z};
  std::array<int, 3> box{};
  for (std::size_t d = 0; d < 3; ++d) box[d] = std::min(boxes_[d] - 1, static_cast<int>((x[d] - low_[d]) / side_));
  return box;
}

std::size_t NearestInCell::number_of(int x, int y, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(boxes_[1]) + static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(boxes_[0]) +
         static_cast<std::size_t>(x);
}

void NearestInCell::look_at_shell(const Shell& shell, const Vec3& here, std::uint32_t excluded, Best& best) const {
  const auto& [middle, inner, outer] = shell;
  const auto look_at_row = [&](int from, int to, int y, int z) {
    from = std::max(from, 0);
    to = std::min(to, boxes_[0] - 1);
    if (from > to) return;
    const auto end = first_[number_of(to, y, z) + 1];
    for (auto i = first_[number_of(from, y, z)]; i < end; ++i) {
      const auto& other = member_[i];
      const double distance = squared_norm(other.position - here);
      if (distance > best.distance || (distance == best.distance && other.particle > best.particle)) continue;
      if (distance > 0 && other.tag != excluded) best = {distance, other.particle};
    }
  };
  for (int z = std::max(0, middle[2] - outer); z <= std::min(boxes_[2] - 1, middle[2] + outer); ++z)
    for (int y = std::max(0, middle[1] - outer); y <= std::min(boxes_[1] - 1, middle[1] + outer); ++y) {
      if (std::abs(z - middle[2]) > inner || std::abs(y - middle[1]) > inner) {
        look_at_row(middle[0] - outer, middle[0] + outer, y, z);
      } else {
        look_at_row(middle[0] - outer, middle[0] - inner - 1, y, z);
        look_at_row(middle[0] + inner + 1, middle[0] + outer, y, z);
      }
    }
}

/// Takes particle `k` if it is nearer than the best so far; the caller goes through the particles in ascending order.
void NearestInCell::look_at(std::uint32_t k, const Vec3& here, std::uint32_t excluded, Best& best) const {
  const double distance = squared_norm(particles_->position(begin_ + k) - here);
  if (distance < best.distance && distance > 0 && tag_of(particles_->id[begin_ + k]) != excluded) best = {distance, k};
}

void NearestInCell::look_through_filter(std::uint32_t first, const Vec3& here, std::uint32_t excluded, Best& best) {
  filter_.look_from(first);
  for (;;) {
    const auto answer = filter_.nearest();
    if (!answer.is_sure) {
      look_at_all(here, excluded, best);
      break;
    }
    look_at(answer.point, here, excluded, best);
    if (best.particle < n_) break;
    filter_.hide(answer.point);  // the excluded one or a copy: the next nearest
  }
  filter_.show_all();
}

/// The nearest of all is mostly not the excluded one: it is found without a branch, which nobody could foretell.
void NearestInCell::look_at_all(const Vec3& here, std::uint32_t excluded, Best& best) const {
  const double* const x = particles_->x.data() + begin_;
  const double* const y = particles_->y.data() + begin_;
  const double* const z = particles_->z.data() + begin_;
  Best nearest = best;
  for (std::uint32_t k = 0; k < n_; ++k) {
    const double distance = squared_norm(Vec3{x[k], y[k], z[k]} - here);
    const bool is_nearer = (distance < nearest.distance) & (distance > 0);
    nearest.distance = is_nearer ? distance : nearest.distance;
    nearest.particle = is_nearer ? k : nearest.particle;
  }
  if (nearest.particle < n_ && tag_of(particles_->id[begin_ + nearest.particle]) == excluded)
    for (std::uint32_t k = 0; k < n_; ++k) look_at(k, here, excluded, best);
  else
    best = nearest;
}

void NearestInCell::look_around(const Vec3& here, std::uint32_t excluded, Best& best) const {
  const auto middle = box_of(here);
  const int last = *std::max_element(boxes_.begin(), boxes_.end());
  for (int inner = -1, radius = 1; inner < last; inner = radius++) {
    look_at_shell({middle, inner, radius}, here, excluded, best);
    // What lies further out is further away than so many sides of a box; a little less, for rounding.
    const double sure = 0.999 * radius * side_;
    if (best.distance < sure * sure) break;
  }
}

std::uint32_t NearestInCell::find(std::uint32_t first, std::uint32_t excluded) {
  Best best{std::numeric_limits<double>::infinity(), n_};
  const Vec3 here = particles_->position(begin_ + first);
  switch (way_) {
    case Way::one_by_one:
      look_at_all(here, excluded, best);
      break;
    case Way::filter:
      look_through_filter(first, here, excluded, best);
      break;
    case Way::grid:
      look_around(here, excluded, best);
  }
  if (best.particle < n_) return best.particle;
  return first == 0 ? 1 : 0;
}

}  // namespace pamr::dsmc
