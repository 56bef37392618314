// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bind_mesh.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/element_remarks.hpp"
#include "pamr/io/foam/foam_order.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/partial_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/validate/validate.hpp"
#include "python/numpy_arrays.hpp"
#include "python/python_mesh.hpp"

namespace py = pybind11;

namespace pamr::python {

namespace {

using SharedMesh = std::shared_ptr<PythonMesh>;
/// Name, unit, values, storage type.
using FieldIn = std::tuple<std::string, std::string, py::array, int>;

/// From the address of a communicator's handle, which mpi4py tells. Collective.
std::shared_ptr<const par::Comm> comm_at(std::uintptr_t address) {
  MPI_Comm handle = MPI_COMM_NULL;
  std::memcpy(&handle, reinterpret_cast<const void*>(address), sizeof handle);
  return std::make_shared<const par::Comm>(handle);
}

std::vector<mesh::Field> fields_of(const std::vector<FieldIn>& all) {
  std::vector<mesh::Field> fields;
  for (const auto& [name, unit, values, storage] : all)
    fields.push_back(field_of(name, unit, values, static_cast<mesh::StorageType>(storage)));
  return fields;
}

/// Of a tag its name and kind, of a group that was left out its dimension and name; then a number.
using TagIn = std::tuple<std::int64_t, std::string, std::string>;
using GroupIn = std::tuple<int, std::string, std::int64_t>;
/// Numbers and names of groups.
using Groups = std::vector<std::pair<std::int64_t, std::string>>;

Groups groups_of(const std::vector<mesh::Group>& all) {
  Groups groups;
  for (const auto& group : all) groups.emplace_back(group.number, group.name);
  return groups;
}

/// Arguments of `Mesh._of_arrays` as arrays.
struct Given {
  Array<double> points;
  Array<std::int64_t> cells, triangles, tags;
  std::vector<TagIn> patches;
  std::vector<FieldIn> cell_fields, node_fields;
  std::string length_unit;
  std::vector<std::pair<std::int64_t, std::string>> regions;
  std::vector<GroupIn> unused;
  std::vector<std::tuple<int, std::int64_t, Groups>> joint;
  bool has_boundary = true, has_orientation = true;
};

MeshArrays to_arrays(const Given& given) {
  MeshArrays arrays;
  arrays.points = rows_of<geometry::Vec3>(given.points);
  arrays.cells = rows_of<std::array<GlobalId, 4>>(given.cells);
  arrays.triangles = rows_of<std::array<GlobalId, 3>>(given.triangles);
  arrays.tags = rows_of<std::int64_t>(given.tags);
  for (const auto& [tag, name, kind] : given.patches)
    arrays.patch_of_tag[tag] = {.name = name, .kind = kind, .number = std::max<std::int64_t>(tag, -1)};
  arrays.cell_fields = fields_of(given.cell_fields);
  arrays.node_fields = fields_of(given.node_fields);
  arrays.length_unit = given.length_unit;
  for (const auto& [number, name] : given.regions) arrays.regions.push_back({number, name});
  for (const auto& [dimension, name, n] : given.unused) arrays.unused_groups.push_back({dimension, name, n});
  for (const auto& [dimension, tag, groups] : given.joint)
    for (const auto& [number, name] : groups) arrays.joint[{dimension, tag}].push_back({number, name});
  arrays.has_boundary = given.has_boundary;
  arrays.has_orientation = given.has_orientation;
  return arrays;
}

std::tuple<SharedMesh, std::int64_t, std::vector<std::string>> from_arrays(std::uintptr_t comm, const Given& given,
                                                                           const std::string& source, int order,
                                                                           bool repair) {
  auto arrays = to_arrays(given);
  const py::gil_scoped_release released;
  auto made = mesh_from_arrays(comm_at(comm), std::move(arrays), source,
                               {.repair = repair, .order = static_cast<io::CellOrder>(order), .with_origin = true});
  return {std::move(made.mesh), made.n_turned, std::move(made.remarks)};
}

/// What elements of one type, by its name in meshio, are cut into: tetrahedra, four nodes each, or triangles, three each,
/// those of an element together.
Array<std::int64_t> cut_elements(const std::string& kind, const Array<std::int64_t>& given) {
  const int type = kind == "wedge"     ? io::element_type::prism
                   : kind == "pyramid" ? io::element_type::pyramid
                                       : io::element_type::quadrangle;
  const auto width = static_cast<std::size_t>(io::n_nodes_of_type(type));
  const std::span<const std::int64_t> all(given.data(), static_cast<std::size_t>(given.size()));
  std::vector<std::int64_t> flat;
  for (std::size_t begin = 0; begin + width <= all.size(); begin += width) {
    const auto nodes = all.subspan(begin, width);
    for (const auto& cell : io::tetrahedra_of(type, nodes)) flat.insert(flat.end(), cell.begin(), cell.end());
    for (const auto& face : io::triangles_of(type, nodes)) flat.insert(flat.end(), face.begin(), face.end());
  }
  return Array<std::int64_t>(static_cast<py::ssize_t>(flat.size()), flat.data());
}

/// Warnings and notes of a call, for `say` of Python.
using Said = std::pair<std::vector<std::string>, std::vector<std::string>>;

std::tuple<SharedMesh, std::vector<std::string>, std::vector<std::string>> read(std::uintptr_t address,
                                                                                const std::filesystem::path& file,
                                                                                bool repair, bool strict,
                                                                                bool split_prisms) {
  auto result = std::make_shared<PythonMesh>();
  result->comm = comm_at(address);
  const auto& comm = *result->comm;
  std::vector<std::string> remarks;
  const auto tell = [&](const std::string& text) {
    if (strict) throw Error(text);
    remarks.push_back(text);
  };
  const auto& format = io::format_to_read(file);
  auto read = format.read(comm, file, {.repair = repair && !strict, .split_prisms = split_prisms, .remark = tell});
  validate::require_valid(comm, read.mesh, file.string());
  if (strict) io::refuse_changes(read, io::source_of(file));
  std::vector<std::string> found;
  if (!format.is_native)
    found = remarks_on(comm, read);
  else if (auto text = io::remark_on_untagged(read); !text.empty())
    found.push_back(std::move(text));
  for (const auto& text : found) tell(io::source_of(file) + ": " + text);
  for (auto& note : read.notes) note = io::source_of(file) + ": " + note;
  result->mesh = std::move(read.mesh);
  return {result, remarks, read.notes};
}

/// Inner faces of a case's mesh that are not those of this one. Collective.
std::int64_t other_foam_faces(const PythonMesh& mesh, const std::filesystem::path& case_folder) {
  return io::count_other_faces(*mesh.comm, case_folder, mesh.mesh);
}

/// Yields what the format has no place for. Collective.
Said write_telling(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                   io::MeshWriteOptions options) {
  Said said;
  options.remark = [&](const std::string& text) { said.first.push_back(text); };
  options.note = [&](const std::string& text) { said.second.push_back(text); };
  io::write_mesh(comm, file, mesh, options);
  return said;
}

/// Likewise. Collective.
Said write(const PythonMesh& mesh, const std::filesystem::path& file, const std::string& provenance) {
  return write_telling(*mesh.comm, file, mesh.mesh, {.provenance = provenance});
}

std::vector<const mesh::Field*> reals_of_cells(const mesh::DistMesh& mesh) {
  std::vector<const mesh::Field*> reals;
  for (const auto& field : mesh.cell_fields)
    if (!field.holds_integers()) reals.push_back(&field);
  return reals;
}

/// Writes the mesh of an OpenFOAM case, which is a folder, coordinates times `scale`. Fields of reals on cells are not
/// lost: `write_fields` of Python writes them. Collective.
Said write_foam(const PythonMesh& mesh, const std::filesystem::path& case_folder, double scale) {
  if (scale == 1) return write_telling(*mesh.comm, case_folder, mesh.mesh, {.kept = reals_of_cells(mesh.mesh)});
  auto scaled = mesh.mesh;
  for (auto& p : scaled.node_position) p = scale * p;
  scaled.info.length_unit.clear();  // what it was no longer holds
  return write_telling(*mesh.comm, case_folder, scaled, {.kept = reals_of_cells(scaled)});
}

void require_valid(const PythonMesh& mesh, const std::string& what) {
  validate::require_valid(*mesh.comm, mesh.mesh, what);
}

/// Of each format of meshes its name, its endings, and whether it is read and written.
std::vector<std::tuple<std::string, std::vector<std::string>, bool, bool>> formats() {
  std::vector<std::tuple<std::string, std::vector<std::string>, bool, bool>> all;
  for (const auto& format : io::formats())
    all.emplace_back(format.name, std::vector<std::string>(format.endings.begin(), format.endings.end()),
                     format.read != nullptr, format.write != nullptr);
  return all;
}

SharedMesh kuhn_cube(std::uintptr_t address, int n) {
  auto result = std::make_shared<PythonMesh>();
  result->comm = comm_at(address);
  result->mesh = assemble::assemble(*result->comm, assemble::kuhn_cube(*result->comm, n));
  return result;
}

/// A property that shows an array of the mesh, n rows of `width` numbers (0: one dimension).
template <class T, class Get>
auto shown(Get get, py::ssize_t width) {
  return [get, width](py::object self) {
    const auto& values = get(self.cast<PythonMesh&>().mesh);
    using Row = typename std::remove_cvref_t<decltype(values)>::value_type;
    static_assert(sizeof(Row) % sizeof(T) == 0);
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size())};
    if (width > 0) shape.push_back(width);
    return show<T>(self, reinterpret_cast<const T*>(values.data()), shape, false);
  };
}

