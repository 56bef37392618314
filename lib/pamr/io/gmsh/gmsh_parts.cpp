// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/gmsh_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "pamr/base/memory.hpp"

namespace pamr::io::gmsh {

void keep_link(Parts& parts, std::int64_t dimension, std::int64_t entity, std::int64_t master) {
  if (dimension != 2) return;
  ++parts.n_periodic_links;
  parts.linked_surfaces.insert({entity, master});
}

void make_room(const TextCursor& in, Parts& parts, std::int64_t n) {
  constexpr std::size_t bytes_of_element = 20;  // all but the shortest lines
  reserve_array(parts.tetrahedron, std::min(static_cast<std::size_t>(n), in.remaining() / bytes_of_element));
}

void read_group_names(TextCursor& in, Parts& parts) {
  const auto n = in.checked_count(in.integer("the number of physical names"), 6, "physical names");
  (void)in.line();
  for (std::int64_t i = 0; i < n; ++i) {
    auto tag = in.integer("the number of a physical group");
    std::int64_t dimension = unknown_dimension;
    if (!in.is_line_over('"')) {
      dimension = tag;
      tag = in.integer("the number of a physical group");
      if (dimension < 0 || dimension > 3) in.fail("a dimension from 0 to 3", fmt::format("{}", dimension));
    }
    const auto rest = in.line();
    const auto begin = rest.find('"'), end = rest.rfind('"');
    if (begin == std::string_view::npos || end == begin)
      in.fail("a name in double quotes", "\"" + std::string(rest.substr(0, 40)) + "\"");
    const auto name = rest.substr(begin + 1, end - begin - 1);
    if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }))
      in.fail("a name without control characters", fmt::format("one in physical group {}", tag));
    parts.group_name[{static_cast<int>(dimension), tag}] = std::string(name);
  }
}

std::string name_of_group(const GroupNames& names, int dimension, std::int64_t group) {
  const auto named = names.find({dimension, group});
  if (group > 0 && named != names.end() && !named->second.empty()) return named->second;
  return fmt::format("{}{}", group > 0 ? "physical_" : "surface_", std::abs(group));
}

void add_joint_groups(Parts& parts, int dimension, const std::set<std::set<std::int64_t>>& sets,
                      std::set<std::int64_t> taken) {
  for (const auto& [group, name] : parts.group_name)
    if (group.first == dimension || group.first == unknown_dimension) taken.insert(group.second);
  std::int64_t next = 1;
  for (const auto& groups : sets) {
    if (groups.size() < 2) continue;
    while (!taken.insert(next).second) ++next;
    parts.joint[{dimension, next}] = groups;
  }
}

std::int64_t number_of_groups(const Parts& parts, int dimension, const std::set<std::int64_t>& groups) {
  for (const auto& [joint, members] : parts.joint)
    if (joint.first == dimension && members == groups) return joint.second;
  return *groups.begin();
}

}  // namespace pamr::io::gmsh
