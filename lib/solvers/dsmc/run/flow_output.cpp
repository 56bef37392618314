// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flow_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/run/flux_report.hpp"
#include "solvers/dsmc/run/history.hpp"
#include "solvers/dsmc/sampling/cell_flow.hpp"
#include "solvers/dsmc/sampling/density_scale.hpp"
#include "solvers/dsmc/sampling/probes.hpp"
#include "solvers/dsmc/sampling/wall_averages.hpp"

namespace pamr::dsmc {

namespace {

std::vector<FaceRow> walls_of(const Computation& computation) {
  const auto& flow = computation.flow();
  const auto& state = computation.averaging().state();
  const auto& setup = flow.setup();
  const WallScale scale{flow.surface.momentum_unit, flow.surface.energy_unit, setup.fnum / setup.dt,
                        static_cast<double>(std::max<std::int64_t>(1, flow.cells.steps_in_blocks)),
                        static_cast<double>(state.blocks.size())};
  return wall_averages(flow.domain(), setup.patch, state.face, scale);
}

CellFlow averages_of(const Computation& computation) {
  const auto& flow = computation.flow();
  const auto& setup = flow.setup();
  auto cells = average_cells(flow.domain(), setup.gas, flow.cells, flow.collisions, setup.unit);
  cells.scale = density_scale(computation.comm(), computation.mesh(), cells.density);
  return cells;
}

/// Sets what is known of the cells at the walls of the body where molecules collide, weighted by the heat to the faces,
/// or by their area where none is heated. Collective.
void assess_walls(const Computation& computation, const CellFlow& cells, const std::vector<FaceRow>& walls,
                  CellResolution& resolution) {
  const auto& domain = computation.flow().domain();
  const auto& setup = computation.flow().setup();
  const auto body =
      reference_patches(computation.the_case().reference, setup.patches_on(computation.mesh()), setup.patch);
  std::array<par::ExactSum, 6> sums;  // by heat, and by area
  for (const auto& face : walls) {
    if (!body[at(face.patch)]) continue;
    const auto found = std::lower_bound(domain.cell_global.begin(), domain.cell_global.end(), face.cell);
    const auto cell = static_cast<std::size_t>(found - domain.cell_global.begin());
    if (!(cells.separation[cell] > 0)) continue;  // in the steps that were averaged
    std::size_t first = 0;
    for (const double weight : {std::fabs(face.heat) * face.area, face.area}) {
      sums[first].add(weight * cells.separation[cell]);
      sums[first + 1].add(weight / cells.knudsen[cell]);
      sums[first + 2].add(weight);
      first += 3;
    }
  }
  const auto total = par::reproducible_sums(computation.comm(), sums);
  const std::size_t first = total[2] > 0 ? 0 : 3;
  if (!(total[first + 2] > 0)) return;
  resolution.wall_separation = total[first] / total[first + 2];
  resolution.wall_cell_size = total[first + 1] / total[first + 2];
}

}  // namespace

void write_window(Computation& computation, const std::string& file) {
  auto& mesh = computation.mesh();
  const auto own_fields = mesh.cell_fields;
  for (auto& field : to_fields(averages_of(computation), computation.flow().setup().gas))
    mesh::put_field(mesh.cell_fields, std::move(field));
  io::write_native(computation.comm(), file, mesh);
  mesh.cell_fields = own_fields;
}

CellResolution write_output(Computation& computation, const OutputFiles& files, const WriteText& write_text) {
  const auto& comm = computation.comm();
  const auto& c = computation.the_case();
  const auto& flow = computation.flow();
  const auto& setup = flow.setup();
  auto cells = averages_of(computation);
  auto resolution = assess_resolution(comm, cells, c.stream.front().density, flow.cells.steps);
  const auto walls = walls_of(computation);
  assess_walls(computation, cells, walls, resolution);
  auto fields = to_fields(std::move(cells), setup.gas);
  if (!files.lines.empty()) {
    const auto points =
        point_rows(comm, points_of(c.line, c.plane), {computation.mesh(), setup.unit, flow.domain(), fields});
    write_text(files.lines, probe_header + station_rows(comm, c.station, walls) + points);
  }
  auto& mesh = computation.mesh();
  for (auto& field : fields) mesh::put_field(mesh.cell_fields, std::move(field));
  if (!files.mesh.empty()) io::write_native(comm, files.mesh, mesh);
  if (!files.surface.empty()) write_walls(comm, files.surface, walls, setup.unit, mesh.info.n_global_cells);
  if (!files.history.empty())
    write_text(files.history,
               to_csv(computation.averaging().state().history, c.dt, surfaces_of(computation), setup.gas.species));
  return resolution;
}

std::vector<std::string> warnings_of_lines(const Case& c, const std::string& text) {
  std::vector<std::string> warnings;
  const auto look = [&](const char* kind, const auto& probes) {
    for (const auto& probe : probes)
      if (text.find("\n" + probe.name + ",") == std::string::npos)
        warnings.push_back(
            fmt::format("[[{}]] \"{}\" has no rows: no part of it lies in the gas or on a wall", kind, probe.name));
  };
  look("station", c.station);
  look("line", c.line);
  look("plane", c.plane);
  return warnings;
}

}  // namespace pamr::dsmc
