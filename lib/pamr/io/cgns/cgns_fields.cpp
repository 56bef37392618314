// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/cgns/cgns_fields.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/field.hpp"

namespace pamr::io::cgns {

namespace {

const Node* find(const std::vector<Node>& arrays, const std::string& name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const Node& array) { return array.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

mesh::Field field_of(const Tree& tree, const Node& array) {
  if (tree.is_integer(array)) return {array.name, "", 1, mesh::StorageType::int64, tree.integers(array)};
  return {array.name, "", 1, mesh::StorageType::float64, tree.reals(array)};
}

mesh::Field vector_of(const Tree& tree, const std::string& name, const std::vector<const Node*>& parts) {
  mesh::Field field{name, "", 3, mesh::StorageType::float64, std::vector<double>()};
  for (std::size_t axis = 0; axis < parts.size(); ++axis) {
    const auto values = tree.reals(*parts[axis]);
    field.real().resize(3 * values.size());
    for (std::size_t row = 0; row < values.size(); ++row) field.real()[3 * row + axis] = values[row];
  }
  return field;
}

}  // namespace

void read_solutions(const Tree& tree, const std::string& zone, const ZoneSizes& sizes, WholeMesh& mesh) {
  for (const auto& solution : tree.children(zone, "FlowSolution_t")) {
    const auto location = tree.text(tree.child(solution.path, "GridLocation_t", true));
    const bool is_of_cells = location == "CellCenter";
    auto arrays = tree.children(solution.path, "DataArray_t");
    count_others(tree, solution.path, {"DataArray_t", "GridLocation_t"}, mesh.left_out);
    for (const auto& array : arrays) count_others(tree, array.path, {}, mesh.left_out);
    if (!is_of_cells && !location.empty() && location != "Vertex") {
      mesh.left_out["arrays of solutions at " + shown_text(location)] += std::ssize(arrays);
      continue;
    }
    auto& fields = is_of_cells ? mesh.cell_fields : mesh.node_fields;
    const auto n = is_of_cells ? sizes.n_cells : sizes.n_nodes;
    if (const auto n_others = std::erase_if(
            arrays, [&](const Node& array) { return !tree.has_data(array) || tree.n_values(array) != n; });
        n_others > 0)
      mesh.left_out["arrays of solutions of other sizes"] += static_cast<std::int64_t>(n_others);
    const auto add = [&](mesh::Field field) {
      if (std::none_of(fields.begin(), fields.end(), [&](const auto& other) { return other.name == field.name; }))
        fields.push_back(std::move(field));
      else
        ++mesh.left_out["arrays of solutions whose name another has"];
    };
    for (const auto& array : arrays) {
      const auto stem = array.name.substr(0, array.name.size() - 1);
      const std::vector<const Node*> parts{find(arrays, stem + "X"), find(arrays, stem + "Y"),
                                           find(arrays, stem + "Z")};
      const bool is_vector = !stem.empty() &&
                             std::string_view("XYZ").find(array.name.back()) != std::string_view::npos &&
                             std::all_of(parts.begin(), parts.end(),
                                         [&](const Node* part) { return part != nullptr && !tree.is_integer(*part); });
      if (!is_vector)
        add(field_of(tree, array));
      else if (array.name.back() == 'X')
        add(vector_of(tree, stem, parts));
    }
  }
}

}  // namespace pamr::io::cgns
