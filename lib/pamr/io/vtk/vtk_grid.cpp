// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/vtk_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io::vtk {

namespace {

/// An array of tags, and what begins the names of patches that have none: as the reader of that format calls them.
struct TagArray {
  std::string_view name, prefix = "patch_";
};

/// Of the patches, and but for the first two of the regions as well; the first is what `write_vtu` calls them where a
/// field is called `patch`, the rest come from VTK and from meshio.
constexpr std::array<TagArray, 12> tag_arrays{{{"boundary_patch"},
                                               {"patch"},
                                               {"gmsh:physical", "physical_"},
                                               {"gmsh:geometrical", "surface_"},
                                               {"medit:ref", "ref_"},
                                               {"tetgen:ref"},
                                               {"netgen:index"},
                                               {"ugrid:ref", "surface_"},
                                               {"nastran:ref"},
                                               {"su2:tag"},
                                               {"avsucd:material"},
                                               {"CellEntityIds"}}};

/// Of VTK, a rectangle whose nodes come row by row.
constexpr std::int64_t pixel = 8;

/// Rows of the tetrahedra and of the triangles among all cells, of what a cell was cut into the row of that cell.
struct CellRows {
  std::vector<std::size_t> of_cells, of_triangles;
};

constexpr std::array<std::string_view, 2> before_name{before_patch, before_untagged};

CellRows take_cells(const Grid& grid, WholeMesh& mesh) {
  CellRows rows;
  reserve_array(mesh.cell, grid.types.size());
  reserve_array(rows.of_cells, grid.types.size());
  std::int64_t n_left_out = 0;
  const auto take = [&](std::span<std::int64_t> row, std::size_t c) {
    const auto begin = c == 0 ? 0 : grid.ends[c - 1];
    if (grid.ends[c] - begin != std::ssize(row))
      throw Error(fmt::format("cell {}: expected {} nodes, found {}", c, row.size(), grid.ends[c] - begin));
    std::copy_n(grid.nodes.begin() + static_cast<std::ptrdiff_t>(begin), row.size(), row.begin());
    for (const auto node : row)
      if (node < 0 || node >= grid.n_points)
        throw Error(fmt::format("cell {}: expected nodes from 0 to {}, found {}", c, grid.n_points - 1, node));
  };
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    const int type = element_type::of_vtk(grid.types[c]);
    if (type == 0)
      throw Error(fmt::format("cell {}: expected a type of VTK that is known, found {}", c, grid.types[c]));
    if (type == element_type::tetrahedron) {
      take(mesh.cell.emplace_back(), c);
      rows.of_cells.push_back(c);
    } else if (type == element_type::triangle) {
      take(mesh.triangle.emplace_back(), c);
      rows.of_triangles.push_back(c);
    } else if (is_cut(type)) {
      std::array<std::int64_t, max_nodes> nodes{};
      take(std::span(nodes).first(at(n_nodes_of_type(type))), c);
      if (type == element_type::prism) turn_prism_of_vtk(nodes);
      if (grid.types[c] == pixel) std::swap(nodes[2], nodes[3]);
      ++mesh.cut[type];
      for (const auto& cell : tetrahedra_of(type, nodes)) {
        mesh.cell.push_back(cell);
        rows.of_cells.push_back(c);
      }
      for (const auto& triangle : triangles_of(type, nodes)) {
        mesh.triangle.push_back(triangle);
        rows.of_triangles.push_back(c);
      }
    } else if (type == element_type::point || type == element_type::line) {
      ++n_left_out;
    } else {
      ++mesh.refused[type];
    }
  }
  if (n_left_out > 0)
    mesh.remarks.push_back(counted(n_left_out, "point or line was", "points and lines were") + " left out");
  return rows;
}

