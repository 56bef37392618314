// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "solvers/dsmc/run/computation.hpp"
#include "solvers/dsmc/run/flux_report.hpp"
#include "solvers/dsmc/run/history.hpp"
#include "solvers/dsmc/run/make_setup.hpp"

/// A small case with streams, walls and steps of several lengths, for tests of whole runs.
namespace pamr::test {

inline const char* const stream_case = R"(
[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
rotational_degrees = 2
[gas]
fractions = { N2 = 1.0 }
[stream.free]
density = 1e20
temperature = 300.0
speed = 600.0
angle = 20.0
[stream.puff]
density = 1e21
temperature = 300.0
[boundary]
xmin = { kind = "inflow" }
xmax = { kind = "inflow" }
ymin = { kind = "symmetry" }
ymax = { kind = "diffuse", temperature = 400.0 }
zmin = { kind = "diffuse", temperature = 500.0 }
zmax = { kind = "outflow" }
[initial]
[[initial.region]]
sphere = [0.2, 0.2, 0.2, 0.3]
stream = "puff"
[particles]
per_cell = 8.0
[domain]
unit = 1.0
[time]
step = 5e-5
cell_fraction = 0.4
[run]
transient = 30
sampling = 60
block = 5
[reference]
area = 1.0
)";

inline std::unique_ptr<dsmc::Computation> unfilled(const par::Comm& comm, const dsmc::Case& c, mesh::DistMesh mesh) {
  auto setup = make_setup(comm, c, mesh);
  return std::make_unique<dsmc::Computation>(comm, c, std::move(setup), std::move(mesh));
}

inline std::unique_ptr<dsmc::Computation> filled(const par::Comm& comm, const dsmc::Case& c, mesh::DistMesh mesh) {
  auto computation = unfilled(comm, c, std::move(mesh));
  computation->fill();
  return computation;
}

inline std::string history_of(const dsmc::Computation& computation) {
  return to_csv(computation.averaging().state().history, computation.the_case().dt, surfaces_of(computation),
                computation.flow().setup().gas.species);
}

}  // namespace pamr::test
