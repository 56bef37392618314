// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dsmc/case_file.hpp"
#include "dsmc/closed_forms.hpp"
#include "pamr/base/error.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

std::vector<BoundaryCondition> conditions_of(const Case& c, const mesh::DistMesh& mesh) {
  std::vector<BoundaryCondition> conditions;
  std::string names, missing;
  for (const auto& patch : mesh.info.patches) {
    names += (names.empty() ? "" : ", ") + patch.name;
    const auto found = c.boundary.find(patch.name);
    if (found == c.boundary.end())
      missing += (missing.empty() ? "" : ", ") + patch.name;
    else
      conditions.push_back(found->second);
  }
  if (!missing.empty())
    throw Error(fmt::format("{}: expected a table [boundary.PATCH] for every patch of the mesh, found none for {}",
                            c.where, missing));
  for (const auto& [name, condition] : c.boundary)
    if (std::none_of(mesh.info.patches.begin(), mesh.info.patches.end(), [&](const auto& p) { return p.name == name; }))
      throw Error(fmt::format("{}: expected a patch of the mesh ({}) in [boundary.PATCH], found \"{}\"",
                              c.boundary_at.at(name), names, name));
  return conditions;
}

double unit_of(const Case& c, const mesh::DistMesh& mesh) {
  if (c.unit) return *c.unit;
  if (mesh.info.length_unit == "m") return 1;
  throw Error(fmt::format("{}: expected unit = METRES in [domain] for a mesh whose length unit is \"{}\", found none",
                          c.where, mesh.info.length_unit));
}

/// Time step of each cell: the part `cell_fraction` of its size at the speed of a fast molecule, at most `dt`.
std::vector<double> time_steps(const Case& c, const mesh::DistMesh& mesh, double unit) {
  std::vector<double> steps;
  if (c.cell_fraction == 0) return steps;
  const auto& free = c.stream.front();
  double speed = 0;
  for (const auto& s : c.gas.species)
    speed = std::max(speed, norm(free.velocity) + most_probable_speed(free.temperature, s.mass));
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    steps.push_back(std::min(c.dt, c.cell_fraction * std::cbrt(volume(corners(mesh, unit, cell))) / speed));
  return steps;
}

}  // namespace

Setup make_setup(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh) {
  Setup setup;
  setup.gas = c.gas;
  setup.stream = c.stream;
  setup.patch = conditions_of(c, mesh);
  setup.initial = c.initial;
  setup.region = c.region;
  setup.collisions = c.collisions;
  setup.dt = c.dt;
  setup.unit = unit_of(c, mesh);
  setup.cell_dt = time_steps(c, mesh, setup.unit);
  setup.seed = c.seed;

  par::ExactSum sums[1];  // of V dt_0 / dt over the cells: particles of one molecule each per density
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const double v = volume(corners(mesh, setup.unit, cell));
    sums[0].add(setup.cell_dt.empty() ? v : v * (c.dt / setup.cell_dt[static_cast<std::size_t>(cell)]));
  }
  const auto& free = c.stream.front();
  const double molecules =
      free.density * par::reproducible_sums(comm, sums)[0] * particles_per_molecule(c.gas, free.fraction);
  if (c.weight)
    setup.molecules = *c.weight;
  else if (c.total)
    setup.molecules = molecules / *c.total;
  else
    setup.molecules = molecules / (*c.per_cell * static_cast<double>(mesh.info.n_global_cells));
  if (!(setup.molecules > 0))
    throw Error(
        fmt::format("{}: expected a density above 0 in [stream.free], from which the weight follows, or weight "
                    "in [particles]",
                    c.where));
  return setup;
}

}  // namespace pamr::dsmc
