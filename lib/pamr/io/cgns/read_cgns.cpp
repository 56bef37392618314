// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: CGNS documentation, "Standard Interface Data Structures".
#include "pamr/io/cgns/read_cgns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/cgns/cgns_conditions.hpp"
#include "pamr/io/cgns/cgns_fields.hpp"
#include "pamr/io/cgns/cgns_nodes.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io {

namespace cgns {

namespace {

constexpr std::int64_t mixed = 20, n_gon = 22;

/// Types of elements as types of Gmsh, 0 for those that are not known.
int type_of(std::int64_t type) {
  constexpr std::array<int, 22> types{0,
                                      0,
                                      element_type::point,
                                      element_type::line,
                                      8,
                                      element_type::triangle,
                                      9,
                                      element_type::quadrangle,
                                      16,
                                      10,
                                      element_type::tetrahedron,
                                      11,
                                      element_type::pyramid,
                                      14,
                                      element_type::prism,
                                      18,
                                      13,
                                      element_type::hexahedron,
                                      17,
                                      12,
                                      0,
                                      19};
  if (type >= n_gon) return element_type::polygon;
  return type >= 0 && type < std::ssize(types) ? types[at(type)] : 0;
}

class ZoneReader {
 public:
  explicit ZoneReader(const Tree& tree) : tree_(tree), base_(tree.child("/", "CGNSBase_t").path) {
    const auto zone = tree.child(base_, "Zone_t");
    zone_ = zone.path;
    const auto type = tree.text(tree.child(zone_, "ZoneType_t"));
    if (type != "Unstructured")
      throw Error(fmt::format("{}: expected an unstructured zone, found {}", zone_, type.substr(0, 40)));
    const auto sizes = tree.integers(zone);
    if (sizes.size() != 3) throw Error(zone_ + ": expected three sizes, found others");
    n_nodes_ = sizes[0];
  }

  WholeMesh read() {
    read_points();
    for (const auto& section : tree_.children(zone_, "Elements_t")) read_section(section);
    read_conditions(tree_, base_, zone_, elements_, mesh_);
    read_solutions(tree_, zone_, {n_nodes_, std::ssize(cells_)}, mesh_);
    set_regions();
    put_cells_in_order();
    count_others(tree_, base_, {"Zone_t", "Family_t"}, mesh_.left_out);
    count_others(tree_, zone_,
                 {"GridCoordinates_t", "Elements_t", "ZoneBC_t", "FlowSolution_t", "ZoneType_t", "FamilyName_t"},
                 mesh_.left_out);
    return std::move(mesh_);
  }

 private:
  void read_points() {
    const auto grid = tree_.child(zone_, "GridCoordinates_t");
    for (const auto& array : tree_.children(grid.path, "DataArray_t")) {
      constexpr std::array<const char*, 3> names{"CoordinateX", "CoordinateY", "CoordinateZ"};
      const auto* axis = std::find(names.begin(), names.end(), array.name);
      if (axis == names.end()) {
        ++mesh_.left_out["arrays beside the coordinates"];
        continue;
      }
      const auto values = tree_.reals(array);
      if (std::ssize(values) != n_nodes_)
        throw Error(fmt::format("{}: expected {} values, found {}", array.path, n_nodes_, values.size()));
      mesh_.point.resize(values.size());
      for (std::size_t i = 0; i < values.size(); ++i) mesh_.point[i][at(axis - names.begin())] = values[i];
      ++n_axes_;
      count_others(tree_, array.path, {}, mesh_.left_out);
    }
    count_others(tree_, grid.path, {"DataArray_t"}, mesh_.left_out);
    if (n_axes_ != 3)
      throw Error(fmt::format("{}: expected CoordinateX, Y and Z, found {} of them", grid.path, n_axes_));
  }

  void read_section(const Node& section) {
    const auto head = tree_.integers(section);
    const auto range = integers_named(section, "IndexRange_t", "ElementRange");
    const auto nodes = integers_named(section, "DataArray_t", "ElementConnectivity");
    if (head.empty() || range.size() != 2 || range[0] < 1 || range[1] < range[0] - 1)
      throw Error(section.path + ": expected a type and a range of elements, found others");
    const auto n = range[1] - range[0] + 1;
    if (n > std::ssize(nodes)) throw Error(section.path + ": expected nodes of all elements, found fewer");
    std::size_t next = 0;
    for (std::int64_t i = 0; i < n; ++i) {
      const auto own = head[0] != mixed ? head[0] : next < nodes.size() ? nodes[next++] : 0;
      const int type = type_of(own);
      if (type == 0) throw Error(fmt::format("{}: expected a known type of elements, found {}", section.path, own));
      if (type == element_type::polygon) {
        mesh_.refused[type] += n;
        return;
      }
      const auto n_corners = static_cast<std::size_t>(n_nodes_of_type(type));
      if (nodes.size() - next < n_corners) throw Error(section.path + ": expected nodes of all elements, found fewer");
      keep(section, range[0] + i, type, nodes.data() + next);
      next += n_corners;
    }
  }