/// The field of an array; with `rows` of these cells alone.
mesh::Field field_of(const GridArray& array, const std::vector<std::size_t>* rows) {
  if (array.n_components > 65536)
    throw Error(fmt::format("array '{}': expected 1 to 65536 components, found {}", array.name, array.n_components));
  mesh::Field field{array.name, "", static_cast<int>(array.n_components), storage_of(array.type), {}};
  std::visit(
      [&](auto&& all) {
        std::remove_cvref_t<decltype(all)> chosen;
        if (rows == nullptr) {
          chosen = std::forward<decltype(all)>(all);
        } else {
          const auto width = at(array.n_components);
          chosen.reserve(rows->size() * width);
          for (const auto row : *rows)
            chosen.insert(chosen.end(), all.begin() + static_cast<std::ptrdiff_t>(row * width),
                          all.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
        }
        field.value = std::move(chosen);
      },
      array.values());
  return field;
}

/// Whether an array is no field but what `write_vtu` has worked out; the level of native files is none either.
bool is_extra(const GridArray& array, bool is_ours) {
  return (array.name == mesh::level_field && array.type == "UInt8") ||
         (is_ours && array.name == "mean_ratio" && array.type == "Float32");
}

/// Says that such an array of another program is left out.
void say_extra(const GridArray& array, bool is_ours, WholeMesh& mesh) {
  if (!is_ours)
    mesh.remarks.push_back(fmt::format(
        "the array '{}' was left out: one of that name and type says how often cells were refined", array.name));
}

/// Whether tags are of triangles alone; those of other programs say the region of a tetrahedron, too.
bool is_of_patches(const GridArray& tags) { return tags.name == tag_arrays[0].name || tags.name == tag_arrays[1].name; }

bool is_integer(const GridArray& array) {
  return array.n_components == 1 && is_number_type(array.type) && mesh::is_integer(storage_of(array.type));
}

/// Names patches that have none. Pre: `tags` is one of `tag_arrays`.
void name_patches(const GridArray& tags, WholeMesh& mesh) {
  const auto* known =
      std::find_if(tag_arrays.begin(), tag_arrays.end(), [&](const auto& t) { return t.name == tags.name; });
  for (const auto tag : mesh.tag)
    if (!mesh.patch_of_tag.contains(tag))
      mesh.patch_of_tag[tag] = {
          .name = fmt::format("{}{}", known->prefix, tag), .kind = "", .number = std::max<std::int64_t>(tag, -1)};
}

/// What is said of an array that is no field.
std::string remark_on(const GridArray& array) {
  return fmt::format("the array '{}' was left out: a field has numbers, and a name without '/' and control characters",
                     shown_text(array.name));
}

const GridArray* find_tags(const Grid& grid) {
  for (const auto& tags : tag_arrays) {
    const auto found = std::find_if(grid.arrays.begin(), grid.arrays.end(), [&](const GridArray& array) {
      return !array.is_on_points && array.name == tags.name && is_integer(array);
    });
    if (found != grid.arrays.end()) return &*found;
  }
  return nullptr;
}

bool is_field(const GridArray& array) {
  return is_number_type(array.type) && !array.name.empty() && array.name.find('/') == std::string::npos &&
         is_clean_text(array.name, "");
}

}  // namespace

bool is_patch_name(std::string_view array) {
  return std::any_of(before_name.begin(), before_name.end(),
                     [&](auto before) { return array.starts_with(before) && array != before; });
}

void name_patch(Grid& grid, std::string_view array, std::int64_t number) {
  const bool has_tag = array.starts_with(before_patch);
  const mesh::Patch patch{std::string(array.substr((has_tag ? before_patch : before_untagged).size())),
                          has_tag ? "" : mesh::untagged_kind};
  if (!grid.patch_of_tag.emplace(number, patch).second)
    throw Error(fmt::format("field data: expected one name of patch {}, found two", number));
}

WholeMesh to_whole_mesh(const Grid& grid) {
  WholeMesh mesh;
  if (grid.points.index() != 0) throw Error("Points: expected reals, found integers");
  const auto& points = std::get<0>(grid.points);
  reserve_array(mesh.point, points.size() / 3);
  for (std::size_t i = 0; i + 2 < points.size(); i += 3)
    mesh.point.push_back({points[i], points[i + 1], points[i + 2]});
  const auto rows = take_cells(grid, mesh);
  const auto* tags = find_tags(grid);
  const bool has_regions = tags != nullptr && !is_of_patches(*tags);
  if (rows.of_triangles.empty() && !has_regions) tags = nullptr;
  if (tags != nullptr) mesh.tag = std::move(field_of(*tags, &rows.of_triangles).integer());
  const bool has_field = std::any_of(grid.arrays.begin(), grid.arrays.end(), [](const GridArray& array) {
    return !array.is_on_points && array.name == mesh::region_field;
  });
  if (has_regions && !has_field) mesh.region = std::move(field_of(*tags, &rows.of_cells).integer());
  mesh.patch_of_tag = grid.patch_of_tag;
  if (tags != nullptr) name_patches(*tags, mesh);
  for (const auto& name : grid.left_out)
    mesh.remarks.push_back(
        fmt::format("the array '{}' was left out: it is neither on points nor on cells", shown_text(name)));
  mesh.remarks.insert(mesh.remarks.end(), grid.remarks.begin(), grid.remarks.end());
  if (grid.n_named_components > 0)
    mesh.remarks.push_back(fmt::format("the names of components of {} were left out",
                                       counted(grid.n_named_components, "array", "arrays")));
  const bool is_ours = !grid.patch_of_tag.empty();
  for (const auto& array : grid.arrays) {
    if (&array == tags) continue;
    if (!is_field(array)) {
      mesh.remarks.push_back(remark_on(array));
      continue;
    }
    if (array.is_on_points)
      mesh.node_fields.push_back(field_of(array, nullptr));
    else if (is_extra(array, is_ours))
      say_extra(array, is_ours, mesh);
    else if (!(has_regions && array.name == "gmsh:geometrical"))
      mesh.cell_fields.push_back(field_of(array, &rows.of_cells));
  }
  return mesh;
}

}  // namespace pamr::io::vtk
