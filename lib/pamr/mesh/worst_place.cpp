// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/worst_place.hpp"

#include <algorithm>
#include <limits>

namespace pamr::mesh {

WorstPlace WorstPlaces::over(const par::Comm& comm) const {
  WorstPlace worst{comm.min(value_), {}};
  if (!comm.any(!where_.empty())) return worst;
  auto places = where_;
  if (value_ > worst.value) places.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& place : places) least = std::min(least, place[k]);
    worst.where[k] = comm.min(least);
    std::erase_if(places, [&](const auto& place) { return place[k] != worst.where[k]; });
  }
  return worst;
}

}  // namespace pamr::mesh
