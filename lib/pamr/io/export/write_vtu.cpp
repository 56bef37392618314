// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: VTK file formats, "XML file formats", appended raw data with 64-bit headers.
#include "pamr/io/export/write_vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/io/export/exported_fields.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/io/vtk/vtk_grid.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

std::string escape_of(char c) {
  switch (c) {
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '&':
      return "&amp;";
    case '"':
      return "&quot;";
    default:
      return std::string(1, c);
  }
}

std::string escaped(const std::string& name) {
  std::string result;
  for (const char c : name) result += escape_of(c);
  return result;
}

/// The description of the arrays, with the place of each in the data that follow.
class Header {
 public:
  void array(const std::string& type, const std::string& name, int n_components, std::int64_t bytes) {
    const auto components = n_components == 1 ? std::string() : fmt::format(" NumberOfComponents=\"{}\"", n_components);
    text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n", type,
                         escaped(name), components, offset_);
    offset_ += bytes + 8;
  }
  void line(const std::string& text) { text_ += text + "\n"; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::int64_t offset_ = 0;
};

void describe(Header& header, const mesh::Field& field, std::int64_t n) {
  header.array(field.holds_integers() ? "Int64" : "Float64", field.name, field.n_components,
               8 * n * field.n_components);
}

/// The triangles of this rank's block of cells on the boundary, outward, with the row of their cell in the block.
struct Boundary {
  std::vector<std::array<GlobalId, 3>> corner;
  std::vector<std::array<GlobalId, 3>> mid;  ///< of edges 0-1, 1-2 and 2-0; of second order only
  std::vector<std::size_t> owner;
  std::vector<std::int32_t> patch;
};

Boundary boundary_of(const RowsInOrder& rows) {
  Boundary result;
  for (std::size_t c = 0; c < rows.group.size(); ++c)
    for (std::size_t face = 0; face < 4; ++face) {
      if (rows.group[c][face] < 0) continue;
      auto& corner = result.corner.emplace_back();
      const auto& slot = mesh::tet::face_to_corner[face];
      for (std::size_t k = 0; k < 3; ++k) corner[k] = rows.cell_to_node[c][at(slot[k])];
      if (!rows.cell_to_mid.empty())
        result.mid.push_back(
            {rows.mid(c, slot[0], slot[1]), rows.mid(c, slot[1], slot[2]), rows.mid(c, slot[2], slot[0])});
      result.owner.push_back(c);
      result.patch.push_back(rows.group[c][face]);
    }
  return result;
}

bool has_field(const mesh::DistMesh& mesh, const std::string& name) { return mesh.find_cell_field(name) != nullptr; }

/// What viewers see and the mesh has no fields for, where no field has the name. The types tell these arrays from
/// fields when the file is read: `read_vtu` leaves them out.
struct Extra {
  bool has_level = false, has_ratio = false;
  mesh::CellField level{mesh::level_field, "", 1, mesh::StorageType::uint8, std::vector<std::int64_t>()};
  mesh::CellField ratio{"mean_ratio", "", 1, mesh::StorageType::float32, std::vector<double>()};
};

Extra extra_of(const mesh::DistMesh& mesh) {
  Extra extra;
  extra.has_level = !has_field(mesh, extra.level.name);
  extra.has_ratio = !has_field(mesh, extra.ratio.name);
  for (const auto lineage : mesh.lineage) extra.level.integer().push_back(lineage.level());
  for (LocalId c = 0; c < mesh.n_cells(); ++c) extra.ratio.real().push_back(geometry::mean_ratio(mesh.points(c)));
  return extra;
}

void append_size(SharedOutput& out, std::int64_t n_bytes) {
  const auto size = static_cast<std::uint64_t>(n_bytes);
  out.append_once({reinterpret_cast<const char*>(&size), sizeof(size)});
}

template <class T>
void append_values(SharedOutput& out, const std::vector<T>& part) {
  out.append(std::as_bytes(std::span<const T>(part)));
}

template <class T>
void append_array(SharedOutput& out, const std::vector<T>& part, std::int64_t n_bytes) {
  append_size(out, n_bytes);
  append_values(out, part);
}

