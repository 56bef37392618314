// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/level0_key.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/error.hpp"

namespace pamr::mesh {

void require_level0_field(const Field& field, bool on_cells, bool has_map) {
  if (!is_level0_field(field)) return;
  const auto require = [&](bool holds, const std::string& what, const std::string& found) {
    if (!holds)
      throw Error(
          fmt::format("field '{}': expected another name, which is not that of a part of the map of level 0, "
                      "or {}, found {}",
                      field.name, what, found));
  };
  const int n_components = on_cells ? 1 : n_key_words;
  require(field.name == (on_cells ? level0_cell_field : level0_key_field), on_cells ? "nodes" : "cells",
          on_cells ? "cells" : "nodes");
  require(field.holds_integers() && field.n_components == n_components, fmt::format("{} integers", n_components),
          fmt::format("{} {}", field.n_components, field.holds_integers() ? "integers" : "reals"));
  require(has_map, "a mesh with such a map", "none");
}

Level0Key middle(const Level0Key& a, const Level0Key& b) {
  if (!a.is_known() || !b.is_known()) return {};
  Level0Key mid;
  for (std::size_t i = 0, j = 0, n = 0;; ++n) {
    const bool has_a = i < 4 && a.node[i] >= 0, has_b = j < 4 && b.node[j] >= 0;
    if (!has_a && !has_b) return mid;
    if (n == 4) return {};
    const bool takes_a = has_a && (!has_b || a.node[i] <= b.node[j]);
    const bool takes_b = has_b && (!has_a || b.node[j] <= a.node[i]);
    mid.node[n] = takes_a ? a.node[i] : b.node[j];
    const std::int64_t of_a = takes_a ? a.weight[i] : 0, of_b = takes_b ? b.weight[j] : 0;
    if (((of_a ^ of_b) & 1) != 0) return {};
    mid.weight[n] = of_a / 2 + of_b / 2 + (of_a & of_b & 1);  // their sum may not fit
    i += takes_a ? 1 : 0;
    j += takes_b ? 1 : 0;
  }
}

NodeField empty_key_field() {
  return {level0_key_field, "", n_key_words, StorageType::int64, std::vector<std::int64_t>{}};
}

void append_key(NodeField& keys, const Level0Key& key) {
  auto& values = keys.integer();
  values.insert(values.end(), key.node.begin(), key.node.end());
  values.insert(values.end(), key.weight.begin(), key.weight.end());
}

}  // namespace pamr::mesh
