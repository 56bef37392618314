// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/cut_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "pamr/base/counted.hpp"
#include "pamr/io/elements/element_parts.hpp"

namespace pamr::io {

namespace {

/// Places of the nodes of a face, seen counter-clockwise from inside the cell; of a triangle the last is -1.
using PlacesOfFace = std::array<int, 4>;
constexpr std::array<PlacesOfFace, 5> faces_of_prism{
    {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
constexpr std::array<PlacesOfFace, 5> faces_of_pyramid{
    {{0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}}};

/// Places of the corners of the two triangles.
std::array<std::array<std::size_t, 3>, 2> halves_of(const std::array<std::int64_t, 4>& quadrangle) {
  const auto least =
      static_cast<std::size_t>(std::min_element(quadrangle.begin(), quadrangle.end()) - quadrangle.begin());
  const auto next = [&](std::size_t k) { return (least + k) % 4; };
  return {{{least, next(1), next(2)}, {least, next(2), next(3)}}};
}

}  // namespace

bool is_cut(int type) {
  return type == element_type::prism || type == element_type::pyramid || type == element_type::quadrangle;
}

std::vector<std::array<std::int64_t, 4>> tetrahedra_of(int type, std::span<const std::int64_t> nodes) {
  std::vector<std::array<std::int64_t, 4>> cells;
  if (type != element_type::prism && type != element_type::pyramid) return cells;
  const auto corners = nodes.first(type == element_type::prism ? 6 : 5);
  const auto least = std::min_element(corners.begin(), corners.end()) - corners.begin();
  const auto node = [&](int place) { return corners[static_cast<std::size_t>(place)]; };
  for (const auto& face : type == element_type::prism ? faces_of_prism : faces_of_pyramid) {
    if (std::find(face.begin(), face.end(), static_cast<int>(least)) != face.end()) continue;
    if (face[3] < 0)
      cells.push_back({node(face[0]), node(face[1]), node(face[2]), node(static_cast<int>(least))});
    else
      for (const auto& [a, b, c] : halves_of({node(face[0]), node(face[1]), node(face[2]), node(face[3])}))
        cells.push_back({node(face[a]), node(face[b]), node(face[c]), node(static_cast<int>(least))});
  }
  return cells;
}

std::vector<std::array<std::int64_t, 3>> triangles_of(int type, std::span<const std::int64_t> nodes) {
  std::vector<std::array<std::int64_t, 3>> triangles;
  if (type == element_type::quadrangle)
    for (const auto& [a, b, c] : halves_of({nodes[0], nodes[1], nodes[2], nodes[3]}))
      triangles.push_back({nodes[a], nodes[b], nodes[c]});
  return triangles;
}

std::string text_of_cut(const std::map<int, std::int64_t>& n_of_type) {
  const auto n = [&](int type) {
    const auto found = n_of_type.find(type);
    return found == n_of_type.end() ? 0 : found->second;
  };
  const auto prisms = n(element_type::prism), pyramids = n(element_type::pyramid),
             quadrangles = n(element_type::quadrangle);
  std::string text;
  if (prisms + pyramids > 0)
    text = fmt::format("{} and {} were cut into {} tetrahedra", counted(prisms, "prism", "prisms"),
                       counted(pyramids, "pyramid", "pyramids"), 3 * prisms + 2 * pyramids);
  if (quadrangles > 0)
    text += fmt::format("{}{} into {} triangles", text.empty() ? "" : ", ",
                        counted(quadrangles, text.empty() ? "quadrangle was cut" : "quadrangle",
                                text.empty() ? "quadrangles were cut" : "quadrangles"),
                        2 * quadrangles);
  return text;
}

}  // namespace pamr::io
