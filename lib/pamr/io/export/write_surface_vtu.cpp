// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/export/write_surface_vtu.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/export/surface_rows.hpp"
#include "pamr/io/shared_output.hpp"

namespace pamr::io {

namespace {

void require_sizes(const SurfaceTriangles& t, const SurfaceVtuOptions& options) {
  const auto n = t.cell.size();
  PAMR_EXPECTS(t.corner.size() == n);
  PAMR_EXPECTS(t.corner_fields.empty() || !options.shares_points);
  for (const auto& field : t.corner_fields) PAMR_EXPECTS(field.n_components == 1 && field.value.size() == 3 * n);
  for (const auto& field : t.fields) PAMR_EXPECTS(field.value.size() == n * at(field.n_components));
}

/// Prints this rank's part of each array, and what stands around them once.
class Printer {
 public:
  Printer(const par::Comm& comm, const std::filesystem::path& file) : out_(comm, file) {}

  void once(const std::string& text) { out_.append_once(text); }

  /// An array of `n_rows` rows here; `print(out, i)` appends row `i`, without the end of the line. The unit stands after
  /// the numbers, where scripts that take the text of the element do not meet it.
  template <class Print>
  void array(const char* type, const std::string& name, int n_components, std::size_t n_rows, Print&& print,
             const std::string& unit = {}) {
    once(fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type, name,
                     n_components));
    std::string text;
    for (std::size_t i = 0; i < n_rows; ++i) {
      print(std::back_inserter(text), i);
      text += '\n';
    }
    out_.append(std::string_view(text));
    if (!unit.empty())
      once(fmt::format("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>\n", unit));
    once("</DataArray>\n");
  }

  /// A field with `width` values in a line.
  void field(const SurfaceField& field, std::size_t width) {
    array(
        field.is_integer ? "Int64" : "Float64", field.name, field.n_components, field.value.size() / width,
        [&](auto out, std::size_t i) {
          for (std::size_t k = 0; k < width; ++k) {
            if (k > 0) fmt::format_to(out, " ");
            const double value = field.value[width * i + k];
            if (field.is_integer)
              fmt::format_to(out, "{}", std::llround(value));
            else
              fmt::format_to(out, "{:.9g}", value);
          }
        },
        field.unit);
  }

  void commit() { out_.commit(); }

 private:
  SharedOutput out_;
};

/// The opening tag of a section of fields.
std::string section(const char* name, const std::vector<SurfaceField>& fields, const SurfaceVtuOptions& options) {
  if (!options.names_scalars || fields.empty()) return fmt::format("<{}>\n", name);
  return fmt::format("<{} Scalars=\"{}\">\n", name, fields.front().name);
}

void print_points(Printer& printer, const SurfacePoints& points, int digits) {
  printer.once("<Points>\n");
  printer.array("Float64", "Points", 3, points.own.size(), [&](auto out, std::size_t i) {
    const auto& p = points.own[i];
    fmt::format_to(out, "{:.{}g} {:.{}g} {:.{}g}", p.x, digits, p.y, digits, p.z, digits);
  });
  printer.once("</Points>\n");
}

void print_triangles(Printer& printer, const SurfacePoints& points, std::int64_t first, bool shares_points) {
  const auto n_here = points.number.size() / 3;
  printer.once("<Cells>\n");
  // A blank ends the lines of shared points: these files keep the bytes that they have always had.
  const auto* end = shares_points ? " " : "";
  printer.array("Int64", "connectivity", 1, n_here, [&](auto out, std::size_t i) {
    const auto* n = &points.number[3 * i];
    fmt::format_to(out, "{} {} {}{}", n[0], n[1], n[2], end);
  });
  printer.array("Int64", "offsets", 1, n_here, [&](auto out, std::size_t i) {
    fmt::format_to(out, "{}", 3 * (first + static_cast<std::int64_t>(i) + 1));
  });
  constexpr int vtk_triangle = 5;
  printer.array("UInt8", "types", 1, n_here, [&](auto out, std::size_t) { fmt::format_to(out, "{}", vtk_triangle); });
  printer.once("</Cells>\n");
}

}  // namespace

void write_surface_vtu(const par::Comm& comm, const std::filesystem::path& file, const SurfaceTriangles& triangles,
                       const SurfaceVtuOptions& options) {
  require_sizes(triangles, options);
  const auto t = triangles_in_order(comm, triangles);
  const auto points = options.shares_points ? shared_points(comm, t) : points_of_their_own(comm, t);
  const auto n_here = std::ssize(t.cell);

  Printer printer(comm, file);
  printer.once(
      fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"{}>\n<UnstructuredGrid>\n"
                  "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                  options.attributes, points.n, comm.sum(n_here)));
  print_points(printer, points, options.coordinate_digits);
  print_triangles(printer, points, comm.exclusive_sum(n_here), options.shares_points);
  if (!t.corner_fields.empty()) {
    printer.once(section("PointData", t.corner_fields, options));
    for (const auto& field : t.corner_fields) printer.field(field, 3);
    printer.once("</PointData>\n");
  }
  printer.once(section("CellData", t.fields, options));
  for (const auto& field : t.fields) printer.field(field, at(field.n_components));
  printer.once("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  printer.commit();
}

}  // namespace pamr::io
