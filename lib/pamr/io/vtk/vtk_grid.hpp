// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/vtk/vtk_xml.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/field.hpp"

/// What VTK's files say of an unstructured grid, whichever way they are written. Local.
namespace pamr::io::vtk {

/// An array of numbers on points or cells.
struct GridArray {
  bool is_on_points = false;
  std::string name, type;  ///< the type as `storage_of` takes it
  std::int64_t n_components = 1;
  std::function<Values()> values;  ///< n_components for each point or cell
};

struct Grid {
  std::int64_t n_points = 0;
  Values points;                                 ///< 3 n_points, reals
  std::vector<std::int64_t> types, ends, nodes;  ///< of the cells: `nodes` up to `ends`
  std::vector<GridArray> arrays;
  std::map<std::int64_t, mesh::Patch> patch_of_tag;  ///< names that the file has: it is ours then
  std::vector<std::string> left_out;                 ///< arrays that have no row for each point or cell
  std::vector<std::string> remarks;                  ///< what else has no place in a mesh
  std::int64_t n_named_components = 0;               ///< arrays whose components have names
};

/// Field data `patch NAME` say the number of a patch, as those of `write_vtu` do, and `untagged patch NAME` that of the
/// patch of faces without a tag.
inline constexpr std::string_view before_patch = "patch ", before_untagged = "untagged patch ";
/// Whether field data of that name say the number of a patch.
bool is_patch_name(std::string_view array);
/// Takes the name of a patch from such field data; throws `Error` where the number has one.
void name_patch(Grid& grid, std::string_view array, std::int64_t number);

/// Tetrahedra as cells; triangles with the first integer array of those that PAMR, VTK and meshio use for it as tags,
/// which are the regions of the tetrahedra too where the array is not PAMR's; other arrays as fields. Points and lines
/// are left out with a remark, wedges, pyramids and quadrangles are cut, other cells counted as refused. Throws `Error`,
/// without the name of the file.
WholeMesh to_whole_mesh(const Grid& grid);

}  // namespace pamr::io::vtk