void append_node_field(SharedOutput& out, const mesh::Field& part, std::int64_t n) {
  std::visit([&](const auto& values) { append_array(out, values, 8 * n * part.n_components); }, part.value);
}

/// The values of the cells, then for each triangle those of its cell.
template <class T>
void append_of_cells(SharedOutput& out, const std::vector<T>& values, std::size_t width, const Boundary& boundary,
                     std::int64_t n) {
  append_size(out, static_cast<std::int64_t>(sizeof(T) * width) * n);
  append_values(out, values);
  std::vector<T> of_triangles;
  of_triangles.reserve(boundary.owner.size() * width);
  for (const auto owner : boundary.owner)
    for (std::size_t k = 0; k < width; ++k) of_triangles.push_back(values[owner * width + k]);
  append_values(out, of_triangles);
}

void append_cell_field(SharedOutput& out, const mesh::Field& part, const Boundary& boundary, std::int64_t n) {
  std::visit([&](const auto& values) { append_of_cells(out, values, at(part.n_components), boundary, n); }, part.value);
}

template <class T, class Wide>
std::vector<T> narrowed(const std::vector<Wide>& values) {
  std::vector<T> result;
  result.reserve(values.size());
  for (const auto value : values) result.push_back(static_cast<T>(value));
  return result;
}

/// What VTK calls cells and triangles of an order, and how many nodes they have.
struct Shapes {
  std::int64_t cell_nodes, triangle_nodes;
  std::uint8_t cell_type, triangle_type;
};
constexpr Shapes first_order{4, 3, 10, 5};
constexpr Shapes second_order_shapes{10, 6, 24, 22};

/// Corners, then mid-edge nodes; VTK lists those of a tetrahedron by its edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3.
std::vector<std::array<GlobalId, 10>> quadratic_cells(const RowsInOrder& rows) {
  std::vector<std::array<GlobalId, 10>> cells;
  cells.reserve(rows.cell_to_node.size());
  for (std::size_t c = 0; c < rows.cell_to_node.size(); ++c) {
    const auto& n = rows.cell_to_node[c];
    cells.push_back({n[0], n[1], n[2], n[3], rows.mid(c, 0, 1), rows.mid(c, 1, 2), rows.mid(c, 2, 0), rows.mid(c, 0, 3),
                     rows.mid(c, 1, 3), rows.mid(c, 2, 3)});
  }
  return cells;
}

std::vector<std::array<GlobalId, 6>> quadratic_triangles(const Boundary& boundary) {
  std::vector<std::array<GlobalId, 6>> triangles;
  triangles.reserve(boundary.corner.size());
  for (std::size_t t = 0; t < boundary.corner.size(); ++t) {
    const auto &n = boundary.corner[t], &m = boundary.mid[t];
    triangles.push_back({n[0], n[1], n[2], m[0], m[1], m[2]});
  }
  return triangles;
}

/// Connectivity, offsets and types of the cells, then of the triangles.
void append_cells(SharedOutput& out, const RowsInOrder& rows, const Boundary& boundary, const Shapes& shapes,
                  std::int64_t first_triangle, std::int64_t n_cells, std::int64_t n_triangles) {
  const auto [cell_nodes, triangle_nodes, cell_type, triangle_type] = shapes;
  append_size(out, 8 * (cell_nodes * n_cells + triangle_nodes * n_triangles));
  if (cell_nodes == first_order.cell_nodes) {
    append_values(out, rows.cell_to_node);
    append_values(out, boundary.corner);
  } else {
    append_values(out, quadratic_cells(rows));
    append_values(out, quadratic_triangles(boundary));
  }
  std::vector<std::int64_t> of_cells, of_triangles;
  for (std::size_t c = 0; c < rows.cell_to_node.size(); ++c)
    of_cells.push_back(cell_nodes * (rows.first_cell + static_cast<std::int64_t>(c) + 1));
  for (std::size_t t = 0; t < boundary.corner.size(); ++t)
    of_triangles.push_back(cell_nodes * n_cells + triangle_nodes * (first_triangle + static_cast<std::int64_t>(t) + 1));
  append_size(out, 8 * (n_cells + n_triangles));
  append_values(out, of_cells);
  append_values(out, of_triangles);
  append_size(out, n_cells + n_triangles);
  append_values(out, std::vector(of_cells.size(), cell_type));
  append_values(out, std::vector(of_triangles.size(), triangle_type));
}

}  // namespace

