// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/make_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/gas/gas_tables.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/run/gas_patches.hpp"
#include "solvers/dsmc/sampling/loads.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

void require_reference(const Case& c, const Setup& setup) {
  for (const auto& name : c.reference.patches)
    if (walls_named(name, setup.patches, setup.patch).empty())
      throw Error(
          fmt::format("{}: expected patches = names of walls of the mesh in [reference], found \"{}\"", c.where, name));
}

/// In history and report planes stand beside patches.
void require_names_of_planes(const Case& c, const std::vector<mesh::Patch>& patches) {
  for (const auto& plane : c.flux_plane)
    if (std::any_of(patches.begin(), patches.end(), [&](const auto& patch) { return patch.name == plane.name; }))
      throw Error(fmt::format("{}: expected a name in [[plane]] that no patch of the mesh has, found \"{}\"", c.where,
                              plane.name));
}

double unit_of(const Case& c, const mesh::DistMesh& mesh) {
  if (c.unit) return *c.unit;
  if (mesh.info.length_unit == "m") return 1;
  throw Error(fmt::format("{}: expected unit = METERS in [domain] for a mesh whose length unit is \"{}\", found none",
                          c.where, mesh.info.length_unit));
}

/// Throws `Error` on every rank for a domain of a size with which nothing can be computed.
void require_size(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh, double unit) {
  constexpr double smallest_volume = 1e-60;
  double farthest = 0, smallest = std::numeric_limits<double>::infinity();
  for (const auto& p : mesh.node_position)
    farthest = std::max({farthest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    smallest = std::min(smallest, volume(corners(mesh, unit, cell)));
  farthest = unit * comm.max(farthest);
  smallest = comm.min(smallest);
  if (!(farthest <= max_place) || !(smallest >= smallest_volume))
    throw Error(fmt::format(
        "{}: expected a domain with coordinates of at most {:g} m and cells of at least {:g} m3, found {:g} "
        "m and {:g} m3 (a unit of length of the mesh is {:g} m)",
        c.where, max_place, smallest_volume, farthest, smallest, unit));
}

/// The gas that decides a cell's time step: the free stream, or what an earlier run has found there.
struct LocalGas {
  double density = 0;         ///< 1/m3
  double fast = 0;            ///< m/s, of a fast molecule
  double collision_time = 0;  ///< s
};

/// A cell field that an earlier run has left.
const std::vector<double>& field_of(const Case& c, const mesh::DistMesh& mesh, const char* name, int n_components) {
  const auto used_for = fmt::format("{}: from_fields in [time]", c.where);
  return mesh::require_cell_field(mesh, {name, mesh::FieldValues::real, n_components, used_for}).real();
}

/// Throws `Error`, maybe on this rank only.
std::vector<LocalGas> local_gas(const Case& c, const mesh::DistMesh& mesh) {
  constexpr double max_density = 1e31, max_speed = 1e8;  // beyond what any case may have
  const auto& free = c.stream.front();
  double lightest = c.gas.species.front().mass;
  for (const auto& s : c.gas.species) lightest = std::min(lightest, s.mass);
  Gas gas = c.gas;
  gas.fraction = free.fraction;
  LocalGas far{free.density, norm(free.velocity) + most_probable_speed(free.temperature, lightest),
               free.density > 0 ? 1 / collision_frequency(mean_species(gas), free.density, free.temperature) : 1e30};
  std::vector<LocalGas> cells(static_cast<std::size_t>(mesh.n_cells()), far);
  if (!c.from_fields) return cells;
  const auto &n = field_of(c, mesh, "n", 1), &u = field_of(c, mesh, "u", 3), &t = field_of(c, mesh, "T_tr", 1),
             &tau = field_of(c, mesh, "tau_c", 1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double speed = std::hypot(u[3 * i], std::hypot(u[3 * i + 1], u[3 * i + 2]));
    const double thermal = t[i] > 0 ? most_probable_speed(t[i], lightest) : 0;
    cells[i].density = std::max(0.0, n[i]);
    if (speed + thermal > 0) cells[i].fast = speed + thermal;
    if (tau[i] > 0) cells[i].collision_time = tau[i];
    if (!(cells[i].density <= max_density && cells[i].fast <= max_speed))
      throw Error(
          fmt::format("{}: from_fields in [time]: expected at most {:g} 1/m3 and {:g} m/s, found {:g} 1/m3 and "
                      "{:g} m/s in cell {}",
                      c.where, max_density, max_speed, cells[i].density, cells[i].fast, mesh.cell_global[i]));
  }
  return cells;
}

/// Time step of each cell: in it a fast molecule passes at most `cell_fraction` of the cell's size; it is at most
/// `collision_fraction` of the collision time, and at most `dt`.
std::vector<double> time_steps(const Case& c, const mesh::DistMesh& mesh, double unit,
                               const std::vector<LocalGas>& gas) {
  std::vector<double> steps;
  if (c.cell_fraction == 0 && c.collision_fraction == 0) return steps;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto& here = gas[at(cell)];
    double step = c.dt;
    if (c.cell_fraction > 0)
      step = std::min(step, c.cell_fraction * std::cbrt(volume(corners(mesh, unit, cell))) / here.fast);
    if (c.collision_fraction > 0) step = std::min(step, c.collision_fraction * here.collision_time);
    steps.push_back(step);
  }
  return steps;
}

/// The box around the mesh, in meters, for a message. Collective.
std::string box_of(const par::Comm& comm, const mesh::DistMesh& mesh, double unit) {
  const auto box = mesh::box_of_nodes(comm, mesh);
  const auto low = unit * box.low, high = unit * box.high;
  return fmt::format("[{:g}, {:g}, {:g}, {:g}, {:g}, {:g}]", low.x, low.y, low.z, high.x, high.y, high.z);
}

}  // namespace

