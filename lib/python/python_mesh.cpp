// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/python_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::python {

namespace {

/// Rows that follow one another over the ranks, moved to canonical blocks. Collective.
template <class T>
void to_canonical(const par::Comm& comm, GlobalId n_all, std::vector<T>& rows, std::size_t width,
                  const std::vector<GlobalId>& ids) {
  rows = par::scatter_rows<T>(comm, n_all, rows, width, ids);
}

mesh::BlockMesh to_block(const par::Comm& comm, MeshArrays arrays) {
  mesh::BlockMesh block;
  const auto n_points = std::ssize(arrays.points), n_cells = std::ssize(arrays.cells);
  block.info.n_global_nodes = comm.sum(n_points);
  block.info.n_global_cells = comm.sum(n_cells);
  block.info.patches = std::move(arrays.patches);
  block.info.length_unit = std::move(arrays.length_unit);
  block.info.regions = std::move(arrays.regions);
  block.first_cell = comm.exclusive_sum(n_cells);
  block.cell_to_node = std::move(arrays.cells);
  block.boundary = std::move(arrays.boundary);
  block.cell_fields = std::move(arrays.cell_fields);
  std::vector<GlobalId> ids(arrays.points.size());
  std::iota(ids.begin(), ids.end(), comm.exclusive_sum(n_points));
  block.node_position = std::move(arrays.points);
  to_canonical(comm, block.info.n_global_nodes, block.node_position, 1, ids);
  for (auto& field : arrays.node_fields) {
    std::visit(
        [&](auto& values) {
          to_canonical(comm, block.info.n_global_nodes, values, static_cast<std::size_t>(field.n_components), ids);
        },
        field.value);
    block.node_fields.push_back(std::move(field));
  }
  return block;
}

using Fields = std::vector<mesh::Field>;
static_assert(std::is_nothrow_move_constructible_v<mesh::Field>, "else a longer list would copy what arrays show");

Fields& fields_of(PythonMesh& mesh, bool on_cells) { return on_cells ? mesh.mesh.cell_fields : mesh.mesh.node_fields; }

Fields::iterator find(Fields& fields, const std::string& name) {
  return std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.name == name; });
}

/// Moves the values of a field to the arrays that show them, or frees them where there are none.
void leave_to_arrays(PythonMesh& mesh, bool on_cells, mesh::Field& field) {
  const auto known = mesh.shown.extract({on_cells, field.name});
  if (known.empty()) return;
  const auto shown = known.mapped().lock();
  if (!shown) return;
  shown->values = std::move(field.value);
  shown->mesh.reset();
}

}  // namespace

std::pair<std::shared_ptr<PythonMesh>, std::int64_t> mesh_from_arrays(std::shared_ptr<const par::Comm> comm,
                                                                      MeshArrays arrays, Order order, bool repair) {
  auto block = to_block(*comm, std::move(arrays));
  const auto n_turned = assemble::orient(*comm, block, repair).n_turned;
  auto result = std::make_shared<PythonMesh>();
  std::vector<GlobalId> node_origin;
  if (order == Order::curve || (order == Order::automatic && !order::is_ordered(*comm, block))) {
    auto ordered = order::order_along_curve(*comm, std::move(block));
    block = std::move(ordered.block);
    block.cell_origin = std::move(ordered.cell_origin);
    node_origin = std::move(ordered.node_origin);
  }
  const bool is_ordered = comm->any(!node_origin.empty());
  result->mesh = assemble::assemble(*comm, std::move(block));
  validate::require_valid(*comm, result->mesh, "arrays");
  if (is_ordered)
    result->node_origin =
        par::fetch_rows<GlobalId>(*comm, result->mesh.info.node_ids(), node_origin, 1, result->mesh.node_global);
  result->comm = std::move(comm);
  return {std::move(result), n_turned};
}

std::shared_ptr<ShownField> show_field(const std::shared_ptr<PythonMesh>& mesh, bool on_cells,
                                       const std::string& name) {
  auto& known = mesh->shown[{on_cells, name}];
  auto shown = known.lock();
  if (shown) return shown;
  shown = std::make_shared<ShownField>();
  shown->mesh = mesh;
  known = shown;
  return shown;
}

void put_field(PythonMesh& mesh, bool on_cells, mesh::Field field) {
  mesh::require_level0_shape(field, on_cells);
  auto& fields = fields_of(mesh, on_cells);
  const auto old = find(fields, field.name);
  if (old == fields.end()) {
    fields.push_back(std::move(field));
    return;
  }
  leave_to_arrays(mesh, on_cells, *old);
  *old = std::move(field);
}

void remove_field(PythonMesh& mesh, bool on_cells, const std::string& name) {
  auto& fields = fields_of(mesh, on_cells);
  const auto old = find(fields, name);
  if (old == fields.end()) return;
  leave_to_arrays(mesh, on_cells, *old);
  fields.erase(old);
}

void unshare_field(PythonMesh& mesh, bool on_cells, const std::string& name) {
  auto& fields = fields_of(mesh, on_cells);
  const auto old = find(fields, name);
  if (old == fields.end()) return;
  auto values = old->value;
  leave_to_arrays(mesh, on_cells, *old);
  old->value = std::move(values);
}

std::vector<geometry::Vec3> node_block(const PythonMesh& mesh) {
  return par::scatter_rows<geometry::Vec3>(*mesh.comm, mesh.mesh.info.node_ids(), mesh.mesh.node_position, 1,
                                           mesh.mesh.node_global);
}

}  // namespace pamr::python
