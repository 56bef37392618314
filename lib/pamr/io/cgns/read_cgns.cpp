// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: CGNS documentation, "Standard Interface Data Structures".
#include "pamr/io/cgns/read_cgns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/cgns/cgns_conditions.hpp"
#include "pamr/io/cgns/cgns_fields.hpp"
#include "pamr/io/cgns/cgns_nodes.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io {

namespace cgns {

namespace {

constexpr std::int64_t tetrahedra = 10, mixed = 20, n_gon = 22;
constexpr std::int64_t largest_number = std::int64_t{1} << 60U;  ///< of an element

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
  using Corners = std::array<std::int64_t, 4>;
  using Triangle = std::array<std::int64_t, 3>;

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
    elements_.cells.put_in_order();
    elements_.triangles.put_in_order();
    read_conditions(tree_, base_, zone_, elements_, mesh_);
    read_solutions(tree_, zone_, {n_nodes_, elements_.cells.size()}, mesh_);
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
    if (head.empty() || range.size() != 2 || range[0] < 1 || range[1] < range[0] - 1 || range[1] > largest_number)
      throw Error(section.path + ": expected a type and a range of elements, found others");
    const auto n = range[1] - range[0] + 1;
    if (n > std::ssize(nodes)) throw Error(section.path + ": expected nodes of all elements, found fewer");
    if (head[0] == tetrahedra && mesh_.cell.empty()) {
      const auto most = std::min(at(n), nodes.size() / 4);
      reserve_array(mesh_.cell, most);
      reserve_array(elements_.group_of_cell, most);
    }
    group_ = -1;
    tag_ = -1;
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
      const Corners cell{nodes[0] - 1, nodes[1] - 1, nodes[2] - 1, nodes[3] - 1};
      add_cells(section, number, {&cell, 1});
    } else if (type == element_type::prism || type == element_type::pyramid) {
      ++mesh_.cut[type];
      add_cells(section, number, tetrahedra_of(type, rows_of(nodes, type)));
    } else if (type == element_type::quadrangle) {
      ++mesh_.cut[type];
      add_triangles(section, number, triangles_of(type, rows_of(nodes, type)));
    } else if (type == element_type::triangle) {
      const Triangle triangle{nodes[0] - 1, nodes[1] - 1, nodes[2] - 1};
      add_triangles(section, number, {&triangle, 1});
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
  void add_cells(const Node& section, std::int64_t number, std::span<const Corners> pieces) {
    if (group_ < 0) group_ = elements_.group_of({section.name, {}});
    elements_.cells.add(number, {mesh_.cell.size(), pieces.size()});
    mesh_.cell.insert(mesh_.cell.end(), pieces.begin(), pieces.end());
    elements_.group_of_cell.insert(elements_.group_of_cell.end(), pieces.size(), group_);
  }

  void add_triangles(const Node& section, std::int64_t number, std::span<const Triangle> pieces) {
    if (tag_ < 0) tag_ = elements_.tag_of(section.name, mesh_);
    elements_.triangles.add(number, {mesh_.tag.size(), pieces.size()});
    mesh_.triangle.insert(mesh_.triangle.end(), pieces.begin(), pieces.end());
    mesh_.tag.insert(mesh_.tag.end(), pieces.size(), tag_);
  }

  std::vector<std::int64_t> integers_named(const Node& parent, const char* label, std::string_view name) const {
    for (const auto& node : tree_.children(parent.path, label))
      if (node.name == name) return tree_.integers(node);
    throw Error(fmt::format("{}: expected {}, found none", parent.path, name));
  }

  /// Several sections of cells, or conditions that name cells, are regions, unless a field has these.
  void set_regions() {
    std::vector<std::int64_t> region(elements_.group.size(), 0);  // 0: of no cell
    std::int64_t n_regions = 0;
    for (const auto group : elements_.group_of_cell)
      if (region[at(group)] == 0) region[at(group)] = ++n_regions;
    const bool has_field = std::any_of(mesh_.cell_fields.begin(), mesh_.cell_fields.end(),
                                       [](const auto& field) { return field.name == "region"; });
    if (has_field || (n_regions < 2 && !elements_.has_named_cells)) return;
    std::map<std::string, std::int64_t> number;  // of groups that regions are in
    for (std::size_t group = 0; group < region.size(); ++group) {
      if (region[group] == 0) continue;
      mesh_.name_of_region[region[group]] = elements_.group[group].name;
      if (elements_.group[group].members.empty()) number[elements_.group[group].name] = region[group];
    }
    for (std::size_t group = 0; group < region.size(); ++group)
      for (const auto& member : elements_.group[group].members) {
        if (region[group] == 0) break;
        const auto [known, is_new] = number.try_emplace(member, n_regions + 1);
        if (is_new) ++n_regions;
        mesh_.groups_of_region[region[group]].push_back({known->second, member});
      }
    for (const auto group : elements_.group_of_cell) mesh_.region.push_back(region[at(group)]);
  }

  /// Values at cell centers follow the numbers of the elements, sections any order.
  void put_cells_in_order() {
    if (elements_.cells.were_in_order() && mesh_.cut.empty()) return;
    std::vector<std::size_t> order, row_of_piece;
    reserve_array(order, mesh_.cell.size());
    reserve_array(row_of_piece, mesh_.cell.size());
    std::size_t row = 0;
    for (const auto& run : elements_.cells.runs())
      for (auto element = run.number; element < run.end(); ++element, ++row)
        for (std::size_t k = 0; k < run.pieces.n; ++k) {
          order.push_back(run.of(element).first + k);
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
    reserve_array(result, rows.size() * width);
    for (const auto row : rows)
      for (std::size_t k = 0; k < width; ++k) result.push_back(all[row * width + k]);
    return result;
  }

  const Tree& tree_;
  std::string base_, zone_;
  WholeMesh mesh_;
  std::int64_t n_nodes_ = 0;
  int n_axes_ = 0;
  ZoneElements elements_;
  std::int32_t group_ = -1;  ///< of the section's cells, once it has any
  std::int64_t tag_ = -1;    ///< of its triangles
};

WholeMesh read_whole(const std::filesystem::path& file, const BeforeRead& before_read = {}) {
  const hdf5::Silence silence;
  const Tree tree(file, before_read);
  return ZoneReader(tree).read();
}

}  // namespace

}  // namespace cgns

ElementMesh read_cgns(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  return mesh_of_whole(comm, file, options, [&] { return cgns::read_whole(file); });
}

void try_reading_cgns(const std::filesystem::path& file, const std::function<void(std::uint64_t bytes)>& before_read) {
  try {
    (void)cgns::read_whole(file, before_read);
  } catch (const Error& error) {
    throw Error(source_of(file) + ": " + error.what());
  }
}

}  // namespace pamr::io