py::object get_field(const py::object& self, bool on_cells, const std::string& name) {
  const auto shared = self.cast<SharedMesh>();
  auto& mesh = shared->mesh;
  for (auto& field : on_cells ? mesh.cell_fields : mesh.node_fields) {
    if (field.name != name) continue;
    std::vector<py::ssize_t> shape{on_cells ? mesh.n_cells() : mesh.n_nodes()};
    if (field.n_components > 1) shape.push_back(field.n_components);
    const py::capsule owner(new std::shared_ptr<ShownField>(show_field(shared, on_cells, name)),
                            [](void* shown) { delete static_cast<std::shared_ptr<ShownField>*>(shown); });
    return std::visit([&](const auto& values) -> py::object { return show(owner, values.data(), shape, true); },
                      field.value);
  }
  return py::none();
}

std::vector<std::pair<std::string, std::string>> field_names(const PythonMesh& mesh, bool on_cells) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& field : on_cells ? mesh.mesh.cell_fields : mesh.mesh.node_fields)
    names.emplace_back(field.name, field.unit);
  return names;
}

/// Faces of the boundary: cell, face, patch, and the three nodes with the normal outwards.
py::tuple boundary_faces(const PythonMesh& mesh) {
  std::vector<std::int32_t> cell, slot, patch, nodes;
  for (LocalId c = 0; c < mesh.mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto neighbor = mesh.mesh.cell_to_cell[at(c)][at(f)];
      if (neighbor >= 0) continue;
      cell.push_back(c);
      slot.push_back(f);
      patch.push_back(mesh::slot_to_patch(neighbor));
      for (const auto corner : mesh::tet::face_to_corner[at(f)])
        nodes.push_back(mesh.mesh.cell_to_node[at(c)][at(corner)]);
    }
  const auto n = static_cast<py::ssize_t>(cell.size());
  return py::make_tuple(copy_out(cell), copy_out(slot), copy_out(patch), copy_out(nodes).reshape({n, py::ssize_t{3}}));
}

