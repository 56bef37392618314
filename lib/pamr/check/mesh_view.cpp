// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/mesh_view.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/check/metrics.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::check {

namespace {

constexpr std::size_t mean_ratio_place = 1;  // in `metric_names`

/// Rows of all ranks on rank 0, in the order of ranks. Collective.
template <class T>
std::vector<T> gather_on_first(const par::Comm& comm, const std::vector<T>& here) {
  par::Mailbox<T> box(comm);
  box.reserve(0, here.size());
  for (const auto& row : here) box.add(0, row);
  return box.send().item;
}

struct NodeRow {
  GlobalId name = 0, number = 0;
  geometry::Vec3 position;
};
struct CellRow {
  GlobalId cell = 0;
  std::array<GlobalId, 4> node{};  ///< names
};
struct FaceRow {
  GlobalId cell = 0;
  std::int64_t slot = 0, patch = 0;
  std::array<GlobalId, 3> node{};  ///< names
};

/// Places of rows in ascending order.
template <class Row, class Key>
std::vector<std::size_t> places_in_order(const std::vector<Row>& rows, Key key) {
  std::vector<std::size_t> place(rows.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  std::sort(place.begin(), place.end(), [&](std::size_t a, std::size_t b) { return key(rows[a]) < key(rows[b]); });
  return place;
}

template <class T>
std::vector<T> taken(const std::vector<T>& values, const std::vector<std::size_t>& place) {
  std::vector<T> result;
  result.reserve(place.size());
  for (const auto i : place) result.push_back(values[i]);
  return result;
}

/// The columns of all ranks on rank 0, rows taken from their places. Collective.
std::vector<ViewColumn> gather_columns(const par::Comm& comm, std::vector<ViewColumn> here,
                                       const std::vector<std::size_t>& place) {
  for (auto& column : here) {
    const auto all = gather_on_first(comm, column.value);
    column.value = comm.is_first() ? taken(all, place) : std::vector<double>{};
  }
  return here;
}

/// A field at some elements; the length of a vector.
ViewColumn column_of(const mesh::Field& field, std::span<const LocalId> elements) {
  const auto n = at(field.n_components);
  ViewColumn column{n > 1 ? "|" + field.name + "|" : field.name, field.unit, field.holds_integers() && n == 1, {}};
  column.value.reserve(elements.size());
  const auto value = [&](std::size_t i) {
    return field.holds_integers() ? static_cast<double>(field.integer()[i]) : field.real()[i];
  };
  for (const auto element : elements) {
    const auto first = at(element) * n;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += value(first + i) * value(first + i);
    column.value.push_back(n == 1 ? value(first) : std::sqrt(sum));
  }
  return column;
}

/// Level, mean ratio, whether it is a closure cell, then `own`, the fields, and the other shapes.
std::vector<ViewColumn> columns_of_cells(const mesh::DistMesh& mesh, std::span<const LocalId> cells,
                                         std::vector<ViewColumn> own) {
  std::vector<ViewColumn> shapes;
  for (const auto& name : metric_names())
    shapes.push_back({name, name.find("dihedral") != std::string::npos ? "degrees" : "", false, {}});
  ViewColumn level{"level", "", true, {}}, closure{"closure cell", "", true, {}};
  for (const auto cell : cells) {
    const auto values = cell_metrics(mesh.points(cell));
    for (std::size_t m = 0; m < values.size(); ++m) shapes[m].value.push_back(values[m]);
    level.value.push_back(mesh.lineage[at(cell)].level());
    closure.value.push_back(mesh.lineage[at(cell)].is_closure() ? 1 : 0);
  }
  std::vector<ViewColumn> columns{std::move(level), std::move(shapes[mean_ratio_place]), std::move(closure)};
  for (auto& column : own) columns.push_back(std::move(column));
  for (const auto& field : mesh.cell_fields) {
    columns.push_back(column_of(field, cells));
    auto& name = columns.back().name;
    const auto& shape = metric_names();
    if (name == "level" || std::find(shape.begin(), shape.end(), name) != shape.end()) name += " (field)";
  }
  for (std::size_t m = 0; m < shapes.size(); ++m)
    if (m != mean_ratio_place) columns.push_back(std::move(shapes[m]));
  return columns;
}

/// How far each face is off its patch's surface: the farthest corner, and the middle. 0 without a surface.
std::vector<ViewColumn> distances_of_faces(const mesh::DistMesh& mesh, const std::vector<BoundaryFace>& faces) {
  ViewColumn corners{"distance of nodes from surface", mesh.info.length_unit, false, {}};
  ViewColumn middle{"distance of middle from surface", mesh.info.length_unit, false, {}};
  for (const auto& face : faces) {
    const auto* surface = mesh.info.surface_of(face.patch);
    const auto points = mesh.points(face.cell);
    geometry::Vec3 sum{};
    double farthest = 0;
    for (const auto corner : mesh::tet::face_to_corner[at(face.slot)]) {
      sum = sum + points[at(corner)];
      if (surface != nullptr) farthest = std::max(farthest, surface->distance(points[at(corner)]));
    }
    corners.value.push_back(farthest);
    middle.value.push_back(surface == nullptr ? 0 : surface->distance((1.0 / 3) * sum));
  }
  return {std::move(corners), std::move(middle)};
}

/// A view under construction: nodes are known by their names until all are there.
class ViewGathering {
 public:
  ViewGathering(const par::Comm& comm, const mesh::DistMesh& mesh) : comm_(&comm), mesh_(&mesh) {}

  /// Collective. Nodes of cells are named by their numbers, since sections are not reduced.
  void add_cells(const std::vector<LocalId>& cells, ViewCells& view) {
    std::vector<CellRow> rows;
    for (const auto cell : cells) {
      CellRow row{mesh_->cell_global[at(cell)], {}};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto node = mesh_->cell_to_node[at(cell)][i];
        row.node[i] = add_node(node, mesh_->node_global[at(node)]);
      }
      rows.push_back(row);
    }
    const auto all = gather_on_first(*comm_, rows);
    const auto place = places_in_order(all, [](const CellRow& row) { return row.cell; });
    cells_ = taken(all, place);
    for (const auto& row : cells_) view.number.push_back(row.cell);
    view.columns = gather_columns(*comm_, columns_of_cells(*mesh_, cells, {}), place);
  }

  /// Collective.
  void add_faces(const std::vector<BoundaryFace>& faces, const NodeNames& names, ViewFaces& view) {
    std::vector<FaceRow> rows;
    std::vector<LocalId> cells;
    for (const auto& face : faces) {
      cells.push_back(face.cell);
      FaceRow row{mesh_->cell_global[at(face.cell)], face.slot, face.patch, {}};
      for (std::size_t i = 0; i < 3; ++i) {
        const auto node = mesh_->cell_to_node[at(face.cell)][at(mesh::tet::face_to_corner[at(face.slot)][i])];
        row.node[i] = add_node(node, names.name(*mesh_, node));
      }
      rows.push_back(row);
    }
    const auto all = gather_on_first(*comm_, rows);
    const auto place = places_in_order(all, [](const FaceRow& row) { return std::tuple(row.cell, row.slot); });
    faces_ = taken(all, place);
    for (const auto& row : faces_) {
      view.cell.push_back(row.cell);
      view.patch.push_back(row.patch);
    }
    view.columns = gather_columns(*comm_, columns_of_cells(*mesh_, cells, distances_of_faces(*mesh_, faces)), place);
  }

  /// Numbers the nodes; of those with the same name the one with the smallest number stands for all. Collective.
  void finish(MeshView& view) {
    std::sort(named_.begin(), named_.end());
    named_.erase(std::unique(named_.begin(), named_.end()), named_.end());
    std::vector<NodeRow> rows;
    std::vector<LocalId> nodes;
    for (const auto& [name, node] : named_) {
      rows.push_back({name, mesh_->node_global[at(node)], mesh_->point(node)});
      nodes.push_back(node);
    }
    const auto all = gather_on_first(*comm_, rows);
    auto place = places_in_order(all, [](const NodeRow& row) { return std::tuple(row.name, row.number); });
    const auto same = [&](std::size_t a, std::size_t b) { return all[a].name == all[b].name; };
    place.erase(std::unique(place.begin(), place.end(), same), place.end());
    std::vector<ViewColumn> columns;
    for (const auto& field : mesh_->node_fields) columns.push_back(column_of(field, nodes));
    view.nodes.columns = gather_columns(*comm_, std::move(columns), place);
    std::vector<GlobalId> name;
    for (const auto i : place) {
      name.push_back(all[i].name);
      view.nodes.number.push_back(all[i].number);
      view.nodes.position.push_back(all[i].position);
    }
    const auto index = [&](GlobalId wanted) {
      return static_cast<std::int64_t>(std::lower_bound(name.begin(), name.end(), wanted) - name.begin());
    };
    for (const auto& [cell, n] : cells_)
      view.cells.node.push_back({index(n[0]), index(n[1]), index(n[2]), index(n[3])});
    for (const auto& row : faces_)
      view.faces.node.push_back({index(row.node[0]), index(row.node[1]), index(row.node[2])});
  }

 private:
  GlobalId add_node(LocalId node, GlobalId name) {
    named_.emplace_back(name, node);
    return name;
  }

  const par::Comm* comm_;
  const mesh::DistMesh* mesh_;
  std::vector<std::pair<GlobalId, LocalId>> named_;
  std::vector<CellRow> cells_;
  std::vector<FaceRow> faces_;
};

}  // namespace

MeshView view_mesh(const par::Comm& comm, const mesh::DistMesh& mesh, double tolerance, const ViewLimits& limits) {
  MeshView view;
  view.box = view_box(comm, mesh);
  view.patches = mesh.info.patches;
  for (const auto& patch : mesh.info.patches) view.surface_of_patch.push_back(mesh.info.surface_name(patch));
  view.length_unit = mesh.info.length_unit;
  auto faces = boundary_faces(mesh);
  view.off_surface = find_off_surface_nodes(comm, mesh, faces, tolerance, limits.off_surface_nodes);
  const auto names = merge_nodes(comm, mesh, view.box, limits.faces, faces);
  view.nodes_are_merged = names.are_merged();
  view.worst = find_worst_cells(comm, mesh, limits.worst_cells);
  const auto selection = select_cells(comm, mesh, view.box, view.worst, limits);
  view.has_all_cells = selection.is_all;
  view.window = selection.window;
  ViewGathering gathering(comm, mesh);
  gathering.add_cells(selection.cell, view.cells);
  gathering.add_faces(faces, names, view.faces);
  gathering.finish(view);
  return view;
}

}  // namespace pamr::check
