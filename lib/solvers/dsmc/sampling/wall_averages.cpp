// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/wall_averages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "pamr/base/index.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

double error_of(double total, double squares, double blocks) {
  if (blocks < 2) return 0;
  const double mean = total / blocks;
  return std::sqrt(std::max(0.0, squares / blocks - mean * mean) / (blocks - 1)) * blocks;  // of the total
}

}  // namespace

void FaceTotals::add_block(const SurfaceTally::Sums& block, Vec3 normal) {
  const auto& m = block.momentum;
  const double push = normal.x * static_cast<double>(m[0]) + normal.y * static_cast<double>(m[1]) +
                      normal.z * static_cast<double>(m[2]);
  const double heat = static_cast<double>(block.energy);
  sums.add(block);
  heat_squares += heat * heat;
  pressure_squares += push * push;
}

std::vector<FaceRow> wall_averages(const par::Comm& comm, const GasDomain& domain,
                                   std::span<const BoundaryCondition> patch, std::span<const FaceTotals> totals,
                                   const WallScale& scale) {
  const double per_step = scale.fnum_per_time / scale.n_steps;
  std::vector<par::Outgoing<FaceRow>> messages{{0, {}}};
  for (std::size_t b = 0; b < domain.boundary.size(); ++b) {
    const auto& face = domain.boundary[b];
    if (!patch[at(face.patch)].is_wall()) continue;
    const auto& total = totals[b];
    const auto& m = total.sums.momentum;
    const double momentum = scale.momentum_unit * per_step / face.area;
    const double energy = scale.energy_unit * per_step / face.area;
    const Vec3 sum{static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
    const double push = dot(sum, face.normal), heat = static_cast<double>(total.sums.energy);
    FaceRow row;
    row.cell = domain.cell_global[at(face.cell)];
    row.slot = face.slot;
    row.patch = face.patch;
    row.corner = face.corner;
    row.area = face.area;
    row.pressure = momentum * push;
    row.pressure_error = momentum * error_of(push, total.pressure_squares, scale.n_blocks);
    row.shear = momentum * (sum - push * face.normal);
    row.heat = energy * heat;
    row.heat_error = energy * error_of(heat, total.heat_squares, scale.n_blocks);
    row.hits = static_cast<double>(total.sums.hits) / scale.n_steps;
    messages[0].item.push_back(row);
  }
  if (messages[0].item.empty()) messages.clear();
  auto faces = comm.sparse_exchange(messages).item;
  std::sort(faces.begin(), faces.end(),
            [](const auto& a, const auto& b) { return a.cell != b.cell ? a.cell < b.cell : a.slot < b.slot; });
  return faces;
}

std::string to_vtu(const std::vector<FaceRow>& faces, double unit) {
  const auto less = [](Vec3 a, Vec3 b) { return lexicographically_less(a, b); };
  std::map<Vec3, std::size_t, decltype(less)> number(less);
  std::string points, connectivity, offsets, types;
  for (const auto& face : faces) {
    for (const auto& p : face.corner) {
      const auto [found, is_new] = number.emplace(p, number.size());
      if (is_new) points += fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x / unit, p.y / unit, p.z / unit);
      connectivity += fmt::format("{} ", found->second);
    }
    connectivity += '\n';
  }
  for (std::size_t i = 1; i <= faces.size(); ++i) {
    offsets += fmt::format("{}\n", 3 * i);
    types += "5\n";
  }
  const auto array = [](const std::string& type, const std::string& name, int width, const std::string& values) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n{}</DataArray>\n", type, name,
        width, values);
  };
  const auto field = [&](const std::string& name, int width, const std::function<std::string(const FaceRow&)>& show) {
    std::string values;
    for (const auto& face : faces) values += show(face) + '\n';
    return array("Float64", name, width, values);
  };
  const auto number_of = [](double value) { return fmt::format("{:.9g}", value); };
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n";
  text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", number.size(), faces.size());
  text += "<Points>\n" + array("Float64", "Points", 3, points) + "</Points>\n<Cells>\n";
  text += array("Int64", "connectivity", 1, connectivity) + array("Int64", "offsets", 1, offsets);
  text += array("UInt8", "types", 1, types) + "</Cells>\n<CellData>\n";
  text += field("p", 1, [&](const FaceRow& f) { return number_of(f.pressure); });
  text += field("p_stderr", 1, [&](const FaceRow& f) { return number_of(f.pressure_error); });
  text += field("tau", 3,
                [&](const FaceRow& f) { return fmt::format("{:.9g} {:.9g} {:.9g}", f.shear.x, f.shear.y, f.shear.z); });
  text += field("q", 1, [&](const FaceRow& f) { return number_of(f.heat); });
  text += field("q_stderr", 1, [&](const FaceRow& f) { return number_of(f.heat_error); });
  text += field("hits", 1, [&](const FaceRow& f) { return number_of(f.hits); });
  text += field("patch", 1, [&](const FaceRow& f) { return fmt::format("{}", f.patch); });
  text += field("area", 1, [&](const FaceRow& f) { return number_of(f.area); });
  return text + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace pamr::dsmc