/// Faces inside with a patch, from each cell that has one: cell, face, patch, the three nodes with the normal out of the
/// cell, and whether this is the side of the cell with the lower number.
py::tuple inner_faces(const PythonMesh& mesh) {
  const mesh::InnerPatches patches(mesh.mesh);
  std::vector<std::int32_t> cell, slot, patch, nodes;
  std::vector<std::uint8_t> is_first;
  patches.for_each([&](mesh::CellFace face, int of_face) {
    cell.push_back(face.cell);
    slot.push_back(face.slot);
    patch.push_back(of_face);
    is_first.push_back(patches.is_first_side(face) ? 1 : 0);
    for (const auto corner : mesh::tet::face_to_corner[at(face.slot)])
      nodes.push_back(mesh.mesh.cell_to_node[at(face.cell)][at(corner)]);
  });
  const auto n = static_cast<py::ssize_t>(cell.size());
  return py::make_tuple(copy_out(cell), copy_out(slot), copy_out(patch), copy_out(nodes).reshape({n, py::ssize_t{3}}),
                        copy_out(is_first));
}

Array<std::uint8_t> levels(const PythonMesh& mesh) {
  std::vector<std::uint8_t> result;
  for (const auto lineage : mesh.mesh.lineage) result.push_back(static_cast<std::uint8_t>(lineage.level()));
  return copy_out(result);
}

