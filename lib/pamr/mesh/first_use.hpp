// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "pamr/base/memory.hpp"
#include "pamr/base/types.hpp"
#include "pamr/mesh/id_map.hpp"

namespace pamr::mesh {

/// The nodes that cells name, in order of first use. `place_at(cell, corner, place)` takes the place of each corner's
/// node among them, as soon as that corner has been read. Local.
template <class PlaceAt>
std::vector<GlobalId> nodes_by_first_use(const std::vector<std::array<GlobalId, 4>>& cells, PlaceAt&& place_at) {
  std::vector<GlobalId> named;
  if (cells.empty()) return named;
  GlobalId least = cells[0][0], greatest = least;
  for (const auto& nodes : cells)
    for (const auto node : nodes) {
      least = std::min(least, node);
      greatest = std::max(greatest, node);
    }
  IdMap places(least, greatest, cells.size() / 4);
  reserve_array(named, cells.size() / 4);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      const auto next = static_cast<LocalId>(named.size());
      const auto node = cells[c][i];
      const auto place = places.find_or_insert(node, next);
      if (place == next) named.push_back(node);
      place_at(c, i, place);
    }
  return named;
}

}  // namespace pamr::mesh
