// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/wall_averages.hpp"

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/io/export/write_surface_vtu.hpp"

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

std::vector<FaceRow> wall_averages(const GasDomain& domain, std::span<const BoundaryCondition> patch,
                                   std::span<const FaceTotals> totals, const WallScale& scale) {
  const double per_step = scale.fnum_per_time / scale.n_steps;
  std::vector<FaceRow> rows;
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
    rows.push_back(row);
  }
  return rows;
}

void write_walls(const par::Comm& comm, const std::string& file, const std::vector<FaceRow>& faces, double unit,
                 GlobalId n_global_cells) {
  io::SurfaceTriangles triangles{.all_cells = n_global_cells};
  const std::string pascal = "Pa", flux = "W/m^2";
  io::SurfaceField p{.name = "p", .unit = pascal}, p_error{.name = "p_stderr", .unit = pascal},
      tau{.name = "tau", .n_components = 3, .unit = pascal}, q{.name = "q", .unit = flux},
      q_error{.name = "q_stderr", .unit = flux}, hits{"hits"}, patch{"patch"}, area{.name = "area", .unit = "m^2"};
  for (const auto& face : faces) {
    triangles.cell.push_back(face.cell);
    auto& corner = triangles.corner.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      corner[k] = {face.corner[k].x / unit, face.corner[k].y / unit, face.corner[k].z / unit};
    p.value.push_back(face.pressure);
    p_error.value.push_back(face.pressure_error);
    tau.value.insert(tau.value.end(), {face.shear.x, face.shear.y, face.shear.z});
    q.value.push_back(face.heat);
    q_error.value.push_back(face.heat_error);
    hits.value.push_back(face.hits);
    patch.value.push_back(static_cast<double>(face.patch));
    area.value.push_back(face.area);
  }
  triangles.fields = {p, p_error, tau, q, q_error, hits, patch, area};
  io::write_surface_vtu(comm, file, triangles);
}

}  // namespace pamr::dsmc
