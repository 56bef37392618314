// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/requests.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

std::vector<std::uint8_t> requests_of_flags(std::span<const std::uint8_t> flags) {
  std::vector<std::uint8_t> requests(flags.size());
  for (std::size_t c = 0; c < flags.size(); ++c)
    requests[c] = static_cast<std::uint8_t>(flags[c] != 0 ? Request::split : Request::none);
  return requests;
}

std::vector<std::uint8_t> requests_of_early(std::span<const std::uint8_t> requests,
                                            std::span<const RebuiltFamily> plans) {
  std::vector<std::uint8_t> early(requests.size(), 0);
  for (std::size_t c = 0; c < early.size(); ++c)
    if (asks_for(requests[c], Request::assess)) early[c] = requests[c];
  for (const auto& family : plans)
    if (family.is_early) early[at(family.first)] = static_cast<std::uint8_t>(Request::split);
  return early;
}

std::vector<std::uint8_t> remaining_requests(const NumberedMesh& old, std::span<const std::uint8_t> requests) {
  const auto& [mesh, closure, numbering] = old;
  constexpr auto split = static_cast<std::uint8_t>(Request::split), assess = static_cast<std::uint8_t>(Request::assess);
  std::vector<std::uint8_t> rest(at(numbering.first_child.back()), 0);
  // on all closure cells of what was to be split, for their family may have to be kept
  const auto ask_again = [&](LocalId first, LocalId end) { std::fill(&rest[at(first)], rest.data() + end, split); };
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (closure.action[at(c)] == Action::split && requests[at(c)] == split && !is_regular_split(closure.state[at(c)]))
      ask_again(numbering.first_child[at(c)], numbering.first_child[at(c + 1)]);
  for (const auto& family : closure.rebuilt) {
    const auto first = numbering.first_child[at(family.first)];
    if (!is_regular_split(family.state)) {
      const auto members = requests.subspan(at(family.first), at(mesh.lineage[at(family.first)].family_size()));
      if (std::find(members.begin(), members.end(), split) != members.end())
        ask_again(first, first + family.n_children);
    } else if (family.is_early) {
      auto cell = first;
      for_each_grandchild(family, [&](int, int state, int grandchild) {
        if (state != 0 && grandchild == 0) rest[at(cell)] = assess;
        ++cell;
      });
    }
  }
  return rest;
}

}  // namespace pamr::refine
