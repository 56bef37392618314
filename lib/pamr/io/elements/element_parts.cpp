// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/element_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/listed.hpp"
#include "pamr/io/elements/cut_elements.hpp"

namespace pamr::io {

namespace {

/// Nodes of Gmsh's element types 1 to 31. Source: Gmsh reference manual, section "MSH file format".
constexpr std::array<int, 32> nodes_of_type{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                            8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

}  // namespace

int element_type::of_vtk(std::int64_t type) {
  switch (type) {
    case 1:
    case 2:
      return point;
    case 3:
    case 4:
      return line;
    case 5:
      return triangle;
    case 7:
    case 42:
      return polygon;
    case 8:
    case 9:
      return quadrangle;
    case 10:
      return tetrahedron;
    case 11:
    case 12:
      return hexahedron;
    case 13:
      return prism;
    case 14:
      return pyramid;
    case 21:
      return 8;
    case 22:
      return triangle_2;
    case 23:
      return 10;
    case 24:
      return tetrahedron_2;
    case 25:
    case 29:
      return 12;
    case 26:
      return 13;
    case 27:
      return 14;
    default:
      return 0;
  }
}

void turn_prism_of_vtk(std::span<std::int64_t, 6> nodes) {
  std::swap_ranges(nodes.begin(), nodes.begin() + 3, nodes.begin() + 3);
}

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
    case 10:
      return "quadrangles of second order";
    case 11:
      return "tetrahedra of second order";
    case 12:
      return "hexahedra of second order";
    case 13:
      return "prisms of second order";
    case 14:
      return "pyramids of second order";
    case 21:
      return "triangles of third order";
    case 23:
      return "triangles of fourth order";
    case element_type::polygon:
      return "polygons or polyhedra";
    case 29:
      return "tetrahedra of third order";
    case 30:
      return "tetrahedra of fourth order";
    default:
      return fmt::format("elements of Gmsh's type {}", type);
  }
}

std::string text_of_left_out(const std::map<std::string, std::int64_t>& counts) {
  return "left out was what a mesh has no place for: " + listed(counts, {.most = all_items}, [](const auto& one) {
           return fmt::format("{} ({})", one.first, one.second);
         });
}

void keep_element(ElementParts& parts, int type, std::span<const std::int64_t, max_nodes> nodes, std::int64_t group) {
  if (type == element_type::tetrahedron) {
    parts.tetrahedron.push_back({{nodes[0], nodes[1], nodes[2], nodes[3]}, group});
  } else if (type == element_type::triangle) {
    parts.triangle.push_back({{nodes[0], nodes[1], nodes[2]}, group});
  } else if (is_cut(type)) {
    ++parts.cut[type];
    for (const auto& cell : tetrahedra_of(type, nodes)) parts.tetrahedron.push_back({cell, group});
    for (const auto& triangle : triangles_of(type, nodes)) parts.triangle.push_back({triangle, group});
  } else if (type != element_type::line && type != element_type::point) {
    ++parts.refused[type];
  }
}

}  // namespace pamr::io
