// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/dist_mesh.hpp"

#include <algorithm>

namespace pamr::mesh {

namespace {

template <class Fields>
auto find_by_name(Fields& fields, std::string_view name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

std::size_t fields_bytes(const std::vector<Field>& fields) {
  std::size_t bytes = 0;
  for (const auto& field : fields)
    bytes += std::visit([](const auto& values) { return capacity_bytes(values); }, field.value);
  return bytes;
}

}  // namespace

const geometry::Surface* MeshInfo::surface_of(Exact<int> patch) const {
  return surfaces->get(patches[static_cast<std::size_t>(patch)].surface);
}

std::string MeshInfo::surface_name(const Patch& patch) const {
  return patch.surface < 0 ? std::string() : surfaces->name[static_cast<std::size_t>(patch.surface)];
}

const CellField* DistMesh::find_cell_field(std::string_view name) const { return find_by_name(cell_fields, name); }
CellField* DistMesh::find_cell_field(std::string_view name) { return find_by_name(cell_fields, name); }
const NodeField* DistMesh::find_node_field(std::string_view name) const { return find_by_name(node_fields, name); }

std::size_t bytes_at_rest(const DistMesh& m) {
  std::size_t bytes = 0;
  for (const auto& surface : m.info.surfaces->triangulations)
    bytes += capacity_bytes(surface->points) + capacity_bytes(surface->triangles);
  return bytes + capacity_bytes(m.node_position) + capacity_bytes(m.node_global) + capacity_bytes(m.cell_to_node) +
         capacity_bytes(m.cell_to_cell) + capacity_bytes(m.cell_global) + capacity_bytes(m.lineage) +
         capacity_bytes(m.cell_origin) + capacity_bytes(m.border_rank) + capacity_bytes(m.border_offset) +
         capacity_bytes(m.border_face) + capacity_bytes(m.ghost_global) + fields_bytes(m.node_fields) +
         fields_bytes(m.cell_fields);
}

}  // namespace pamr::mesh