std::vector<double> make_cell_dt(const Case& c, const mesh::DistMesh& mesh, double unit) {
  return time_steps(c, mesh, unit, local_gas(c, mesh));
}

Setup make_setup(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh, std::optional<double> fnum) {
  Setup setup;
  setup.gas = c.gas;
  setup.stream = c.stream;
  setup.unit = unit_of(c, mesh);
  set_patches(comm, c, mesh, setup);
  require_reference(c, setup);
  require_names_of_planes(c, setup.patches_on(mesh));
  setup.initial = c.initial;
  setup.region = c.region;
  setup.plane = c.flux_plane;
  setup.collisions = c.collisions;
  setup.dt = c.dt;
  require_size(comm, c, mesh, setup.unit);
  std::vector<LocalGas> gas;
  par::agree(comm, [&] { gas = local_gas(c, mesh); });
  setup.cell_dt = time_steps(c, mesh, setup.unit, gas);
  setup.seed = c.seed;

  par::ExactSum sums[3];  // of n V dt_0 / dt over the cells: molecules of particles whose weight is 1; V; V dt_0 / dt
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const double v = volume(corners(mesh, setup.unit, cell));
    const auto i = at(cell);
    const double steps = setup.cell_dt.empty() ? v : v * (c.dt / setup.cell_dt[i]);
    sums[0].add(c.from_fields ? steps * gas[i].density : steps);
    sums[1].add(v);
    sums[2].add(steps);
  }
  const auto total = par::reproducible_sums(comm, sums);
  setup.mean_dt_ratio = total[2] / total[1];
  const auto& free = c.stream.front();
  const double molecules = (c.from_fields ? 1 : free.density) * total[0] * particles_per_molecule(c.gas, free.fraction);
  if (fnum)
    setup.fnum = *fnum;
  else if (c.weight)
    setup.fnum = *c.weight;
  else if (c.total)
    setup.fnum = molecules / *c.total;
  else
    setup.fnum = molecules / (*c.per_cell * static_cast<double>(mesh.info.n_global_cells));
  if (!(setup.fnum > 0))
    throw Error(
        fmt::format("{}: expected a density above 0 in [stream.free], from which the weight follows, or weight "
                    "in [particles]",
                    c.where));
  constexpr double min_weight = 1e-60, max_weight = 1e60;
  if (!(setup.fnum >= min_weight && setup.fnum <= max_weight))
    throw Error(fmt::format("{}: expected particles of {:g} to {:g} molecules, found a weight of {:g}", c.where,
                            min_weight, max_weight, setup.fnum));
  setup.expected_particles = molecules / setup.fnum;
  return setup;
}

void require_regions(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh) {
  const auto n = setup.region.size();
  if (n == 0) return;
  std::vector<std::int64_t> cells(2 * n, 0);  // that each region fills; that it holds
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corner = corners(mesh, setup.unit, cell);
    const int filled_by = setup.region_at_start(corner);
    if (filled_by < 0) continue;
    ++cells[static_cast<std::size_t>(filled_by)];
    for (std::size_t r = 0; r < n; ++r) cells[n + r] += setup.region[r].holds(centroid_of(corner)) ? 1 : 0;
  }
  comm.sum_in_place(cells);
  for (std::size_t r = 0; r < n; ++r) {
    if (cells[r] > 0) continue;
    if (cells[n + r] > 0)
      throw Error(
          fmt::format("{}: expected cells that this [[initial.region]] fills, found later regions in all of its {}",
                      c.region_at[r], cells[n + r]));
    throw Error(fmt::format(
        "{}: expected an [[initial.region]] in the gas, found no centroid of a cell in it; the mesh lies in "
        "the box {}, in meters",
        c.region_at[r], box_of(comm, mesh, setup.unit)));
  }
}

}  // namespace pamr::dsmc
