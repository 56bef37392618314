// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/group_overlaps.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "pamr/par/gather_few.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io::gmsh {

namespace {

using GroupSet = std::set<std::int64_t>;

/// The different sets that any rank has. Collective.
std::set<GroupSet> gather_sets(const par::Comm& comm, const std::set<GroupSet>& here) {
  std::vector<std::int64_t> flat;
  for (const auto& groups : here) {
    flat.push_back(std::ssize(groups));
    flat.insert(flat.end(), groups.begin(), groups.end());
  }
  flat = par::gather_few(comm, std::move(flat));
  std::set<GroupSet> sets;
  for (auto at = flat.begin(); at != flat.end(); at += *at + 1) sets.emplace(at + 1, at + 1 + *at);
  return sets;
}

/// Makes one of the elements that several of these groups have. Collective.
template <class Element>
void join_copies(const par::Comm& comm, int dimension, const std::array<GroupSet, 2>& all_and_shared,
                 std::vector<Element>& elements, Parts& parts) {
  const auto& [known, groups] = all_and_shared;
  struct Copy {
    decltype(Element::node) node;  ///< ascending
    std::int64_t group, element;
    Rank rank;
  };
  struct Changed {
    std::int64_t element, group;  ///< group 0: left out
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
  std::map<std::size_t, GroupSet> of_first;  ///< of the first copy of an element in several groups: all of them
  for (std::size_t i = 0, first = 0; i < all.size(); ++i) {
    if (all[i].node != all[first].node) first = i;
    if (all[i].group != all[first].group)
      of_first.try_emplace(first, GroupSet{all[first].group}).first->second.insert(all[i].group);
  }
  std::set<GroupSet> sets;
  for (const auto& [first, of_element] : of_first) sets.insert(of_element);
  add_joint_groups(parts, dimension, gather_sets(comm, sets), known);
  par::Mailbox<Changed> changed(comm);
  for (const auto& [first, of_element] : of_first)
    for (auto i = first; i < all.size() && all[i].node == all[first].node; ++i)
      changed.add(all[i].rank, {all[i].element, i == first ? number_of_groups(parts, dimension, of_element) : 0});
  std::vector<bool> is_dropped(elements.size(), false);
  for (const auto& one : changed.send().item) {
    const auto element = static_cast<std::size_t>(one.element);
    is_dropped[element] = one.group == 0;
    elements[element].group = one.group;
  }
  std::size_t i = 0;
  std::erase_if(elements, [&](const Element&) { return is_dropped[i++]; });
}

}  // namespace

void join_copies(const par::Comm& comm, Parts& parts) {
  std::map<std::pair<int, std::int64_t>, GroupSet> groups_of_entity;
  std::array<GroupSet, 4> all, shared;
  for (const auto& [dimension, entity, group] : par::gather_distinct(comm, parts.entity_in_group)) {
    groups_of_entity[{static_cast<int>(dimension), entity}].insert(group);
    all[static_cast<std::size_t>(dimension)].insert(group);
  }
  for (const auto& [entity, groups] : groups_of_entity)
    if (groups.size() > 1) shared[static_cast<std::size_t>(entity.first)].insert(groups.begin(), groups.end());
  if (!shared[2].empty()) join_copies(comm, 2, {all[2], shared[2]}, parts.triangle, parts);
  if (!shared[3].empty()) join_copies(comm, 3, {all[3], shared[3]}, parts.tetrahedron, parts);
  for (const auto& [entity, groups] : groups_of_entity)
    if (entity.first == 2 && groups.size() > 1)
      parts.group_of_surface[entity.second] = number_of_groups(parts, 2, groups);
}

std::vector<mesh::Group> members_of(const Parts& parts, int dimension, std::int64_t group) {
  std::vector<mesh::Group> groups;
  if (const auto joint = parts.joint.find({dimension, group}); joint != parts.joint.end())
    for (const auto member : joint->second)
      groups.push_back({member, name_of_group(parts.group_name, dimension, member)});
  return groups;
}

void name_joint_groups(Parts& parts) {
  for (const auto& joint : parts.joint) {
    const auto [dimension, group] = joint.first;
    std::string name;
    for (const auto& member : members_of(parts, dimension, group)) name += (name.empty() ? "" : "+") + member.name;
    const auto is_taken = [&name, d = dimension](const auto& named) {
      return named.first.first == d && named.second == name;
    };
    while (std::any_of(parts.group_name.begin(), parts.group_name.end(), is_taken)) name += '+';
    parts.group_name[joint.first] = name;
  }
}

}  // namespace pamr::io::gmsh
