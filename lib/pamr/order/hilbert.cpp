// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/hilbert.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pamr::order {

namespace {

constexpr int n_bits = 21;
constexpr int levels_of_step = 3;
constexpr std::size_t cubes_of_step = 512;  ///< 2^(3 x levels)

/// How the curve lies in a cube: axis `i` of the curve is axis `axis[i]` of space, mirrored where `mirrored[i]`, and
/// its Gray code is complemented where `odd`.
struct Pose {
  std::array<unsigned, 3> axis{0, 1, 2};
  std::array<unsigned, 3> mirrored{};
  unsigned odd = 0;
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

struct Move {
  unsigned place = 0;  ///< of the half cube among eight along the curve
  Pose pose;           ///< in it
};

/// One level of Skilling's AxestoTranspose: `half[i]` says in which half of the cube a point lies along axis `i`.
constexpr Move descend(Pose pose, std::array<unsigned, 3> half) {
  std::array<unsigned, 3> bit{};
  for (std::size_t i = 0; i < 3; ++i) bit[i] = half[pose.axis[i]] ^ pose.mirrored[i];
  const std::array<unsigned, 3> gray{bit[0], bit[1] ^ bit[0], bit[2] ^ bit[1] ^ bit[0]};
  Move move{.place = (gray[0] ^ pose.odd) << 2U | (gray[1] ^ pose.odd) << 1U | (gray[2] ^ pose.odd), .pose = pose};
  auto& next = move.pose;
  for (std::size_t i = 0; i < 3; ++i) {
    if (bit[i] != 0) {
      next.mirrored[0] ^= 1U;
    } else {
      std::swap(next.axis[0], next.axis[i]);
      std::swap(next.mirrored[0], next.mirrored[i]);
    }
  }
  next.odd ^= gray[2];
  return move;
}

constexpr std::array<unsigned, 3> halves(unsigned cube) { return {cube >> 2U & 1U, cube >> 1U & 1U, cube & 1U}; }

/// A step of one level: of every pose that the curve takes (the first one first) and every half cube (a bit of x, of y,
/// of z), the place, and the number of the pose there.
struct Levels {
  std::array<Pose, 96> pose{};
  std::array<std::array<std::uint16_t, 8>, 96> place{};
  std::array<std::array<std::uint16_t, 8>, 96> next{};
  std::uint16_t n = 1;

  constexpr std::uint16_t find_or_add(const Pose& wanted) {
    for (std::uint16_t i = 0; i < n; ++i)
      if (pose[i] == wanted) return i;
    pose[n] = wanted;
    return n++;
  }
};

constexpr Levels make_levels() {
  Levels levels;
  for (std::size_t p = 0; p < levels.n; ++p)
    for (unsigned cube = 0; cube < 8; ++cube) {
      const auto move = descend(levels.pose[p], halves(cube));
      levels.place[p][cube] = static_cast<std::uint16_t>(move.place);
      levels.next[p][cube] = levels.find_or_add(move.pose);
    }
  return levels;
}

constexpr auto levels = make_levels();
static_assert(levels.n << 9U <= 1U << 16U);

/// The same for three levels at a time (three bits of x, of y, of z): nine bits of the key, and above them the pose.
constexpr auto make_steps() {
  std::array<std::array<std::uint16_t, cubes_of_step>, levels.n> steps{};
  for (std::size_t p = 0; p < levels.n; ++p)
    for (unsigned cube = 0; cube < cubes_of_step; ++cube) {
      unsigned place = 0;
      std::size_t pose = p;
      for (unsigned bit = levels_of_step; bit-- > 0;) {
        const auto half = (cube >> (6U + bit) & 1U) << 2U | (cube >> (3U + bit) & 1U) << 1U | (cube >> bit & 1U);
        place = place << 3U | levels.place[pose][half];
        pose = levels.next[pose][half];
      }
      steps[p][cube] = static_cast<std::uint16_t>(pose << 9U | place);
    }
  return steps;
}

constexpr auto steps = make_steps();

/// A coordinate on the grid; what is not on it (NaN too) comes to its edge.
std::uint32_t to_grid(double x) {
  constexpr double last = (1U << n_bits) - 1;
  return x > 0 ? static_cast<std::uint32_t>(std::min(x, last)) : 0;
}

}  // namespace

std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x) {
  std::uint64_t key = 0;
  std::size_t pose = 0;
  for (int bit = n_bits - levels_of_step; bit >= 0; bit -= levels_of_step) {
    const auto shift = static_cast<unsigned>(bit);
    const auto cube = (x[0] >> shift & 7U) << 6U | (x[1] >> shift & 7U) << 3U | (x[2] >> shift & 7U);
    const unsigned step = steps[pose][cube];
    key = key << 9U | (step & 511U);
    pose = step >> 9U;
  }
  return key;
}

CurveGrid::CurveGrid(const geometry::Box& box) : low_(box.low) {
  const auto extent = box.size();
  const double longest = std::max({extent.x, extent.y, extent.z});
  if (longest > 0) scale_ = ((1U << n_bits) - 1) / longest;
}

std::uint64_t CurveGrid::key(geometry::Vec3 point) const {
  const auto q = scale_ * (point - low_);
  return hilbert_key({to_grid(q.x), to_grid(q.y), to_grid(q.z)});
}

}  // namespace pamr::order
