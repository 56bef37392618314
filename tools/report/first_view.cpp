// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/first_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"

namespace pamr::report {

namespace {

using geometry::Box;
using geometry::Vec3;

constexpr double side_tolerance = 1e-6;  // of the diagonal
constexpr double spanning_part = 0.98;   // of the side of the box
constexpr double covering_part = 0.5;    // of the box's surface, from which on outer patches are a box around something

struct PatchShape {
  Box box;
  double area = 0;
  bool is_flat = true;  ///< each face lies on a side of the mesh's box
};

bool is_on_one_side(const Box& box, const std::array<Vec3, 3>& p) {
  const double tolerance = side_tolerance * box.diagonal();
  for (std::size_t d = 0; d < 3; ++d)
    for (const double side : {box.low[d], box.high[d]})
      if (std::all_of(p.begin(), p.end(), [&](Vec3 x) { return std::abs(x[d] - side) <= tolerance; })) return true;
  return false;
}

std::vector<PatchShape> shapes_of_patches(const check::MeshView& view) {
  std::vector<PatchShape> shapes(view.patches.size());
  for (std::size_t face = 0; face < view.faces.node.size(); ++face) {
    auto& shape = shapes[at(view.faces.patch[face])];
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = view.nodes.position[at(view.faces.node[face][i])];
    for (const auto x : p) shape.box.extend(x);
    shape.area += norm(cross(p[1] - p[0], p[2] - p[0])) / 2;
    shape.is_flat = shape.is_flat && is_on_one_side(view.box, p);
  }
  return shapes;
}

std::vector<std::array<Vec3, 3>> drawn_faces(const check::MeshView& view, const std::vector<std::string>& hidden) {
  std::vector<std::array<Vec3, 3>> faces;
  for (std::size_t face = 0; face < view.faces.node.size(); ++face) {
    const auto& name = view.patches[at(view.faces.patch[face])].name;
    if (std::find(hidden.begin(), hidden.end(), name) != hidden.end()) continue;
    auto& corners = faces.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = view.nodes.position[at(view.faces.node[face][i])] - view.box.center();
  }
  return faces;
}

/// A patch on the sides of the box, or one as wide as the box in two directions, such as a far field.
bool is_outer(const PatchShape& shape, const Box& box) {
  int n_spanned = 0;
  for (std::size_t d = 0; d < 3; ++d)
    if (shape.box.size()[d] >= spanning_part * box.size()[d]) ++n_spanned;
  return shape.is_flat || n_spanned >= 2;
}

}  // namespace

FirstView first_view(const std::vector<ReportedMesh>& meshes) {
  const auto& view = meshes.back().view;
  FirstView first{"boundary", deepest_level(meshes) > 0 ? "level" : "patch", {}, {}};
  const auto shapes = shapes_of_patches(view);
  const auto side = view.box.size();
  bool has_bodies = false, is_box = true;
  double area = 0;
  std::vector<std::string> outer;
  for (std::size_t p = 0; p < shapes.size(); ++p) {
    if (shapes[p].area <= 0) continue;  // without faces
    is_box = is_box && shapes[p].is_flat;
    if (!is_outer(shapes[p], view.box)) {
      has_bodies = true;
      continue;
    }
    outer.push_back(view.patches[p].name);
    area += shapes[p].area;
  }
  if (is_box) {
    first.show = "y", first.color = "level";
    return first;
  }
  if (has_bodies && area >= covering_part * 2 * (side.x * side.y + side.y * side.z + side.z * side.x))
    first.hidden = std::move(outer);
  const auto n_panels = static_cast<double>(first_meshes(meshes).size());
  first.direction = covering_direction(drawn_faces(view, first.hidden), picture_width / (n_panels * picture_height));
  return first;
}

std::vector<std::size_t> first_meshes(const std::vector<ReportedMesh>& meshes) {
  return meshes.size() == 1 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, meshes.size() - 1};
}

std::vector<std::string> patch_names(const std::vector<ReportedMesh>& meshes) {
  std::vector<std::string> names;
  for (const auto& mesh : meshes)
    for (const auto& patch : mesh.view.patches)
      if (std::find(names.begin(), names.end(), patch.name) == names.end()) names.push_back(patch.name);
  return names;
}

int deepest_level(const std::vector<ReportedMesh>& meshes) {
  std::size_t n_levels = 1;
  for (const auto& mesh : meshes) n_levels = std::max(n_levels, mesh.numbers.report.cells_of_level.size());
  return static_cast<int>(n_levels) - 1;
}

}  // namespace pamr::report
