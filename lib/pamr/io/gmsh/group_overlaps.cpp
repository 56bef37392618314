// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/group_overlaps.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "pamr/par/gather_few.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io::gmsh {

namespace {

/// Leaves out the elements of these groups that another group has, too. Collective.
template <class Element>
void leave_one_of_each(const par::Comm& comm, int dimension, const std::set<std::int64_t>& groups,
                       std::vector<Element>& elements, std::map<GroupPair, std::int64_t>& in_two_groups) {
  struct Copy {
    decltype(Element::node) node;  ///< ascending
    std::int64_t group, element;
    Rank rank;
  };
  struct Dropped {
    std::int64_t element, kept;
  };
  par::Mailbox<Copy> copies(comm);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (!groups.contains(elements[i].group)) continue;
    Copy copy{elements[i].node, elements[i].group, static_cast<std::int64_t>(i), comm.rank()};
    std::sort(copy.node.begin(), copy.node.end());
    const auto host = static_cast<std::uint64_t>(copy.node[0]) % static_cast<std::uint64_t>(comm.size());
    copies.add(static_cast<Rank>(host), copy);
  }
  auto all = copies.send().item;
  std::sort(all.begin(), all.end(),
            [](const Copy& a, const Copy& b) { return std::tie(a.node, a.group) < std::tie(b.node, b.group); });
  par::Mailbox<Dropped> dropped(comm);
  for (std::size_t i = 0, first = 0; i < all.size(); ++i) {
    if (all[i].node != all[first].node) first = i;
    if (all[i].group != all[first].group) dropped.add(all[i].rank, {all[i].element, all[first].group});
  }
  std::vector<bool> is_dropped(elements.size(), false);
  for (const auto& one : dropped.send().item) {
    const auto element = static_cast<std::size_t>(one.element);
    is_dropped[element] = true;
    ++in_two_groups[{dimension, one.kept, elements[element].group}];
  }
  std::size_t i = 0;
  std::erase_if(elements, [&](const Element&) { return is_dropped[i++]; });
}

}  // namespace

void leave_one_of_each(const par::Comm& comm, Parts& parts) {
  std::map<std::pair<int, std::int64_t>, std::set<std::int64_t>> groups_of_entity;
  for (const auto& [dimension, entity, group] : par::gather_distinct(comm, parts.entity_in_group))
    groups_of_entity[{static_cast<int>(dimension), entity}].insert(group);
  std::array<std::set<std::int64_t>, 4> shared;
  for (const auto& [entity, groups] : groups_of_entity) {
    if (groups.size() < 2) continue;
    shared[static_cast<std::size_t>(entity.first)].insert(groups.begin(), groups.end());
    if (entity.first == 2) parts.group_of_surface[entity.second] = *groups.begin();
  }
  if (!shared[2].empty()) leave_one_of_each(comm, 2, shared[2], parts.triangle, parts.in_two_groups);
  if (!shared[3].empty()) leave_one_of_each(comm, 3, shared[3], parts.tetrahedron, parts.in_two_groups);
}

std::vector<GroupOverlap> overlaps_of(const par::Comm& comm, const Parts& parts) {
  struct Count {
    GroupPair groups;
    std::int64_t n;
  };
  std::vector<Count> here;
  for (const auto& [groups, n] : parts.in_two_groups) here.push_back({groups, n});
  std::map<GroupPair, std::int64_t> all;
  for (const auto& [groups, n] : par::gather_few(comm, std::move(here))) all[groups] += n;
  const auto name = [&](int dimension, std::int64_t group) {
    return name_of_group(parts.group_name, dimension, group);
  };
  std::vector<GroupOverlap> result;
  for (const auto& [groups, n] : all) {
    const auto [dimension, kept, other] = groups;
    result.push_back({dimension, name(dimension, kept), name(dimension, other), n});
  }
  return result;
}

}  // namespace pamr::io::gmsh