void bind_arrays(py::class_<PythonMesh, SharedMesh>& type) {
  type.def_property_readonly("points", shown<double>(
                                           [](const auto& m) -> auto& { return m.node_position; }, 3));
  type.def_property_readonly("cells", shown<LocalId>(
                                          [](const auto& m) -> auto& { return m.cell_to_node; }, 4));
  type.def_property_readonly("cell_to_cell", shown<LocalId>(
                                                 [](const auto& m) -> auto& { return m.cell_to_cell; }, 4));
  type.def_property_readonly("node_numbers", shown<GlobalId>(
                                                 [](const auto& m) -> auto& { return m.node_global; }, 0));
  type.def_property_readonly("cell_numbers", shown<GlobalId>(
                                                 [](const auto& m) -> auto& { return m.cell_global; }, 0));
  type.def_property_readonly("ghost_numbers", shown<GlobalId>(
                                                  [](const auto& m) -> auto& { return m.ghost_global; }, 0));
  type.def_property_readonly("cell_origin", [](const py::object& self) {
    const auto& mesh = self.cast<PythonMesh&>().mesh;
    const auto& origin = mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin;
    return show(self, origin.data(), {static_cast<py::ssize_t>(origin.size())}, false);
  });
  type.def_property_readonly("node_origin", [](const py::object& self) {
    const auto& mesh = self.cast<PythonMesh&>();
    const auto& origin = mesh.node_origin.empty() ? mesh.mesh.node_global : mesh.node_origin;
    return show(self, origin.data(), {static_cast<py::ssize_t>(origin.size())}, false);
  });
  type.def_property_readonly("levels", levels);
  type.def("boundary_faces", boundary_faces);
  type.def("inner_faces", inner_faces);
  type.def("node_block", [](const PythonMesh& mesh) {
    const auto block = node_block(mesh);
    return Array<double>({static_cast<py::ssize_t>(block.size()), py::ssize_t{3}},
                         reinterpret_cast<const double*>(block.data()));
  });
}

}  // namespace

