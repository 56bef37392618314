// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/put_back.hpp"

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "pamr/adapt/part/join_part.hpp"
#include "pamr/adapt/part/mesh_part.hpp"
#include "pamr/adapt/part/part_runs.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::adapt {

namespace {

/// Makes an array longer; where it has no room for that, in large pages.
template <class T>
void lengthen(std::vector<T>& array, std::size_t n) {
  if (n > array.capacity()) {
    std::vector<T> longer;
    reserve_array(longer, n);
    longer.assign(array.begin(), array.end());
    array = std::move(longer);
  }
  array.resize(std::max(n, array.size()));
}

/// Moves the rows of the runs of the whole mesh to their new places, each changed by `change(run, row)`, `width` items
/// a row. Runs that go back are moved first, in ascending order, then those that go on, in descending order: so no row
/// is overwritten before it is moved.
template <class T, class Change>
void move_rows(const PartRuns& runs, std::size_t width, std::vector<T>& rows, Change&& change) {
  lengthen(rows, at(runs.n_cells()) * width);
  const auto& all = runs.all();
  for (const auto& run : all) {
    if (!run.is_of_whole || run.to > run.from) continue;
    for (auto i = at(run.from) * width, j = at(run.to) * width; i < at(run.from + run.count) * width; ++i, ++j)
      rows[j] = change(run, rows[i]);
  }
  for (auto run = all.rbegin(); run != all.rend(); ++run) {
    if (!run->is_of_whole || run->to <= run->from) continue;
    for (auto i = at(run->from + run->count) * width, j = at(run->to + run->count) * width;
         i > at(run->from) * width;) {
      --i;
      --j;
      rows[j] = change(*run, rows[i]);
    }
  }
}

/// Puts the rows of the part into their places, and ends the array after the last.
template <class T>
void fill_rows(const PartRuns& runs, std::size_t width, const std::vector<T>& of_part, std::vector<T>& rows) {
  for (std::size_t i = 0; i < of_part.size(); ++i)
    rows[at(runs.place_of_before(static_cast<LocalId>(i / width))) * width + i % width] = of_part[i];
  rows.resize(at(runs.n_cells()) * width);
}

template <class T>
void join_rows(const PartRuns& runs, std::size_t width, const std::vector<T>& of_part, std::vector<T>& rows) {
  move_rows(runs, width, rows, [](const Run&, const T& row) { return row; });
  fill_rows(runs, width, of_part, rows);
}

template <class T>
void append_rows(const std::vector<T>& of_part, std::size_t n_old, std::vector<T>& rows) {
  const auto n = rows.size();
  lengthen(rows, n + of_part.size() - n_old);
  std::copy(of_part.begin() + static_cast<std::ptrdiff_t>(n_old), of_part.end(),
            rows.begin() + static_cast<std::ptrdiff_t>(n));
}

void move_links(const PartRuns& runs, mesh::DistMesh& mesh) {
  move_rows(runs, 1, mesh.cell_to_cell,
            [&](const Run& run, const mesh::CellNeighbors& links) { return links_of_whole(runs, mesh, run, links); });
}

/// The fields that the part has: of nodes its new ones, of cells all its own.
void join_fields(const PartRuns& runs, const MeshPart& part, std::size_t n_nodes_before, mesh::DistMesh& mesh) {
  const auto take = [](std::vector<mesh::Field>& fields, const std::string& name) {
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.name == name; });
    return found == fields.end() ? decltype(mesh::Field::value)() : std::move(found->value);
  };
  std::vector<mesh::NodeField> of_nodes;
  for (const auto& field : part.mesh.node_fields) {
    auto& joined = of_nodes.emplace_back(field);
    const auto width = at(field.n_components);
    std::visit(
        [&](const auto& of_part) {
          using Values = std::remove_cvref_t<decltype(of_part)>;
          auto before = take(mesh.node_fields, field.name);
          Values values = std::holds_alternative<Values>(before) ? std::get<Values>(std::move(before)) : Values{};
          values.resize(n_nodes_before * width);  // 0 where the whole mesh did not have the field
          append_rows(of_part, part.whole_node.size() * width, values);
          joined.value = std::move(values);
        },
        field.value);
  }
  mesh.node_fields = std::move(of_nodes);
  std::vector<mesh::CellField> of_cells;
  for (const auto& field : part.mesh.cell_fields) {
    auto& joined = of_cells.emplace_back(field);
    std::visit(
        [&](const auto& of_part) {
          using Values = std::remove_cvref_t<decltype(of_part)>;
          auto values = std::get<Values>(take(mesh.cell_fields, field.name));
          join_rows(runs, at(field.n_components), of_part, values);
          joined.value = std::move(values);
        },
        field.value);
  }
  mesh.cell_fields = std::move(of_cells);
}

