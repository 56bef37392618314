// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/io/gmsh/text_cursor.hpp"
#include "pamr/par/comm.hpp"

/// What a Gmsh file says, before it becomes a mesh. Every rank reads its share and passes over the rest: by counting
/// bytes in a binary file, with an index of the lines in a text.
namespace pamr::io::gmsh {

/// A triangle or a tetrahedron by the tags of its nodes; `group` is the physical group, or where there is none minus
/// the number of the geometrical entity.
struct Triangle {
  std::array<std::int64_t, 3> node{};
  std::int64_t group = 0;
};
struct Tetrahedron {
  std::array<std::int64_t, 4> node{};
  std::int64_t group = 0;
};

/// One rank's share: the canonical block of the nodes, and the triangles and tetrahedra among the canonical block of
/// all elements, in the order of the file.
struct Parts {
  std::int64_t n_nodes = 0;     ///< of the whole file
  std::int64_t n_elements = 0;  ///< of the whole file, points and lines too
  std::vector<std::int64_t> node_tag;
  std::vector<geometry::Vec3> position;
  std::vector<Triangle> triangle;
  std::vector<Tetrahedron> tetrahedron;
  /// Elements of this rank that are no points, lines, triangles or tetrahedra of first order: how many, by Gmsh's type.
  std::map<int, std::int64_t> refused;
  /// Names of physical groups by dimension and number.
  std::map<std::pair<int, std::int64_t>, std::string> group_name;
  std::int64_t n_periodic_links = 0;       ///< between surfaces
  std::set<std::int64_t> linked_surfaces;  ///< geometrical surfaces that are linked as periodic, either side
  /// Groups of the geometrical surfaces that this rank knows.
  std::map<std::int64_t, std::int64_t> group_of_surface;
};

/// The share of one rank in `n` things of the file.
struct Share {
  Rank rank = 0, size = 1;
  par::BlockRange of(std::int64_t n) const { return par::block_range(n, rank, size); }
};

/// Nodes of an element of that type: 0 for a type that no Gmsh knows.
int n_nodes_of_type(int type);
/// The type in words.
std::string name_of_type(int type);

/// Keeps an element that is a triangle or a tetrahedron of first order, counts one that cannot be dealt with, and
/// forgets points and lines.
void keep_element(Parts& parts, int type, const std::array<std::int64_t, 4>& nodes, std::int64_t group);

/// Runs through the sections: calls `read(name)` at each `$Name`, which returns whether it has read the section up to
/// its end line; the others are passed over.
template <class Read>
void for_each_section(TextCursor& in, Read&& read) {
  while (!in.at_end()) {
    const auto name = in.line();
    if (name.empty() || name.front() != '$') continue;
    const std::string end = "$End" + std::string(name.substr(1));
    if (!read(std::string(name.substr(1)))) {
      in.skip_to_line(end);
      continue;
    }
    for (;;) {
      if (in.at_end()) in.fail(end, "the end of the file");
      const auto line = in.line();
      if (line == end) break;
      if (!line.empty()) in.fail(end, "\"" + std::string(line.substr(0, 40)) + "\"");
    }
  }
}

void read_group_names(TextCursor& in, Parts& parts);

/// Notes a link between two entities of that dimension: of surfaces only, since those of curves and points come with
/// them in some versions of the format.
void keep_link(Parts& parts, std::int64_t dimension, std::int64_t entity, std::int64_t master);

}  // namespace pamr::io::gmsh
