// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/text_cursor.hpp"

/// What a Gmsh file says, before it becomes a mesh. Every rank reads its share and passes over the rest: by counting
/// bytes in a binary file, with an index of the lines in a text.
namespace pamr::io::gmsh {

/// `group` of an element is the physical group, or where there is none minus the number of the geometrical entity.
/// Every rank has its block of all elements.
using Parts = ElementParts;

/// Of a line.
inline std::string_view without_blanks_behind(std::string_view line) {
  return line.substr(0, line.find_last_not_of(" \t") + 1);
}

/// Runs through the sections: calls `read(name)` at each `$Name`, which returns whether it has read the section up to
/// its end line; the others are passed over, and counted in `parts.left_out`. Refuses one that is read twice.
template <class Read>
void for_each_section(TextCursor& in, Parts& parts, Read&& read) {
  std::set<std::string> seen;
  while (!in.at_end()) {
    const auto name = without_blanks_behind(in.line());
    if (name.empty() || name.front() != '$') continue;
    const std::string end = "$End" + std::string(name.substr(1));
    if (!read(std::string(name.substr(1)))) {
      in.skip_to_line(end);
      if (name != "$MeshFormat" && name != "$Comments") ++parts.left_out[std::string(name)];
      continue;
    }
    if (!seen.insert(name == "$ParametricNodes" ? "$Nodes" : std::string(name)).second)
      in.fail("each section once", std::string(name) + " again");
    for (;;) {
      if (in.at_end()) in.fail(end, "the end of the file");
      const auto line = without_blanks_behind(in.line());
      if (line == end) break;
      if (!line.empty()) in.fail(end, "\"" + std::string(line.substr(0, 40)) + "\"");
    }
  }
}

/// Reserves memory for the tetrahedra in a share of `n` elements, nearly all of which are tetrahedra, but not for more
/// than the rest of the file can hold.
void make_room(const TextCursor& in, Parts& parts, std::int64_t n);

/// Reads `$PhysicalNames`. Where the lines have no dimension, as before version 2.1, names stand under
/// `unknown_dimension`.
void read_group_names(TextCursor& in, Parts& parts);

inline constexpr int unknown_dimension = -1;

/// Before the number, in the name of a physical volume that stands for a region whose number Gmsh does not know: 0 and
/// those below.
inline constexpr std::string_view unnamed_region = "region_";

using GroupNames = decltype(Parts::group_name);

/// The name that the file gives to a group, or else one of its number.
std::string name_of_group(const GroupNames& names, int dimension, std::int64_t group);

/// Gives each of these sets of groups the lowest free number of a group that stands for it (`parts.joint`). `taken`:
/// numbers of groups of that dimension. Local.
void add_joint_groups(Parts& parts, int dimension, const std::set<std::set<std::int64_t>>& sets,
                      std::set<std::int64_t> taken);
/// The number of such a set, or of the only group.
std::int64_t number_of_groups(const Parts& parts, int dimension, const std::set<std::int64_t>& groups);

/// Notes a link between two entities of that dimension: of surfaces only, since those of curves and points come with
/// them in some versions of the format.
void keep_link(Parts& parts, std::int64_t dimension, std::int64_t entity, std::int64_t master);

}  // namespace pamr::io::gmsh
