// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/near_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::size_t n_lanes = 4, block = 2 * n_lanes;
constexpr float far_away = 1e18F;  ///< the square of which is still finite
constexpr float all_far = 1e34F;   ///< squared distance that no visible point has
constexpr float min_extent = 1e-12F, max_extent = 1e12F;
constexpr int number_bits = 10;  ///< low bits of a squared distance that are replaced by the number of the point
static_assert(NearFilter::max_points == 1U << number_bits);

/// Four numbers that are computed with together: what every 64-bit processor does without a special version.
using Lanes = float __attribute__((vector_size(n_lanes * sizeof(float))));
using Words = std::int32_t __attribute__((vector_size(n_lanes * sizeof(std::int32_t))));

Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
/// The other one of `a` and `b` than `one`, bit for bit.
Lanes other(Lanes a, Lanes b, Lanes one) {
  return std::bit_cast<Lanes>(std::bit_cast<Words>(a) ^ std::bit_cast<Words>(b) ^ std::bit_cast<Words>(one));
}
Lanes all(float value) { return Lanes{value, value, value, value}; }

/// The two least of the values taken, in each lane.
struct LeastTwo {
  Lanes first = all(far_away * far_away), second = first;
  void take(Lanes value) {
    const Lanes less = min(value, first);
    second = min(second, other(value, first, less));
    first = less;
  }
  void take(const LeastTwo& more) {
    const Lanes less = min(more.first, first);
    second = min(other(more.first, first, less), min(second, more.second));
    first = less;
  }
};

}  // namespace

bool NearFilter::start(std::span<const double> x, std::span<const double> y, std::span<const double> z) {
  PAMR_EXPECTS(x.size() <= max_points);
  const std::size_t n = x.size(), filled = (n + block - 1) / block * block;
  x_.resize(filled);
  y_.resize(filled);
  z_.resize(filled);
  hidden_.clear();
  float extent = 0;
  const auto take = [&](std::span<const double> from, std::vector<float>& to) {
    const double origin = from[0];
    float largest[n_lanes] = {0, 0, 0, 0};
    for (std::size_t k = 0; k + n_lanes <= n; k += n_lanes)
      for (std::size_t l = 0; l < n_lanes; ++l) {
        const auto value = static_cast<float>(from[k + l] - origin);
        to[k + l] = value;
        const float size = std::fabs(value);
        largest[l] = largest[l] < size ? size : largest[l];
      }
    for (std::size_t k = n / n_lanes * n_lanes; k < n; ++k) {
      to[k] = static_cast<float>(from[k] - origin);
      largest[0] = std::max(largest[0], std::fabs(to[k]));
    }
    for (const float size : largest) extent = std::max(extent, size);
  };
  take(x, x_);
  take(y, y_);
  take(z, z_);
  std::fill(x_.begin() + static_cast<std::ptrdiff_t>(n), x_.end(), far_away);
  std::fill(y_.begin() + static_cast<std::ptrdiff_t>(n), y_.end(), 0.0F);
  std::fill(z_.begin() + static_cast<std::ptrdiff_t>(n), z_.end(), 0.0F);
  // With u = 2^-24 and coordinates up to M = extent: a difference of two is off by 4 M u at most, a distance by
  // sqrt(3) times that for its coordinates and, since it is at most 2 sqrt(3) M, by less than 9 M u for the rounding of
  // squares, sums and root. Twice these 16 M u is 2^-19 M.
  slack_ = 0x1p-18F * extent;
  return extent > min_extent && extent < max_extent;
}

void NearFilter::look_from(std::uint32_t k) {
  here_[0] = x_[k];
  here_[1] = y_[k];
  here_[2] = z_[k];
  hide(k);
}

void NearFilter::hide(std::uint32_t k) {
  hidden_.push_back({k, x_[k]});
  x_[k] = far_away;
}

void NearFilter::show_all() {
  while (!hidden_.empty()) {
    x_[hidden_.back().point] = hidden_.back().x;
    hidden_.pop_back();
  }
}

NearFilter::Answer NearFilter::nearest() const {
  const Lanes hx = all(here_[0]), hy = all(here_[1]), hz = all(here_[2]);
  const float *x = x_.data(), *y = y_.data(), *z = z_.data();
  const auto n = static_cast<std::int32_t>(x_.size());
  // A squared distance with the number of its point in the lowest bits is still ordered as a number.
  constexpr std::int32_t mask = -(1 << number_bits);
  const auto distance = [&](std::int32_t k) {
    const Lanes dx = load(x + k) - hx, dy = load(y + k) - hy, dz = load(z + k) - hz;
    return std::bit_cast<Words>(dx * dx + dy * dy + dz * dz) & mask;
  };
  LeastTwo even, odd;  // two of them do not wait for one another
  Words number{0, 1, 2, 3};
  constexpr std::int32_t step = n_lanes;
  for (std::int32_t k = 0; k < n; k += 2 * step, number += 2 * step) {
    even.take(std::bit_cast<Lanes>(distance(k) | number));
    odd.take(std::bit_cast<Lanes>(distance(k + step) | (number + step)));
  }
  even.take(odd);
  const auto merge = [](LeastTwo& two, const auto& swapped) {
    two.take(LeastTwo{swapped(two.first), swapped(two.second)});
  };
  merge(even, [](Lanes v) { return Lanes{v[2], v[3], v[0], v[1]}; });
  merge(even, [](Lanes v) { return Lanes{v[1], v[0], v[3], v[2]}; });
  const float first = even.first[0], second = even.second[0];
  // The numbers in the low bits change a distance by 2^-14 of it at most.
  const float reach = std::sqrt(first) * (1 + 0x1p-13F) + slack_;
  return {first < all_far && second > reach * reach * (1 + 0x1p-12F),
          std::bit_cast<std::uint32_t>(first) & ~static_cast<std::uint32_t>(mask)};
}

}  // namespace pamr::dsmc
