// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/export/write_boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string_view>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"
#include "pamr/geometry/triangulated/write_triangulation.hpp"
#include "pamr/io/export/surface_rows.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::io {

namespace {

bool is_vtp(const std::filesystem::path& file) { return geometry::is_same_word(file.extension().string(), ".vtp"); }

/// For each patch of the mesh whether it is to be written.
std::vector<bool> chosen_patches(const mesh::MeshInfo& info, const std::vector<std::string>& names) {
  std::vector<bool> chosen(info.patches.size(), names.empty());
  for (const auto& name : names)
    for (const int patch : mesh::require_patches(info.patches, name, "--patch")) chosen[at(patch)] = true;
  return chosen;
}

/// `with_inside`: those of faces inside as well, from the cell with the lower number.
SurfaceTriangles triangles_of(const mesh::DistMesh& mesh, const std::vector<bool>& chosen, bool with_inside) {
  const mesh::InnerPatches patches(mesh);
  SurfaceTriangles boundary{.all_cells = mesh.info.cell_ids()};
  boundary.fields = {{.name = "patch", .is_integer = true}, {.name = "cell", .is_integer = true}};
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (std::size_t face = 0; face < 4; ++face) {
      const mesh::CellFace here{cell, static_cast<int>(face)};
      const auto patch = patches.of_any(here);
      if (patch < 0 || at(patch) >= chosen.size() || !chosen[at(patch)]) continue;
      if (mesh.cell_to_cell[at(cell)][face] >= 0 && (!with_inside || !patches.is_first_side(here))) continue;
      const auto p = mesh.points(cell);
      const auto [a, b, c] = mesh::tet::face_to_corner[face];
      const auto id = mesh.cell_global[at(cell)];
      boundary.cell.push_back(id);
      boundary.corner.push_back({p[at(a)], p[at(b)], p[at(c)]});
      boundary.fields[0].value.push_back(patch);
      boundary.fields[1].value.push_back(static_cast<double>(id - mesh.info.first_id));
    }
  return boundary;
}

void write_plain(SharedOutput& out, geometry::SurfaceFormat format, const SurfaceTriangles& t,
                 const SurfacePoints& points, std::int64_t n_triangles) {
  out.append_once(geometry::surface_head(format, points.n, n_triangles));
  std::string text;
  geometry::append_points(text, format, points.own);
  out.append(std::string_view(text));
  text.clear();
  for (std::size_t i = 0; i < t.corner.size(); ++i)
    geometry::append_triangle(text, format, {points.number[3 * i], points.number[3 * i + 1], points.number[3 * i + 2]},
                              t.corner[i]);
  out.append(std::string_view(text));
  out.append_once(geometry::surface_end(format));
}

class VtpPrinter {
 public:
  explicit VtpPrinter(SharedOutput& out) : out_(out) {}

  /// An array; `print(out, i)` appends row `i` of this rank without the end of the line.
  template <class Print>
  void array(const char* type, const char* name, int n_components, std::size_t n_rows, Print&& print) {
    out_.append_once(fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n",
                                 type, name, n_components));
    std::string text;
    for (std::size_t i = 0; i < n_rows; ++i) {
      print(std::back_inserter(text), i);
      text += '\n';
    }
    out_.append(std::string_view(text));
    out_.append_once("</DataArray>\n");
  }

 private:
  SharedOutput& out_;
};

void write_vtp(const par::Comm& comm, SharedOutput& out, const SurfaceTriangles& t, const SurfacePoints& points,
               std::int64_t n_triangles) {
  VtpPrinter printer(out);
  const auto n_here = t.corner.size();
  out.append_once(fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n<Points>\n",
      points.n, n_triangles));
  printer.array("Float64", "Points", 3, points.own.size(), [&](auto to, std::size_t i) {
    fmt::format_to(to, "{} {} {}", points.own[i].x, points.own[i].y, points.own[i].z);
  });
  out.append_once("</Points>\n<Polys>\n");
  printer.array("Int64", "connectivity", 1, n_here, [&](auto to, std::size_t i) {
    fmt::format_to(to, "{} {} {}", points.number[3 * i], points.number[3 * i + 1], points.number[3 * i + 2]);
  });
  const auto first = comm.exclusive_sum(static_cast<std::int64_t>(n_here));
  printer.array("Int64", "offsets", 1, n_here, [&](auto to, std::size_t i) {
    fmt::format_to(to, "{}", 3 * (first + static_cast<std::int64_t>(i) + 1));
  });
  out.append_once("</Polys>\n<CellData Scalars=\"patch\">\n");
  for (const auto& field : t.fields)
    printer.array("Int64", field.name.c_str(), 1, n_here,
                  [&](auto to, std::size_t i) { fmt::format_to(to, "{}", static_cast<std::int64_t>(field.value[i])); });
  out.append_once("</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n");
}

}  // namespace

void write_boundary(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                    const std::vector<std::string>& patches) {
  const auto t = triangles_in_order(comm, triangles_of(mesh, chosen_patches(mesh.info, patches), !patches.empty()));
  const auto n_triangles = comm.sum(std::ssize(t.corner));
  if (n_triangles == 0) throw Error(file.string() + ": expected boundary triangles to write, found none");
  const auto points = shared_points(comm, t);
  if (std::max(points.n, n_triangles) > std::numeric_limits<std::int32_t>::max())
    throw Error(fmt::format("{}: expected fewer than 2^31 triangles and points, found {} and {}", file.string(),
                            n_triangles, points.n));
  SharedOutput out(comm, file);
  if (is_vtp(file))
    write_vtp(comm, out, t, points, n_triangles);
  else
    write_plain(out, geometry::surface_format_of(file), t, points, n_triangles);
  out.commit();
}

}  // namespace pamr::io
