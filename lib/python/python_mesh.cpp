// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/python_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "pamr/check/tears.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/element_remarks.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::python {

namespace {

io::ElementParts to_parts(const par::Comm& comm, MeshArrays arrays) {
  io::ElementParts parts;
  parts.n_nodes = comm.sum(std::ssize(arrays.points));
  parts.n_elements = comm.sum(std::ssize(arrays.cells));
  parts.has_regions = false;
  std::vector<GlobalId> ids(arrays.points.size());
  std::iota(ids.begin(), ids.end(), comm.exclusive_sum(std::ssize(arrays.points)));
  const auto to_canonical = [&](auto& rows, std::size_t width) {
    using T = typename std::remove_cvref_t<decltype(rows)>::value_type;
    rows = par::scatter_rows<T>(comm, parts.n_nodes, rows, width, ids);
  };
  parts.position = std::move(arrays.points);
  to_canonical(parts.position, 1);
  parts.node_tag.resize(parts.position.size());
  std::iota(parts.node_tag.begin(), parts.node_tag.end(),
            par::block_range(parts.n_nodes, comm.rank(), comm.size()).begin);
  for (const auto& corners : arrays.cells) parts.tetrahedron.push_back({corners, 0});
  for (std::size_t t = 0; t < arrays.triangles.size(); ++t)
    parts.triangle.push_back({arrays.triangles[t], arrays.tags[t]});
  for (const auto& [tag, groups] : arrays.joint)
    for (const auto& group : groups) parts.joint[tag].insert(group.number);
  for (const auto& [tag, patch] : arrays.patch_of_tag) parts.group_name[{2, tag}] = patch.name;
  for (const auto& region : arrays.regions) parts.group_name[{3, region.number}] = region.name;
  parts.cell_fields = std::move(arrays.cell_fields);
  parts.node_fields = std::move(arrays.node_fields);
  for (auto& field : parts.node_fields)
    std::visit([&](auto& values) { to_canonical(values, static_cast<std::size_t>(field.n_components)); }, field.value);
  return parts;
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

MadeMesh mesh_from_arrays(std::shared_ptr<const par::Comm> comm, MeshArrays arrays, const std::string& source,
                          const io::ElementOptions& options) {
  MadeMesh made{std::make_shared<PythonMesh>(), 0, {}};
  auto patch_of_tag = arrays.patch_of_tag;
  const auto joint = arrays.joint;
  for (const auto& [tag, groups] : joint)
    if (const auto found = patch_of_tag.find(tag.second); tag.first == 2 && found != patch_of_tag.end()) {
      found->second.groups = groups;
      found->second.number = -1;
    }
  const auto unused = arrays.unused_groups;
  const bool has_boundary = comm->any(arrays.has_boundary), has_orientation = arrays.has_orientation;
  const auto length_unit = arrays.length_unit;
  auto read = io::mesh_of_elements(*comm, to_parts(*comm, std::move(arrays)), source, options,
                                   [&](std::int64_t tag) { return patch_of_tag.at(tag); });
  for (auto& region : read.mesh.info.regions)
    if (const auto found = joint.find({3, region.number}); found != joint.end()) region.groups = found->second;
  read.mesh.info.length_unit = length_unit;
  validate::require_valid(*comm, read.mesh, source);
  if (!has_boundary) read.n_untagged_faces = 0;
  read.unused_groups.insert(read.unused_groups.begin(), unused.begin(), unused.end());
  made.n_turned = read.n_turned;
  if (!has_orientation) read.n_turned = 0;
  made.remarks = remarks_on(*comm, read);
  made.mesh->node_origin = std::move(read.node_origin);
  made.mesh->mesh = std::move(read.mesh);
  made.mesh->comm = std::move(comm);
  return made;
}

std::vector<std::string> remarks_on(const par::Comm& comm, const io::ElementMesh& read) {
  auto remarks = io::remarks_of(read);
  for (auto& text : check::remarks_of(check::find_tears(comm, read.mesh))) remarks.push_back(std::move(text));
  return remarks;
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
  mesh::require_level0_field(field, on_cells, mesh.mesh.info.level0 != nullptr);
  if (on_cells) mesh::require_inner_patches(field, mesh.mesh.info.patches.size());
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
