// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/interface_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::refine {

namespace {

constexpr auto lowest = std::numeric_limits<std::int64_t>::min(), highest = std::numeric_limits<std::int64_t>::max();

/// The regions of the cells at a node.
struct Regions {
  std::int64_t low = highest, high = lowest;
  void add(const Regions& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

bool has_several(const par::Comm& comm, const std::vector<std::int64_t>& region) {
  std::array<std::int64_t, 2> most{lowest, lowest};  // of the regions and of their complements, whose order is reversed
  for (const auto r : region) most = {std::max(most[0], r), std::max(most[1], ~r)};
  comm.max_in_place(most);
  return most[0] != ~most[1];
}

}  // namespace

std::vector<LocalId> interface_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const Numbering& numbering,
                                     const par::Pattern& shared) {
  const auto* field = mesh::find_regions(mesh);
  const mesh::InnerPatches patches(mesh);
  const bool has_regions = field != nullptr && has_several(comm, field->integer());
  if (!has_regions && patches.is_empty()) return {};

  std::vector<Regions> of_node(at(numbering.n_old_nodes) + numbering.n_new_nodes());
  const auto add = [&](LocalId cell, int edge, const Regions& regions) {
    if (const auto node = numbering.midpoint(cell, edge); node != invalid_local) of_node[at(node)].add(regions);
  };
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (numbering.row[at(c)] < 0) continue;
    for (int e = 0; has_regions && e < 6; ++e) add(c, e, {field->integer()[at(c)], field->integer()[at(c)]});
    for (int slot = 0; slot < 4 && patches.word(c) != 0; ++slot)
      for (int e = 0; patches.of({c, slot}) >= 0 && e < 6; ++e)
        if ((mesh::tet::face_edge_mask[at(slot)] >> e & 1) != 0) add(c, e, {lowest, highest});
  }
  par::fold_shared(par::Exchange(comm, shared), of_node,
                   [](Regions& mine, const Regions& theirs) { mine.add(theirs); });

  std::vector<LocalId> nodes;
  for (auto n = at(numbering.n_old_nodes); n < of_node.size(); ++n)
    if (of_node[n].low < of_node[n].high) nodes.push_back(static_cast<LocalId>(n));
  return nodes;
}

}  // namespace pamr::refine
