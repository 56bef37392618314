// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/interface_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/mesh/region_faces.hpp"
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
  if (field == nullptr) return {};
  const auto& region = field->integer();
  if (!has_several(comm, region)) return {};

  std::vector<Regions> of_node(at(numbering.n_old_nodes) + numbering.n_new_nodes());
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (numbering.row[at(c)] < 0) continue;
    for (int e = 0; e < 6; ++e)
      if (const auto node = numbering.midpoint(c, e); node != invalid_local)
        of_node[at(node)].add({region[at(c)], region[at(c)]});
  }
  par::fold_shared(par::Exchange(comm, shared), of_node,
                   [](Regions& mine, const Regions& theirs) { mine.add(theirs); });

  std::vector<LocalId> nodes;
  for (auto n = at(numbering.n_old_nodes); n < of_node.size(); ++n)
    if (of_node[n].low < of_node[n].high) nodes.push_back(static_cast<LocalId>(n));
  return nodes;
}

}  // namespace pamr::refine