  void keep(const Node& section, std::int64_t number, int type, const std::int64_t* nodes) {
    if (type == element_type::tetrahedron) {
      add_cells(section, number, {{{nodes[0] - 1, nodes[1] - 1, nodes[2] - 1, nodes[3] - 1}}});
    } else if (type == element_type::prism || type == element_type::pyramid) {
      ++mesh_.cut[type];
      add_cells(section, number, tetrahedra_of(type, rows_of(nodes, type)));
    } else if (type == element_type::quadrangle) {
      ++mesh_.cut[type];
      add_triangles(section, number, triangles_of(type, rows_of(nodes, type)));
    } else if (type == element_type::triangle) {
      add_triangles(section, number, {{{nodes[0] - 1, nodes[1] - 1, nodes[2] - 1}}});
    } else if (type == element_type::point || type == element_type::line) {
      ++mesh_.left_out[type == element_type::point ? "points" : "lines"];
    } else {
      ++mesh_.refused[type];
    }
  }

  static std::vector<std::int64_t> rows_of(const std::int64_t* nodes, int type) {
    std::vector<std::int64_t> rows(nodes, nodes + n_nodes_of_type(type));
    for (auto& row : rows) --row;
    return rows;
  }

  /// The tetrahedra of one element.
  void add_cells(const Node& section, std::int64_t number, const std::vector<std::array<std::int64_t, 4>>& pieces) {
    cells_.push_back({number, {mesh_.cell.size(), pieces.size()}});
    elements_.cell_of[number] = cells_.back().pieces;
    mesh_.cell.insert(mesh_.cell.end(), pieces.begin(), pieces.end());
    elements_.group_of_cell.insert(elements_.group_of_cell.end(), pieces.size(), section.name);
  }

  void add_triangles(const Node& section, std::int64_t number, const std::vector<std::array<std::int64_t, 3>>& pieces) {
    elements_.triangle_of[number] = {mesh_.tag.size(), pieces.size()};
    mesh_.triangle.insert(mesh_.triangle.end(), pieces.begin(), pieces.end());
    mesh_.tag.insert(mesh_.tag.end(), pieces.size(), elements_.tag_of(section.name, mesh_));
  }

  std::vector<std::int64_t> integers_named(const Node& parent, const char* label, std::string_view name) const {
    for (const auto& node : tree_.children(parent.path, label))
      if (node.name == name) return tree_.integers(node);
    throw Error(fmt::format("{}: expected {}, found none", parent.path, name));
  }

  /// Several sections of cells, or conditions that name cells, are regions, unless a field has these.
  void set_regions() {
    std::map<std::string, std::int64_t> region;
    for (const auto& name : elements_.group_of_cell) region.emplace(name, std::ssize(region) + 1);
    const bool has_field = std::any_of(mesh_.cell_fields.begin(), mesh_.cell_fields.end(),
                                       [](const auto& field) { return field.name == "region"; });
    if (has_field || (region.size() < 2 && !elements_.has_named_cells)) return;
    for (const auto& [name, number] : region) mesh_.name_of_region[number] = name;
    for (const auto& name : elements_.group_of_cell) mesh_.region.push_back(region.at(name));
  }

  /// Values at cell centers follow the numbers of the elements, sections any order.
  void put_cells_in_order() {
    std::stable_sort(cells_.begin(), cells_.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
    std::vector<std::size_t> order, row_of_piece;
    for (std::size_t row = 0; row < cells_.size(); ++row)
      for (std::size_t k = 0; k < cells_[row].pieces.n; ++k) {
        order.push_back(cells_[row].pieces.first + k);
        row_of_piece.push_back(row);
      }
    mesh_.cell = chosen(mesh_.cell, order, 1);
    if (!mesh_.region.empty()) mesh_.region = chosen(mesh_.region, order, 1);
    if (mesh_.cut.empty()) return;
    for (auto& field : mesh_.cell_fields)  // each piece has the values of its element
      std::visit([&](auto& values) { values = chosen(values, row_of_piece, at(field.n_components)); }, field.value);
  }

  template <class T>
  static std::vector<T> chosen(const std::vector<T>& all, const std::vector<std::size_t>& rows, std::size_t width) {
    std::vector<T> result;
    result.reserve(rows.size() * width);
    for (const auto row : rows)
      for (std::size_t k = 0; k < width; ++k) result.push_back(all[row * width + k]);
    return result;
  }

  const Tree& tree_;
  std::string base_, zone_;
  WholeMesh mesh_;
  std::int64_t n_nodes_ = 0;
  int n_axes_ = 0;
  struct Cell {
    std::int64_t number = 0;  ///< of the element in the file
    ZoneElements::Pieces pieces;
  };
  std::vector<Cell> cells_;  ///< in the order of the file, then of their numbers
  ZoneElements elements_;
};

WholeMesh read_whole(const std::filesystem::path& file) {
  const hdf5::Silence silence;
  const Tree tree(file);
  return ZoneReader(tree).read();
}

}  // namespace

}  // namespace cgns

ElementMesh read_cgns(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  return mesh_of_whole(comm, file, options, [&] { return cgns::read_whole(file); });
}

void try_reading_cgns(const std::filesystem::path& file) {
  try {
    (void)cgns::read_whole(file);
  } catch (const Error& error) {
    throw Error(source_of(file) + ": " + error.what());
  }
}

}  // namespace pamr::io
