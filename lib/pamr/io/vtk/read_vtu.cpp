// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/read_vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/io/text.hpp"
#include "pamr/io/vtk/vtk_xml.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io::vtk {

namespace {

constexpr std::int64_t vertex = 1, poly_vertex = 2, line = 3, poly_line = 4, triangle = 5, tetrahedron = 10;
/// Of the patches; the first is what `write_vtu` calls them where a field is called `patch`.
constexpr std::array<std::string_view, 5> tag_names{"boundary_patch", "patch", "gmsh:physical", "CellEntityIds",
                                                    "medit:ref"};

/// The whole mesh, on rank 0.
struct Grid {
  std::vector<geometry::Vec3> point;
  std::vector<std::array<GlobalId, 4>> cell;
  std::vector<std::array<GlobalId, 3>> triangle;
  std::vector<std::int64_t> tag;  ///< of the triangles; empty: none
  std::map<std::int64_t, std::string> name_of_tag;
  std::vector<mesh::Field> cell_fields, node_fields;
  std::int64_t n_dropped = 0;
};

std::string text_of(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw Error("expected a file, found none");
  auto text = read_file(file);
  if (!text) throw Error("expected a file that can be read, found another");
  return std::move(*text);
}

const XmlArray& require(const XmlGrid& grid, std::string_view place, std::string_view name) {
  const auto* array = grid.find(place, name);
  if (array == nullptr) throw Error(fmt::format("expected an array {} of {}, found none", name, place));
  return *array;
}

/// Rows of the tetrahedra and of the triangles among all cells; their nodes go into `grid`.
struct Rows {
  std::vector<std::size_t> of_cells, of_triangles;
};

Rows read_cells(const XmlGrid& xml, Grid& grid) {
  const auto types = integers_of(xml, require(xml, "Cells", "types"), xml.n_cells);
  const auto ends = integers_of(xml, require(xml, "Cells", "offsets"), xml.n_cells);
  for (std::size_t c = 0; c < ends.size(); ++c)
    if (ends[c] < (c == 0 ? 0 : ends[c - 1]) || ends[c] > 32 * xml.n_cells)
      throw Error(fmt::format("Cells array 'offsets': expected numbers that grow, found {} in row {}", ends[c], c));
  const auto nodes = integers_of(xml, require(xml, "Cells", "connectivity"), ends.empty() ? 0 : ends.back());
  Rows rows;
  std::map<std::int64_t, std::int64_t> others;
  const auto take = [&](auto& row, std::size_t c) {
    const auto begin = c == 0 ? 0 : ends[c - 1];
    if (ends[c] - begin != std::ssize(row))
      throw Error(fmt::format("cell {}: expected {} nodes, found {}", c, row.size(), ends[c] - begin));
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = nodes[at(begin) + i];
      if (row[i] < 0 || row[i] >= xml.n_points)
        throw Error(fmt::format("cell {}: expected nodes from 0 to {}, found {}", c, xml.n_points - 1, row[i]));
    }
  };
  for (std::size_t c = 0; c < types.size(); ++c) {
    if (types[c] == tetrahedron) {
      take(grid.cell.emplace_back(), c);
      rows.of_cells.push_back(c);
    } else if (types[c] == triangle) {
      take(grid.triangle.emplace_back(), c);
      rows.of_triangles.push_back(c);
    } else if (types[c] < vertex || types[c] > poly_line) {
      ++others[types[c]];
    }
  }
  if (!others.empty())
    throw Error(fmt::format("expected tetrahedra and triangles, found {} cells of VTK's type {}",
                            others.begin()->second, others.begin()->first));
  if (grid.cell.empty()) throw Error("expected tetrahedra, found none");
  return rows;
}

