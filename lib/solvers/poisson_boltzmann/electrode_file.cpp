// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/electrode_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

struct Row {
  GlobalId cell = 0;
  std::array<Vec3, 3> point;
  std::array<double, 3> psi{};
  double charge_density = 0;
  Vec3 stress;
  std::int64_t patch = 0;
};

Row row_of(const BoundaryFace& face, const Domain& domain, const Case& problem, const Conditions& conditions,
           const Solution& solution, const Analysis& analysis) {
  Row row;
  row.cell = domain.mesh->cell_global[static_cast<std::size_t>(face.cell)];
  row.patch = face.patch;
  const SourceTerm term(problem.linear);
  const auto profile = problem.profile();
  const Vec3 n = -face.normal;
  Vec3 field;
  double pressure = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(face.node[k]);
    row.point[k] = domain.mesh->node_position[i];
    row.psi[k] = analysis.psi[i];
    field = field + (1.0 / 3) * analysis.field[i];
    pressure += term.pressure(analysis.psi[i], 0) / 3;
    const double slope = problem.split ? face.normal.z * profile.slope(domain.point[i].z) : 0;
    if (conditions.fixed[i] != 0 && conditions.fixed_area[i] > 0)
      row.charge_density += (solution.reaction[i] / conditions.fixed_area[i] + slope) / 3;
    else
      row.charge_density += dot(analysis.field[i], n) / 3;
  }
  row.stress = dot(field, n) * field - (0.5 * squared_norm(field) + pressure) * n;
  return row;
}

/// Opens a DataArray, prints what `print` puts into it, and closes it.
template <class Print>
void array(std::string& text, const char* type, const char* name, int components, Print&& print) {
  auto out = std::back_inserter(text);
  fmt::format_to(out, "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type, name,
                 components);
  print(out);
  text += "</DataArray>\n";
}

std::string text_of(const std::vector<Row>& rows) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      3 * rows.size(), rows.size());
  text += "<Points>\n";
  array(text, "Float64", "Points", 3, [&](auto out) {
    for (const auto& row : rows)
      for (const auto& p : row.point) fmt::format_to(out, "{:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
  });
  text += "</Points>\n<Cells>\n";
  array(text, "Int64", "connectivity", 1, [&](auto out) {
    for (std::size_t i = 0; i < rows.size(); ++i) fmt::format_to(out, "{} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2);
  });
  array(text, "Int64", "offsets", 1, [&](auto out) {
    for (std::size_t i = 0; i < rows.size(); ++i) fmt::format_to(out, "{}\n", 3 * (i + 1));
  });
  array(text, "UInt8", "types", 1, [&](auto out) {
    for (std::size_t i = 0; i < rows.size(); ++i) fmt::format_to(out, "5\n");
  });
  text += "</Cells>\n<PointData Scalars=\"potential\">\n";
  array(text, "Float64", "potential", 1, [&](auto out) {
    for (const auto& row : rows) fmt::format_to(out, "{:.9g} {:.9g} {:.9g}\n", row.psi[0], row.psi[1], row.psi[2]);
  });
  text += "</PointData>\n<CellData Scalars=\"charge_density\">\n";
  array(text, "Float64", "charge_density", 1, [&](auto out) {
    for (const auto& row : rows) fmt::format_to(out, "{:.9g}\n", row.charge_density);
  });
  array(text, "Float64", "stress", 3, [&](auto out) {
    for (const auto& row : rows)
      fmt::format_to(out, "{:.9g} {:.9g} {:.9g}\n", row.stress.x, row.stress.y, row.stress.z);
  });
  array(text, "Int64", "patch", 1, [&](auto out) {
    for (const auto& row : rows) fmt::format_to(out, "{}\n", row.patch);
  });
  text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return text;
}

}  // namespace

std::string surface_text(const par::Comm& comm, const Domain& domain, const Case& problem, const Conditions& conditions,
                         const Solution& solution, const Analysis& analysis) {
  std::vector<par::Outgoing<Row>> message(1);
  message[0].to = 0;
  for (const auto& face : domain.faces)
    message[0].item.push_back(row_of(face, domain, problem, conditions, solution, analysis));
  auto rows = comm.sparse_exchange(message).item;
  if (!comm.is_first()) return {};
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.cell < b.cell; });
  return text_of(rows);
}

}  // namespace pamr::poisson_boltzmann
