// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// The smallest of some values, and where it is.
struct WorstPlace {
  double value = 1;
  geometry::Vec3 where;
  bool operator==(const WorstPlace&) const = default;
};

/// Collects values with their places, each rank its own.
class WorstPlaces {
 public:
  void add(double value, geometry::Vec3 where) {
    if (value < value_) where_.clear();
    if (value <= value_) where_.push_back(where);
    value_ = value < value_ ? value : value_;
  }
  /// The smallest value below or equal to 1 of all ranks; of equal ones that whose place is first by coordinates. The
  /// same on any number of ranks. Collective: five reductions.
  WorstPlace over(const par::Comm& comm) const;

 private:
  double value_ = 1;
  std::vector<geometry::Vec3> where_;
};

}  // namespace pamr::mesh