std::vector<mesh::CellNodes> nodes_of_part(const MeshPart& part, LocalId n_nodes_before) {
  const auto n_old = static_cast<LocalId>(part.whole_node.size());
  auto cells = part.mesh.cell_to_node;
  for (auto& corners : cells)
    for (auto& node : corners) node = node < n_old ? part.whole_node[at(node)] : n_nodes_before + node - n_old;
  return cells;
}

}  // namespace

PutBack put_back(const par::Comm& comm, PartTarget into, const MeshPart& part, Coverage& coverage,
                 bool with_whole_cells) {
  auto& mesh = into.mesh;
  const auto& whole = into.cells;
  cover_all(coverage);
  const PartRuns runs(part, coverage);
  PutBack result;
  result.requests = runs.join<std::uint8_t>(whole.requests, part.requests);
  result.known = {runs.join<refine::EdgeMask>(whole.closure.marks, part.known.marks), join_plans(runs, whole, part)};
  if (with_whole_cells) result.whole_cell = cells_of_whole(runs, part);

  // what is read of the whole mesh, before it is changed
  const auto n_nodes_before = mesh.n_nodes();
  const auto corners = nodes_of_part(part, n_nodes_before);
  std::vector<mesh::CellNeighbors> links;
  for (LocalId c = 0; c < part.mesh.n_cells(); ++c) links.push_back(links_of_part(runs, mesh, part, c));
  auto border = join_border_faces(runs, mesh, part, std::vector<std::uint8_t>(mesh.border_face.size(), 1));
  std::vector<GlobalId> numbers;
  const auto n_global = number_in_order(comm, runs, mesh, part, numbers);

  move_links(runs, mesh);
  fill_rows(runs, 1, links, mesh.cell_to_cell);
  if (mesh.cell_origin.empty()) mesh.cell_origin = std::move(mesh.cell_global);
  mesh.cell_global = std::move(numbers);
  join_rows(runs, 1, part.mesh.cell_origin, mesh.cell_origin);
  join_rows(runs, 1, corners, mesh.cell_to_node);
  join_rows(runs, 1, part.mesh.lineage, mesh.lineage);
  append_rows(part.mesh.node_position, part.whole_node.size(), mesh.node_position);
  append_rows(part.mesh.node_global, part.whole_node.size(), mesh.node_global);
  if (part.is_cut) {
    join_fields(runs, part, at(n_nodes_before), mesh);
    mesh.info = part.mesh.info;
  }
  mesh.info.n_global_cells = n_global;
  mesh.border_rank = std::move(border.border_rank);
  mesh.border_offset = std::move(border.border_offset);
  mesh.border_face = std::move(border.border_face);
  for (LocalId k = 0; const auto face : mesh.border_face)
    mesh.cell_to_cell[at(face.cell)][at(face.slot)] = runs.n_cells() + k++;
  mesh.ghost_global = numbers_behind_border(comm, mesh);
  result.mesh = std::move(mesh);
  return result;
}

mesh::DistMesh copy_without_fields(const mesh::DistMesh& mesh, std::size_t n_cells, std::size_t n_nodes) {
  mesh::DistMesh copy;
  copy.info = mesh.info;
  copy.node_position = copy_array(mesh.node_position, n_nodes);
  copy.node_global = copy_array(mesh.node_global, n_nodes);
  copy.cell_to_node = copy_array(mesh.cell_to_node, n_cells);
  copy.cell_to_cell = copy_array(mesh.cell_to_cell, n_cells);
  copy.cell_global = copy_array(mesh.cell_global, n_cells);
  copy.lineage = copy_array(mesh.lineage, n_cells);
  copy.cell_origin = mesh.cell_origin;
  copy.border_rank = mesh.border_rank;
  copy.border_offset = mesh.border_offset;
  copy.border_face = mesh.border_face;
  copy.ghost_global = mesh.ghost_global;
  return copy;
}

mesh::DistMesh copy_with_room(const mesh::DistMesh& mesh, std::size_t n_cells, std::size_t n_nodes) {
  auto copy = copy_without_fields(mesh, n_cells, n_nodes);
  copy.node_fields = mesh.node_fields;
  copy.cell_fields = mesh.cell_fields;
  return copy;
}

}  // namespace pamr::adapt