mesh::Field read_field(const XmlGrid& xml, const XmlArray& array, std::int64_t n,
                       const std::vector<std::size_t>& rows) {
  if (array.n_components > 65536)
    throw Error(fmt::format("array '{}': expected 1 to 65536 components, found {}", array.name, array.n_components));
  mesh::Field field{array.name, "", static_cast<int>(array.n_components), storage_of(array.type), {}};
  std::visit(
      [&](const auto& all) {
        std::remove_cvref_t<decltype(all)> chosen;
        const auto width = at(array.n_components);
        chosen.reserve(rows.size() * width);
        for (const auto row : rows)
          chosen.insert(chosen.end(), all.begin() + static_cast<std::ptrdiff_t>(row * width),
                        all.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
        field.value = std::move(chosen);
      },
      values_of(xml, array, n * array.n_components));
  return field;
}

bool is_field(const XmlArray& array, std::string_view place) {
  return array.place == place && is_number_type(array.type) && !array.name.empty() &&
         array.name.find('/') == std::string::npos && is_clean_text(array.name, "");
}

/// Names of the patches where the file says them, as those of `write_vtu` do: field data `patch NAME` with the number.
std::map<std::int64_t, std::string> read_names(const XmlGrid& xml) {
  constexpr std::string_view before = "patch ";
  std::map<std::int64_t, std::string> names;
  for (const auto& array : xml.arrays) {
    if (array.place != "FieldData" || !array.name.starts_with(before) || array.name == before) continue;
    const auto number = integers_of(xml, array, 1).front();
    if (!names.emplace(number, array.name.substr(before.size())).second)
      throw Error(fmt::format("field data: expected one name of patch {}, found two", number));
  }
  return names;
}

/// Gives the other patches their numbers as names; leaves none where no triangle has a patch.
void complete_names(const std::vector<std::int64_t>& tags, std::map<std::int64_t, std::string>& names) {
  if (tags.empty()) return names.clear();
  for (const auto tag : tags) names.emplace(tag, fmt::format("patch_{}", tag));
  std::set<std::string> seen;
  for (const auto& [tag, name] : names)
    if (!seen.insert(name).second)
      throw Error(fmt::format("expected different names of patches, found '{}' twice", name));
}

/// Whether an array is no field but what `write_vtu` has worked out; the level of native files is none either.
bool is_extra(const XmlArray& array, bool is_ours) {
  return (array.name == "level" && array.type == "UInt8") ||
         (is_ours && array.name == "mean_ratio" && array.type == "Float32");
}

const XmlArray* find_tags(const XmlGrid& xml) {
  for (const auto name : tag_names)
    if (const auto* array = xml.find("CellData", name); array != nullptr && array->n_components == 1 &&
                                                        is_number_type(array->type) &&
                                                        mesh::is_integer(storage_of(array->type)))
      return array;
  return nullptr;
}

/// Leaves out the nodes that no cell has; returns the rows of those that stay.
std::vector<std::size_t> drop_nodes(Grid& grid, std::size_t n_points) {
  std::vector<GlobalId> number(n_points, -1);
  for (const auto& nodes : grid.cell)
    for (const auto node : nodes) number[at(node)] = 0;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < n_points; ++i)
    if (number[i] == 0) {
      number[i] = static_cast<GlobalId>(kept.size());
      kept.push_back(i);
    }
  for (auto& nodes : grid.cell)
    for (auto& node : nodes) node = number[at(node)];
  for (std::size_t t = 0; t < grid.triangle.size(); ++t)
    for (auto& node : grid.triangle[t]) {
      if (number[at(node)] < 0 && !grid.tag.empty())
        throw Error(fmt::format("triangle {}: expected nodes of tetrahedra, found node {} of none", t, node));
      node = number[at(node)];
    }
  grid.n_dropped = static_cast<std::int64_t>(n_points - kept.size());
  return kept;
}

Grid read_grid(const std::filesystem::path& file) {
  auto text = text_of(file);
  const auto xml = parse_grid(text);
  const auto most = static_cast<std::int64_t>(1100 * text.size());  // of what zlib could have packed
  if (xml.n_points > most || xml.n_cells > most)
    throw Error(fmt::format("expected counts in keeping with {} bytes, found {} points and {} cells", text.size(),
                            xml.n_points, xml.n_cells));
  Grid grid;
  const auto rows = read_cells(xml, grid);
  const auto* tags = rows.of_triangles.empty() ? nullptr : find_tags(xml);
  if (tags != nullptr) grid.tag = std::move(read_field(xml, *tags, xml.n_cells, rows.of_triangles).integer());
  grid.name_of_tag = read_names(xml);
  const bool is_ours = !grid.name_of_tag.empty();
  complete_names(grid.tag, grid.name_of_tag);
  const auto kept = drop_nodes(grid, at(xml.n_points));
  auto points = read_field(xml, require(xml, "Points", ""), xml.n_points, kept);
  if (points.holds_integers() || points.n_components != 3)
    throw Error("Points: expected three reals each, found others");
  for (std::size_t i = 0; i < points.real().size(); i += 3) {
    grid.point.push_back({points.real()[i], points.real()[i + 1], points.real()[i + 2]});
    const auto p = grid.point.back();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(fmt::format("Points: expected finite coordinates, found NaN or infinity at node {}", kept[i / 3]));
  }
  for (const auto& array : xml.arrays) {
    if (is_field(array, "PointData")) grid.node_fields.push_back(read_field(xml, array, xml.n_points, kept));
    if (is_field(array, "CellData") && &array != tags && !is_extra(array, is_ours))
      grid.cell_fields.push_back(read_field(xml, array, xml.n_cells, rows.of_cells));
  }
  return grid;
}