void write_vtu(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
               const mesh::SecondOrder* second_order) {
  const auto rows = rows_in_order(comm, mesh, second_order, Interfaces::patches);
  const auto& shapes = second_order == nullptr ? first_order : second_order_shapes;
  const auto node_fields = exported_fields(second_order == nullptr ? mesh.node_fields : second_order->node_fields);
  const auto cell_fields = exported_fields(mesh.cell_fields);
  const auto boundary = boundary_of(rows);
  const auto n_triangles_here = std::ssize(boundary.corner);
  const auto n_triangles = comm.sum(n_triangles_here), first_triangle = comm.exclusive_sum(n_triangles_here);
  const auto n_nodes = rows.n_nodes, n_cells = mesh.info.n_global_cells, n_all = n_cells + n_triangles;
  const auto extra = extra_of(mesh);
  const std::string patch = has_field(mesh, "patch") ? "boundary_patch" : "patch";

  Header header;
  header.line("<?xml version=\"1.0\"?>");
  header.line("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">");
  header.line("<UnstructuredGrid>");
  header.line("<FieldData>");  // names as names: readers other than VTK's stumble over arrays of text
  for (std::size_t p = 0; p < mesh.info.patches.size(); ++p)
    header.line(
        fmt::format("<DataArray type=\"Int32\" Name=\"{}{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>",
                    mesh::is_untagged(mesh.info.patches[p]) ? vtk::before_untagged : vtk::before_patch,
                    escaped(mesh.info.patches[p].name), p));
  header.line("</FieldData>");
  header.line(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", n_nodes, n_all));
  header.line("<Points>");
  header.array("Float64", "Points", 3, 24 * n_nodes);
  header.line("</Points><Cells>");
  header.array("Int64", "connectivity", 1, 8 * (shapes.cell_nodes * n_cells + shapes.triangle_nodes * n_triangles));
  header.array("Int64", "offsets", 1, 8 * n_all);
  header.array("UInt8", "types", 1, n_all);
  header.line("</Cells><PointData>");
  for (const auto* field : node_fields) describe(header, *field, n_nodes);
  header.line("</PointData><CellData>");
  for (const auto* field : cell_fields) describe(header, *field, n_all);
  if (extra.has_level) header.array("UInt8", extra.level.name, 1, n_all);
  if (extra.has_ratio) header.array("Float32", extra.ratio.name, 1, 4 * n_all);
  header.array("Int32", patch, 1, 4 * n_all);
  header.line("</CellData>");
  header.line("</Piece></UnstructuredGrid>");

  SharedOutput out(comm, file);
  out.append_once(header.text() + "<AppendedData encoding=\"raw\">\n_");
  append_array(out, rows.position, 24 * n_nodes);
  append_cells(out, rows, boundary, shapes, first_triangle, n_cells, n_triangles);
  for (const auto* field : node_fields)
    append_node_field(out,
                      second_order == nullptr ? nodes_in_order(comm, mesh, *field)
                                              : nodes_in_order(comm, mesh, *second_order, *field),
                      n_nodes);
  const auto in_order = [&](const mesh::CellField& field) { return cells_in_order(comm, mesh, field); };
  for (const auto* field : cell_fields) append_cell_field(out, in_order(*field), boundary, n_all);
  if (extra.has_level)
    append_of_cells(out, narrowed<std::uint8_t>(in_order(extra.level).integer()), 1, boundary, n_all);
  if (extra.has_ratio) append_of_cells(out, narrowed<float>(in_order(extra.ratio).real()), 1, boundary, n_all);
  append_size(out, 4 * n_all);
  append_values(out, std::vector<std::int32_t>(rows.cell_to_node.size(), -1));
  append_values(out, boundary.patch);
  out.append_once("\n</AppendedData></VTKFile>\n");
  out.commit();
}

}  // namespace pamr::io
