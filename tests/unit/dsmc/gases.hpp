// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/flow/flow.hpp"

/// Gases and boxes for tests.
namespace pamr::test {

/// Variable hard spheres; relaxes with probability 0.2 a molecule.
inline dsmc::Gas nitrogen() {
  dsmc::Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  gas.fraction = {1};
  prepare(gas);
  return gas;
}

inline dsmc::Gas argon() {
  dsmc::Gas gas;
  gas.species = {{"Ar", 6.63e-26, 4.11e-10, 0.81, 273.15, 1, 0}};
  gas.fraction = {1};
  prepare(gas);
  return gas;
}

/// A mesh of length unit `unit` full of gas, mirrors all round; `per_cell` particles a cell on average.
inline dsmc::Setup box_of(const dsmc::Gas& gas, const mesh::DistMesh& mesh, double unit, double per_cell,
                          double density, double temperature, double rotational_temperature, double dt) {
  dsmc::Setup setup;
  setup.gas = gas;
  setup.stream = {{"gas", density, temperature, rotational_temperature, {}, gas.fraction}};
  setup.patch.resize(mesh.info.patches.size());
  setup.unit = unit;
  setup.dt = dt;
  setup.fnum = density * unit * unit * unit / (static_cast<double>(mesh.info.n_global_cells) * per_cell);
  return setup;
}

/// Totals over all ranks.
struct Totals {
  double n = 0, mass = 0;
  geometry::Vec3 momentum;
  double translational = 0, rotational = 0;  ///< J, of the particles as they are

  double t_tr() const {
    return (translational - squared_norm(momentum) / (2 * mass)) / (1.5 * dsmc::boltzmann * (n - 1));
  }
  double t_rot(double degrees) const { return rotational / (0.5 * degrees * dsmc::boltzmann * n); }
};
inline Totals totals(const dsmc::Flow& flow) {
  const auto& p = flow.particles;
  par::ExactSum sums[7];
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double m = flow.setup().gas.species[p.species[i]].mass;
    const auto v = p.velocity(i);
    const double row[] = {1, m, m * v.x, m * v.y, m * v.z, 0.5 * m * squared_norm(v), p.rotation[i]};
    for (std::size_t k = 0; k < 7; ++k) sums[k].add(row[k]);
  }
  const auto s = par::reproducible_sums(flow.comm(), sums);
  return {s[0], s[1], {s[2], s[3], s[4]}, s[5], s[6]};
}

}  // namespace pamr::test
