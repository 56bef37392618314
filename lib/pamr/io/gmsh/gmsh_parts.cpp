// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/gmsh_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pamr::io::gmsh {

namespace {

/// Nodes of Gmsh's element types 1 to 31. Source: Gmsh reference manual, section "MSH file format".
constexpr std::array<int, 32> nodes_of_type{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                            8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

}  // namespace

int n_nodes_of_type(int type) {
  if (type >= 1 && type <= 31) return nodes_of_type[static_cast<std::size_t>(type)];
  return type == 92 ? 64 : type == 93 ? 125 : 0;
}

std::string name_of_type(int type) {
  switch (type) {
    case 3:
      return "quadrangles";
    case 5:
      return "hexahedra";
    case 6:
      return "prisms";
    case 7:
      return "pyramids";
    case 8:
      return "lines of second order";
    case 9:
      return "triangles of second order";
    case 11:
      return "tetrahedra of second order";
    default:
      return fmt::format("elements of Gmsh's type {}", type);
  }
}

void keep_element(Parts& parts, int type, const std::array<std::int64_t, 4>& nodes, std::int64_t group) {
  if (type == 4)
    parts.tetrahedron.push_back({nodes, group});
  else if (type == 2)
    parts.triangle.push_back({{nodes[0], nodes[1], nodes[2]}, group});
  else if (type != 1 && type != 15)
    ++parts.refused[type];
}

void keep_link(Parts& parts, std::int64_t dimension, std::int64_t entity, std::int64_t master) {
  if (dimension != 2) return;
  ++parts.n_periodic_links;
  parts.linked_surfaces.insert({entity, master});
}

void read_group_names(TextCursor& in, Parts& parts) {
  const auto n = in.checked_count(in.integer("the number of physical names"), 6, "physical names");
  (void)in.line();
  for (std::int64_t i = 0; i < n; ++i) {
    const auto dimension = in.integer("the dimension of a physical group");
    const auto tag = in.integer("the number of a physical group");
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

}  // namespace pamr::io::gmsh