void bind_mesh(py::module_& module) {
  module.attr("untagged_kind") = mesh::untagged_kind;
  py::class_<PythonMesh, SharedMesh> type(module, "Mesh");
  bind_arrays(type);
  type.def_property_readonly("patches", [](const PythonMesh& mesh) {
    std::vector<std::tuple<std::string, std::string, std::string>> patches;
    for (const auto& patch : mesh.mesh.info.patches)
      patches.emplace_back(patch.name, patch.kind, mesh.mesh.info.surface_name(patch));
    return patches;
  });
  type.def_property_readonly("patch_numbers", [](const PythonMesh& mesh) {
    std::vector<std::int64_t> numbers;
    for (const auto& patch : mesh.mesh.info.patches) numbers.push_back(patch.number);
    return numbers;
  });
  type.def_property_readonly("patch_groups", [](const PythonMesh& mesh) {
    std::vector<Groups> groups;
    for (const auto& patch : mesh.mesh.info.patches) groups.push_back(groups_of(patch.groups));
    return groups;
  });
  type.def_property_readonly("region_groups", [](const PythonMesh& mesh) {
    std::vector<std::pair<std::int64_t, Groups>> groups;
    for (const auto& region : mesh.mesh.info.regions) groups.emplace_back(region.number, groups_of(region.groups));
    return groups;
  });
  type.def_property_readonly("regions", [](const PythonMesh& mesh) {
    std::vector<std::pair<std::int64_t, std::string>> regions;
    for (const auto& region : mesh.mesh.info.regions) regions.emplace_back(region.number, region.name);
    return regions;
  });
  type.def_property_readonly("n_cells", [](const PythonMesh& mesh) { return mesh.mesh.info.n_global_cells; });
  type.def_property_readonly("n_nodes", [](const PythonMesh& mesh) { return mesh.mesh.info.n_global_nodes; });
  type.def_property_readonly("length_unit", [](const PythonMesh& mesh) { return mesh.mesh.info.length_unit; });
  type.def("field_names", field_names);
  type.def("get_field", [](const py::object& self, bool on_cells, const std::string& name) {
    return get_field(self, on_cells, name);
  });
  type.def("put_field", [](PythonMesh& mesh, bool on_cells, const FieldIn& field) {
    const auto& [name, unit, values, storage] = field;
    put_field(mesh, on_cells, field_of(name, unit, values, static_cast<mesh::StorageType>(storage)));
  });
  type.def("remove_field", remove_field);
  type.def("write", write, py::call_guard<py::gil_scoped_release>());
  type.def("write_foam", write_foam, py::call_guard<py::gil_scoped_release>());
  type.def("require_valid", require_valid, py::call_guard<py::gil_scoped_release>());
  type.def("fingerprint", [](const PythonMesh& mesh) { return mesh::fingerprint(*mesh.comm, mesh.mesh); });
  module.def("formats", formats);
  py::class_<Given>(module, "Given")
      .def(py::init<>())
      .def_readwrite("points", &Given::points)
      .def_readwrite("cells", &Given::cells)
      .def_readwrite("triangles", &Given::triangles)
      .def_readwrite("tags", &Given::tags)
      .def_readwrite("patches", &Given::patches)
      .def_readwrite("cell_fields", &Given::cell_fields)
      .def_readwrite("node_fields", &Given::node_fields)
      .def_readwrite("length_unit", &Given::length_unit)
      .def_readwrite("regions", &Given::regions)
      .def_readwrite("unused", &Given::unused)
      .def_readwrite("joint", &Given::joint)
      .def_readwrite("has_boundary", &Given::has_boundary)
      .def_readwrite("has_orientation", &Given::has_orientation);
  module.def("from_arrays", from_arrays);
  module.def("cut_elements", cut_elements);
  module.def("read", read, py::call_guard<py::gil_scoped_release>());
  module.def("other_foam_faces", other_foam_faces, py::call_guard<py::gil_scoped_release>());
  module.def("tags_of_patches", [](const std::vector<std::string>& names, const std::vector<std::int64_t>& numbers) {
    return io::patch_numbers(names, "patch_", 0, numbers, 0);
  });
  module.def("write_complete",
             [](const std::string& path, const py::bytes& bytes) { io::write_complete(path, std::string(bytes)); });
  module.def("kuhn_cube", kuhn_cube, py::call_guard<py::gil_scoped_release>());
}

}  // namespace pamr::python