/// The fields of rank 0 with their names and types on the other ranks, which have no values. Collective.
std::vector<mesh::Field> share_outline(const par::Comm& comm, std::vector<mesh::Field> fields) {
  std::string names;
  std::vector<int> numbers;
  for (const auto& field : fields) {
    names += field.name + '\n';
    numbers.insert(numbers.end(), {field.n_components, static_cast<int>(field.storage)});
  }
  names = comm.broadcast(names);
  numbers = comm.broadcast(numbers);
  if (comm.is_first()) return fields;
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    const auto end = names.find('\n');
    mesh::Field field{names.substr(0, end), "", numbers[i], static_cast<mesh::StorageType>(numbers[i + 1]), {}};
    names.erase(0, end + 1);
    if (mesh::is_integer(field.storage)) field.value = std::vector<std::int64_t>();
    fields.push_back(std::move(field));
  }
  return fields;
}

/// The patches of rank 0, by number, on all ranks. Collective.
std::vector<mesh::Patch> share_patches(const par::Comm& comm, const std::map<std::int64_t, std::string>& name_of_tag) {
  std::string names;
  for (const auto& [tag, name] : name_of_tag) names += name + '\n';
  names = comm.broadcast(names);
  std::vector<mesh::Patch> patches;
  for (std::size_t at = 0; at < names.size(); at = names.find('\n', at) + 1)
    patches.push_back({names.substr(at, names.find('\n', at) - at), ""});
  return patches;
}

/// Rank 0 has all cells; nodes go to their canonical blocks. Collective.
mesh::BlockMesh to_block(const par::Comm& comm, Grid grid) {
  mesh::BlockMesh block;
  block.info.n_global_nodes = comm.sum(std::ssize(grid.point));
  block.info.n_global_cells = comm.sum(std::ssize(grid.cell));
  block.first_cell = comm.is_first() ? 0 : block.info.n_global_cells;
  block.cell_to_node = std::move(grid.cell);
  block.cell_fields = share_outline(comm, std::move(grid.cell_fields));
  block.node_fields = share_outline(comm, std::move(grid.node_fields));
  std::vector<GlobalId> ids(grid.point.size());
  std::iota(ids.begin(), ids.end(), 0);
  const auto scatter = [&](auto& rows, std::size_t width) {
    using T = typename std::remove_cvref_t<decltype(rows)>::value_type;
    rows = par::scatter_rows<T>(comm, block.info.n_global_nodes, rows, width, ids);
  };
  block.node_position = std::move(grid.point);
  scatter(block.node_position, 1);
  for (auto& field : block.node_fields)
    std::visit([&](auto& values) { scatter(values, at(field.n_components)); }, field.value);

  block.info.patches = share_patches(comm, grid.name_of_tag);
  if (!grid.tag.empty()) block.boundary.node = std::move(grid.triangle);
  std::vector<std::int64_t> tags;
  for (const auto& [tag, name] : grid.name_of_tag) tags.push_back(tag);
  for (const auto tag : grid.tag)
    block.boundary.patch.push_back(static_cast<int>(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin()));
  return block;
}

}  // namespace

}  // namespace pamr::io::vtk

namespace pamr::io {

ElementMesh read_vtu(const par::Comm& comm, const std::filesystem::path& file) {
  try {
    vtk::Grid grid;
    par::agree(comm, [&] {
      if (comm.is_first()) grid = vtk::read_grid(file);
    });
    ElementMesh result;
    result.n_dropped_nodes = comm.max(grid.n_dropped);
    auto block = vtk::to_block(comm, std::move(grid));
    result.n_turned = assemble::turn_inverted(comm, block).n_turned;
    result.mesh = assemble::assemble(comm, std::move(order::order_along_curve(comm, std::move(block)).block));
    return result;
  } catch (const Error& error) {  // reaches every rank
    throw Error(fmt::format("file '{}': {}", file.string(), error.what()));
  }
}

}  // namespace pamr::io
