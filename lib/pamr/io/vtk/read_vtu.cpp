// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/read_vtu.hpp"

#include <fmt/format.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/vtk/vtk_grid.hpp"
#include "pamr/io/vtk/vtk_xml.hpp"

namespace pamr::io::vtk {

namespace {

std::string text_of(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw Error("expected a file, found none");
  auto text = read_file(file);
  if (!text) throw Error("expected a file that can be read, found another");
  return std::move(*text);
}

const XmlArray& require(const XmlGrid& grid, std::string_view place, std::string_view name) {
  const auto* array = grid.find(place, name);
  if (array == nullptr)
    throw Error(
        fmt::format("expected an array {}of {}, found none", name.empty() ? "" : std::string(name) + " ", place));
  return *array;
}

WholeMesh read_whole(const std::filesystem::path& file) {
  auto text = text_of(file);
  const auto xml = parse_grid(text);
  const auto most = static_cast<std::int64_t>(1100 * text.size());  // of what zlib could have packed
  if (xml.n_points > most || xml.n_cells > most)
    throw Error(fmt::format("expected counts in keeping with {} bytes, found {} points and {} cells", text.size(),
                            xml.n_points, xml.n_cells));
  Grid grid;
  grid.n_points = xml.n_points;
  const auto& points = require(xml, "Points", "");
  if (points.n_components != 3) throw Error("Points: expected three reals each, found others");
  grid.points = values_of(xml, points, 3 * xml.n_points);
  grid.types = integers_of(xml, require(xml, "Cells", "types"), xml.n_cells);
  grid.ends = integers_of(xml, require(xml, "Cells", "offsets"), xml.n_cells);
  for (std::size_t c = 0; c < grid.ends.size(); ++c)
    if (grid.ends[c] < (c == 0 ? 0 : grid.ends[c - 1]) || grid.ends[c] > 32 * xml.n_cells)
      throw Error(
          fmt::format("Cells array 'offsets': expected numbers that grow, found {} in row {}", grid.ends[c], c));
  grid.nodes = integers_of(xml, require(xml, "Cells", "connectivity"), grid.ends.empty() ? 0 : grid.ends.back());
  for (const auto& array : xml.arrays) {
    const bool is_on_points = array.place == "PointData";
    if (!is_on_points && array.place != "CellData") continue;
    grid.n_named_components += array.has_component_names ? 1 : 0;
    const auto n = is_on_points ? xml.n_points : xml.n_cells;
    grid.arrays.push_back({is_on_points, array.name, array.type, array.n_components,
                           [&xml, &array, n] { return values_of(xml, array, n * array.n_components); }});
  }
  for (const auto& array : xml.arrays)
    if (array.place == "FieldData") {
      if (is_patch_name(array.name))
        name_patch(grid, array.name, integers_of(xml, array, 1).front());
      else
        grid.left_out.push_back(array.name);
    }
  return to_whole_mesh(grid);
}

}  // namespace

}  // namespace pamr::io::vtk

namespace pamr::io {

ElementMesh read_vtu(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  return mesh_of_whole(comm, file, options, [&] { return vtk::read_whole(file); });
}

}  // namespace pamr::io
