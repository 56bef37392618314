// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/sub_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"

namespace pamr::dsmc {

using geometry::squared_norm;

namespace {

constexpr double particles_a_box = 2;
constexpr double max_sub_cells = 64;  ///< along a side

struct Bounds {
  double low = 0, high = 0;
};
Bounds bounds_of(std::span<const double> values) {
  Bounds bounds{values[0], values[0]};
  for (const double x : values) {
    bounds.low = std::min(bounds.low, x);
    bounds.high = std::max(bounds.high, x);
  }
  return bounds;
}

}  // namespace

bool SubCells::start(const Particles& particles, std::uint32_t begin, std::uint32_t n, double volume) {
  particles_ = &particles;
  begin_ = begin;
  n_ = n;
  const std::array<std::span<const double>, 3> x{std::span(particles.x).subspan(begin, n),
                                                 std::span(particles.y).subspan(begin, n),
                                                 std::span(particles.z).subspan(begin, n)};
  std::array<Bounds, 3> bounds;
  double longest = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    bounds[d] = bounds_of(x[d]);
    longest = std::max(longest, bounds[d].high - bounds[d].low);
  }
  if (!(longest > 0)) return false;
  const double side = std::max(std::cbrt(particles_a_box * volume / n), longest / max_sub_cells);
  box_.assign(n, 0);
  std::uint32_t stride = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const double scale = 1 / side, low = bounds[d].low;
    const auto last = static_cast<std::int32_t>((bounds[d].high - low) * scale);
    for (std::uint32_t k = 0; k < n; ++k)
      box_[k] += stride * static_cast<std::uint32_t>(static_cast<std::int32_t>((x[d][k] - low) * scale));
    boxes_[d] = last + 1;
    stride *= static_cast<std::uint32_t>(boxes_[d]);
  }
  // Counting sort: a row more than boxes, since filling moves every beginning one box on.
  first_.assign(stride + 2, 0);
  for (const auto b : box_) ++first_[b + 2];
  for (std::size_t b = 2; b < first_.size(); ++b) first_[b] += first_[b - 1];
  member_.resize(n);
  for (std::uint32_t k = 0; k < n; ++k) member_[first_[box_[k] + 1]++] = k;
  return true;
}

bool SubCells::is_eligible(std::uint32_t k, const Vec3& here, std::uint32_t excluded) const {
  const auto i = begin_ + k;
  return tag_of(particles_->id[i]) != excluded &&
         !(particles_->x[i] == here.x && particles_->y[i] == here.y && particles_->z[i] == here.z);
}

std::uint32_t SubCells::find(std::uint32_t first, std::uint32_t excluded, Random& random) {
  const auto here = particles_->position(begin_ + first);
  eligible_.clear();
  for (const auto k : members(box_[first]))
    if (is_eligible(k, here, excluded)) eligible_.push_back(k);
  if (eligible_.empty()) return nearest_around(first, excluded);
  const auto n = static_cast<std::uint32_t>(eligible_.size());
  return eligible_[n == 1 ? 0 : random.below(n)];
}

/// Of equally near ones the one that comes first in the order of the boxes.
std::uint32_t SubCells::nearest_around(std::uint32_t first, std::uint32_t excluded) const {
  const auto here = particles_->position(begin_ + first);
  const auto b = static_cast<int>(box_[first]);
  const std::array<int, 3> middle{b % boxes_[0], b / boxes_[0] % boxes_[1], b / (boxes_[0] * boxes_[1])};
  const int reach = *std::max_element(boxes_.begin(), boxes_.end());
  for (int radius = 1; radius < 2 * reach; radius *= 2) {
    std::array<int, 3> low{}, high{};
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::max(0, middle[d] - radius);
      high[d] = std::min(boxes_[d] - 1, middle[d] + radius);
    }
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t found = 0;
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y) {
        const auto row = at((z * boxes_[1] + y) * boxes_[0]);  // the members of a row lie side by side
        for (auto m = first_[row + at(low[0])]; m < first_[row + at(high[0]) + 1]; ++m) {
          const auto k = member_[m];
          const double distance = squared_norm(particles_->position(begin_ + k) - here);
          if (distance >= least || !is_eligible(k, here, excluded)) continue;
          least = distance;
          found = k;
        }
      }
    if (std::isfinite(least)) return found;
  }
  return first == 0 ? 1 : 0;
}

}  // namespace pamr::dsmc
