// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: VTK file formats, "XML file formats", appended raw data with 64-bit headers.
#include "pamr/io/export/write_vtu.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"

namespace pamr::io {

namespace {

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
  static std::string escaped(const std::string& name) {
    std::string result;
    for (const char c : name)
      result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
    return result;
  }

  std::string text_;
  std::int64_t offset_ = 0;
};

void describe(Header& header, const mesh::Field& field, std::int64_t n) {
  header.array(field.holds_integers() ? "Int64" : "Float64", field.name, field.n_components,
               8 * n * field.n_components);
}

template <class T>
void append_array(SharedOutput& out, const std::vector<T>& part, std::int64_t n_bytes) {
  const auto size = static_cast<std::uint64_t>(n_bytes);
  out.append_once({reinterpret_cast<const char*>(&size), sizeof(size)});
  out.append(std::as_bytes(std::span<const T>(part)));
}

void append_field(SharedOutput& out, const mesh::Field& part, std::int64_t n) {
  std::visit([&](const auto& values) { append_array(out, values, 8 * n * part.n_components); }, part.value);
}

}  // namespace

void write_vtu(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh) {
  const auto n_nodes = mesh.info.n_global_nodes, n_cells = mesh.info.n_global_cells;
  Header header;
  header.line("<?xml version=\"1.0\"?>");
  header.line("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">");
  header.line(fmt::format("<UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", n_nodes, n_cells));
  header.line("<Points>");
  header.array("Float64", "Points", 3, 24 * n_nodes);
  header.line("</Points><Cells>");
  header.array("Int64", "connectivity", 1, 32 * n_cells);
  header.array("Int64", "offsets", 1, 8 * n_cells);
  header.array("UInt8", "types", 1, n_cells);
  header.line("</Cells><PointData>");
  for (const auto& field : mesh.node_fields) describe(header, field, n_nodes);
  header.line("</PointData><CellData>");
  for (const auto& field : mesh.cell_fields) describe(header, field, n_cells);
  header.line("</CellData>");
  header.line("</Piece></UnstructuredGrid>");

  SharedOutput out(comm, file);
  out.append_once(header.text() + "<AppendedData encoding=\"raw\">\n_");
  const auto rows = rows_in_order(comm, mesh);
  std::vector<std::int64_t> offsets;
  for (std::size_t c = 0; c < rows.cell_to_node.size(); ++c)
    offsets.push_back(4 * (rows.first_cell + static_cast<std::int64_t>(c) + 1));
  append_array(out, rows.position, 24 * n_nodes);
  append_array(out, rows.cell_to_node, 32 * n_cells);
  append_array(out, offsets, 8 * n_cells);
  append_array(out, std::vector<std::uint8_t>(offsets.size(), 10), n_cells);
  for (const auto& field : mesh.node_fields) append_field(out, nodes_in_order(comm, mesh, field), n_nodes);
  for (const auto& field : mesh.cell_fields) append_field(out, cells_in_order(comm, mesh, field), n_cells);
  out.append_once("\n</AppendedData></VTKFile>\n");
  out.commit();
}

}  // namespace pamr::io
