// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pamr::dsmc {

/// Finds the nearest of a set of points in single precision, several at a time, and knows when its rounding could have
/// changed the answer. Local.
class NearFilter {
 public:
  static constexpr std::uint32_t max_points = 1024;

  /// Takes up to `max_points` points (x[k], y[k], z[k]). Returns false when their distances are beyond single
  /// precision: all points in one place, or less than 1e-12 or more than 1e12 apart. O(points).
  bool start(std::span<const double> x, std::span<const double> y, std::span<const double> z);

  /// Looks for what is near point `k`, which is hidden itself. Call `show_all` afterwards.
  void look_from(std::uint32_t k);

  struct Answer {
    bool is_sure = false;     ///< no other point is as near, whatever rounding did
    std::uint32_t point = 0;  ///< the nearest one that is not hidden
  };
  /// Not sure when all points are hidden. O(points).
  Answer nearest() const;
  void hide(std::uint32_t k);
  void show_all();

 private:
  struct Hidden {
    std::uint32_t point;
    float x;
  };
  std::vector<float> x_, y_, z_;  ///< from the first point; filled up to whole blocks with points far away
  float here_[3] = {0, 0, 0};
  float slack_ = 0;  ///< more than what rounding can change in the difference of two distances
  std::vector<Hidden> hidden_;
};

}  // namespace pamr::dsmc
