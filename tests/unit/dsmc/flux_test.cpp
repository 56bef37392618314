// SPDX-License-Identifier: GPL-3.0-or-later
// Fluxes through patches and planes: counts against straight lines, rates against kinetic theory, and the balance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "solvers/dsmc/flow/gas_contents.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/run/flow_report.hpp"
#include "solvers/dsmc/run/flux_report.hpp"
#include "solvers/dsmc/sampling/fluxes.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace flux_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;
using Kind = BoundaryCondition::Kind;
using Way = FluxTally::Way;

FluxPlane plane_at(Vec3 point, Vec3 normal, double radius = 0) {
  FluxPlane plane;
  plane.name = "p";
  plane.point = point;
  plane.normal = (1 / norm(normal)) * normal;
  plane.radius = radius;
  return plane;
}

FluxPlane parallelogram(Vec3 corner, Vec3 along, Vec3 across) {
  auto plane = plane_at(corner, cross(along, across));
  plane.along = along;
  plane.across = across;
  return plane;
}

TEST(FluxPlane, IsCrossedByLinesWithEndsOnItsTwoSidesWithinItsBounds) {
  const auto whole = plane_at({0, 0, 1}, {0, 0, 2});
  EXPECT_EQ(whole.crossing({0, 0, 0}, {5, 5, 2}), 1);
  EXPECT_EQ(whole.crossing({5, 5, 2}, {0, 0, 0}), -1);
  EXPECT_EQ(whole.crossing({0, 0, 0}, {0, 0, 0.5}), 0);
  EXPECT_EQ(whole.crossing({0, 0, 0}, {0, 0, 1}) + whole.crossing({0, 0, 1}, {0, 0, 2}), 1);  // once, not twice
  EXPECT_EQ(whole.crossing({0, 0, 0}, {0, 0, 1}) + whole.crossing({0, 0, 1}, {0, 0, 0}), 0);

  const auto disk = plane_at({1, 0, 0}, {1, 0, 0}, 0.5);
  EXPECT_EQ(disk.crossing({0, 0, 0}, {2, 0.9, 0}), 1);
  EXPECT_EQ(disk.crossing({0, 0, 0}, {2, 1.1, 0}), 0);
  EXPECT_EQ(disk.crossing({2, 0, 0.4}, {0, 0, 0.4}), -1);

  const auto slanted = parallelogram({0, 0, 0}, {2, 0, 0}, {1, 1, 0});
  EXPECT_EQ(slanted.crossing({1.5, 0.5, -1}, {1.5, 0.5, 1}), 1);
  EXPECT_EQ(slanted.crossing({0.2, 0.5, -1}, {0.2, 0.5, 1}), 0);
  EXPECT_EQ(slanted.crossing({2.4, 0.5, 1}, {2.4, 0.5, -1}), -1);
}

TEST(FluxPlane, ThatCutsNoCellIsRefused) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  auto setup = test::box_of(test::nitrogen(), mesh, 1, 1, 1e20, 300, 300, 1e-4);
  setup.plane = {plane_at({1.001, 0, 0}, {1, 0, 0})};
  EXPECT_THROW(Flow(comm, mesh, setup), Error);
}

/// Particles that passed a surface one way.
std::int64_t number(const Flow& flow, std::size_t surface, Way way) {
  const auto words = total_fluxes(flow.comm(), flow.flux);
  return flux_row(words, FluxTally::row_of(surface, 0, way, flow.setup().gas.species.size())).n;
}

/// How often the line from `a` to `b` passes x + k for any integer k: > 0 upwards.
std::int64_t passages(double x, double a, double b) { return std::llround(std::floor(b - x) - std::floor(a - x)); }

TEST(Fluxes, AreThoseOfTheUnfoldedStraightLinesInABoxOfMirrorsAndInAPeriodicOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  for (const bool is_periodic : {false, true}) {
    auto setup = test::box_of(test::nitrogen(), mesh, 1, 4, 1e20, 300, 300, 1.7e-3);  // many a passage in a step
    setup.stream[0].velocity = {900, 400, -250};
    setup.collisions.enabled = false;
    setup.plane = {plane_at({0.5, 0, 0}, {1, 0, 0}), plane_at({0, 0, 0.3}, {0, 0, 1})};
    for (std::size_t side = 0; side < 6 && is_periodic; ++side) {
      setup.patch[side].kind = Kind::periodic;
      setup.patch[side].partner = static_cast<int>(side ^ 1U);
    }
    Flow flow(comm, mesh, setup);
    flow.fill(mesh);
    constexpr int n_steps = 5;
    std::array<std::int64_t, 6> expected{};  // planes out and in; the sides at x = 0 or 1, one way, of a periodic box
    for (std::size_t i = 0; i < flow.particles.size(); ++i) {
      const Vec3 a = flow.particles.position(i), b = a + (n_steps * setup.dt) * flow.particles.velocity(i);
      const auto x = passages(0.5, a.x, b.x);
      // Mirrored at z = 0 and 1, the plane at 0.3 comes again at -0.3 and 1.7, and so on.
      const auto z =
          is_periodic ? passages(0.3, a.z, b.z) : passages(0.15, a.z / 2, b.z / 2) + passages(0.85, a.z / 2, b.z / 2);
      expected[0] += std::max<std::int64_t>(0, x);
      expected[1] += std::max<std::int64_t>(0, -x);
      expected[2] += std::max<std::int64_t>(0, z);
      expected[3] += std::max<std::int64_t>(0, -z);
      expected[4] += std::max<std::int64_t>(0, passages(0, a.x, b.x));
      expected[5] += std::max<std::int64_t>(0, -passages(0, a.x, b.x));
    }
    comm.sum_in_place(expected);

    for (int step = 0; step < n_steps; ++step) flow.step();

    const auto out = [&](std::size_t surface) { return number(flow, surface, Way::out); };
    const auto in = [&](std::size_t surface) { return number(flow, surface, Way::in); };
    for (std::size_t side = 0; side < 6; ++side) EXPECT_EQ(out(side), in(is_periodic ? side ^ 1U : side)) << side;
    if (is_periodic) {
      EXPECT_EQ(out(6), expected[0]);
      EXPECT_EQ(in(6), expected[1]);
      EXPECT_EQ(out(7), expected[2]);
      EXPECT_EQ(in(7), expected[3]);
      EXPECT_EQ(out(1), expected[4]);
      EXPECT_EQ(out(0), expected[5]);
    } else {
      EXPECT_EQ(out(6) + in(6), expected[0] + expected[1]);
      EXPECT_EQ(out(7) + in(7), expected[2] + expected[3]);
      EXPECT_EQ(out(0) + out(1), expected[4] + expected[5]);
    }
  }
}

/// Flux of a uniform gas through an area of 1 m2 along `normal`: molecules, momentum, energy, per second.
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, section 4.2.
FluxRate kinetic_flux(const Stream& gas, const Species& species, Vec3 normal) {
  const double c = most_probable_speed(gas.temperature, species.mass), along = dot(gas.velocity, normal);
  const double s = along / c, gauss = std::exp(-s * s), one_erf = 1 + std::erf(s), root = std::sqrt(std::numbers::pi);
  const double number = molecular_flux(gas.density, gas.temperature, species.mass, along);
  const double unit = gas.density * species.mass * c * c / (2 * root);
  const Vec3 aside = gas.velocity - along * normal;
  const Vec3 momentum =
      (unit * (s * gauss + root * (0.5 + s * s) * one_erf)) * normal + (number * species.mass) * aside;
  const double kt = boltzmann * gas.temperature;
  const double energy =
      0.5 * unit * c * ((1 + s * s) * gauss + root * s * (1.5 + s * s) * one_erf) +
      number * (0.5 * species.mass * squared_norm(aside) + kt + 0.5 * species.rotational_degrees * kt);
  return {number, momentum.x, momentum.y, momentum.z, energy};
}

TEST(Fluxes, ThroughPlanesOfAUniformStreamAreThoseOfKineticTheory) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  const Stream stream{"gas", 1e20, 300, 300, {300, -150, 80}, {1}};
  auto setup = test::box_of(test::nitrogen(), mesh, 1, 40, stream.density, 300, 300, 1e-4);
  setup.stream = {stream};
  for (auto& patch : setup.patch) patch = {Kind::inflow, 0, {}, 1, 1, 1, 1, 0};
  setup.collisions.enabled = false;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)  // steps of two lengths
    setup.cell_dt.push_back(centroid_of(corners(mesh, 1, cell)).y < 0.5 ? 1e-4 : 0.5e-4);
  setup.plane = {plane_at({0.5, 0, 0}, {1, 0, 0}),  // along faces of the mesh
                 plane_at({0.5, 0.5, 0.5}, {1, 2, 2}, 0.3),
                 parallelogram({0.2, 0.2, 0.55}, {0.5, 0, 0}, {0.1, 0.4, 0})};
  const double area[] = {1, 0.09 * std::numbers::pi, 0.2};
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);

  constexpr std::int64_t n_blocks = 20, n_steps = 8;
  std::vector<std::vector<FluxRate>> blocks;
  for (std::int64_t block = 0; block < n_blocks; ++block) {
    for (std::int64_t step = 0; step < n_steps; ++step) flow.step();
    blocks.push_back(
        flux_rates(total_fluxes(comm, flow.flux), setup.gas,
                   {flow.surface.momentum_unit, flow.surface.energy_unit, setup.fnum / setup.dt, n_steps}));
    flow.flux.clear();
  }

  for (std::size_t k = 0; k < setup.plane.size(); ++k) {
    const auto found = mean_flux(blocks, blocks.size(), 6 + k, 0, 1);
    const Vec3 normal = setup.plane[k].normal;
    const auto along = kinetic_flux(stream, setup.gas.species[0], normal);
    const auto against = kinetic_flux(stream, setup.gas.species[0], -normal);
    for (std::size_t q = 0; q < along.size(); ++q) {
      EXPECT_NEAR(found.out[q].value, area[k] * along[q], 4 * found.out[q].error) << "plane " << k << ", " << q;
      EXPECT_NEAR(found.in[q].value, area[k] * against[q], 4 * found.in[q].error) << "plane " << k << ", " << q;
      EXPECT_GT(found.out[q].error, 0);
    }
    EXPECT_LT(found.out[0].error, 0.03 * found.out[0].value);
  }
}

const Results::OfPatch& wall_named(const Results& results, const std::string& name) {
  for (const auto& wall : results.walls)
    if (wall.patch == name) return wall;
  return results.body;
}

TEST(Balance, HoldsWithStreamsWallsMirrorsUnlikeStepsAndWeights) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string weighted = test::stream_case;
  weighted.replace(weighted.find("[gas]"), 5,
                   "[species.X]\nmass = 3e-26\ndiameter = 3e-10\nomega = 0.7\nt_ref = 273.0\n[gas]");
  weighted.replace(weighted.find("{ N2 = 1.0 }"), 12, "{ N2 = 0.9, X = 0.1 }");
  weighted.replace(weighted.find("per_cell = 8.0"), 14, "per_cell = 12.0\nspecies_weights = { X = 0.25 }");
  for (const std::string& text : {std::string(test::stream_case), weighted}) {
    const auto c =
        read_case(text + "[[plane]]\nname = \"middle\"\npoint = [0.5, 0.5, 0.5]\nnormal = [1, 0, 0]\n", "case.toml");
    const auto computation = test::filled(comm, c, assemble::assemble(comm, test::random_mesh(comm, 5, 4)));
    const auto n_before = computation->flow().n_particles();

    while (!computation->is_complete()) computation->step();
    computation->finish();

    const auto& balance = computation->averaging().state().balance;
    EXPECT_TRUE(balance.holds()) << balance_line(balance);
    EXPECT_EQ(balance.before, n_before);
    EXPECT_EQ(balance.after, computation->flow().n_particles());
    EXPECT_EQ(balance.before + balance.in - balance.out, balance.after);
    EXPECT_GT(balance.in, 1000);
    EXPECT_GT(balance.momentum + balance.energy, 0);  // it is rounding, not nothing

    // Force and heat of a wall at rest are what its coefficients say.
    const auto report = fluxes_report(*computation)["patches"]["zmin"];
    const auto results = computation->averaging().results();
    const auto& scale = computation->averaging().scale();
    const auto& wall = wall_named(results, "zmin");
    const double heat = scale.force() * scale.speed() * wall.heat.value;
    EXPECT_NEAR(report["net"]["energy"]["value"].get<double>(), heat, 1e-6 * std::fabs(heat));
    EXPECT_EQ(report["net"]["molecules"]["value"].get<double>(), 0);
    const auto lines = flux_lines(*computation);
    // Of several species each has a line below that of the plane and of patches that are open.
    const auto& conditions = computation->flow().setup().patch;
    const auto n_open =
        std::count_if(conditions.begin(), conditions.end(), [](const auto& one) { return one.is_open(); });
    const auto n_species = c.gas.species.size();
    const std::size_t n_of_species = n_species < 2 ? 0 : n_species * static_cast<std::size_t>(n_open + 1);
    ASSERT_EQ(lines.size(), 7 + n_of_species);
    const auto& plane = lines[lines.size() - 1 - (n_species < 2 ? 0 : n_species)];
    EXPECT_EQ(plane.find("plane middle: "), 0U) << plane;
    EXPECT_EQ(fluxes_report(*computation)["planes"]["middle"].contains("species"), c.gas.species.size() > 1);
  }
}

TEST(Balance, NamesWhatIsMissing) {
  const std::vector<std::int64_t> nothing(2 * FluxTally::words_of_row, 0);
  const GasContents gas{{10}, {WideSum{1 << 20, 0}, {}, {}}, {0, 1}, {}, {}, {}};
  GasBalance balance;
  balance.add(gas, gas, nothing, 1, 0);
  EXPECT_TRUE(balance.holds());

  auto other = gas;
  other.n[0] = 9;
  balance.add(gas, other, nothing, 1, 0);
  EXPECT_EQ(balance.unexplained, 1);
  EXPECT_NE(balance_line(balance).find("1 UNEXPLAINED"), std::string::npos) << balance_line(balance);

  for (const bool is_energy : {false, true}) {
    GasBalance one;
    other = gas;
    (is_energy ? other.rotation : other.momentum[1]).low += 1000;  // roundings, of twenty particles
    one.add(gas, other, nothing, 1, 0);
    EXPECT_FALSE(one.holds());
    EXPECT_EQ(one.unexplained, 0);
    EXPECT_EQ((is_energy ? one.momentum : one.energy), 0);
    EXPECT_EQ(balance_report(one)[is_energy ? "energy" : "momentum"]["holds"], false);
  }
}

TEST(ClosedBox, GivesIsothermalWallsTheEnergyThatTheGasLosesAndNoMolecules) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  auto setup = test::box_of(test::nitrogen(), mesh, 1, 30, 1e20, 600, 600, 1e-4);
  for (auto& patch : setup.patch) {
    patch.kind = Kind::diffuse;
    patch.temperature = 300;
  }
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  const auto before = contents_of(flow);
  for (int step = 0; step < 30; ++step) flow.step();
  const auto after = contents_of(flow);

  double lost = 0;  // units of the tally
  const auto words = total_fluxes(comm, flow.flux);
  for (std::size_t side = 0; side < 6; ++side) {
    const auto out = flux_row(words, FluxTally::row_of(side, 0, Way::out, 1));
    const auto in = flux_row(words, FluxTally::row_of(side, 0, Way::in, 1));
    EXPECT_GT(out.n, 100);
    EXPECT_EQ(out.n, in.n);
    lost += out.sums[3].value() - in.sums[3].value();
  }
  const auto energy = [](const GasContents& c) { return c.translation.value() + c.rotation.value(); };
  EXPECT_GT(lost, 0.1 * energy(before));  // towards half of it
  EXPECT_NEAR(lost / (energy(before) - energy(after)), 1, 1e-7);
}

/// The averaging of the rest of a run.
Averaging rest_of(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh, const Snapshot& from) {
  Flow flow(comm, mesh, make_setup(comm, c, mesh));
  Averaging averaging(c, mesh, flow);
  averaging.resume(restore(comm, from, flow));
  while (!averaging.is_complete(flow.steps_done)) {
    averaging.before_step(flow);
    averaging.after_step(flow, flow.step().all);
  }
  return averaging;
}

TEST(Fluxes, OfARestartedRunAndOnOtherRanksAreTheSameBits) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c =
      read_case(std::string(test::stream_case) +
                    "[[plane]]\nname = \"disk\"\npoint = [0.5, 0.5, 0.5]\nnormal = [1, 1, 0]\nradius = 0.3\n",
                "case.toml");
  const auto block = test::random_mesh(comm, 5, 4);
  const auto mesh = assemble::assemble(comm, block), whole_mesh = assemble::assemble(alone, test::gather(comm, block));
  auto straight = test::filled(comm, c, mesh), begun = test::filled(comm, c, mesh);
  auto twin = test::filled(alone, c, whole_mesh);
  while (!straight->is_complete()) straight->step();
  while (!twin->is_complete()) twin->step();
  for (int step = 0; step < 43; ++step) begun->step();  // in the middle of a block
  const auto averaging = rest_of(comm, c, mesh, begun->snapshot());

  const auto& state = straight->averaging().state();
  EXPECT_EQ(state.flux_blocks.size(), 12U);
  EXPECT_EQ(to_json(averaging.state()), to_json(state));
  EXPECT_EQ(to_json(twin->averaging().state()), to_json(state));
  EXPECT_EQ(fluxes_report(*twin), fluxes_report(*straight));
}

TEST(Fluxes, OfARunThatAnOlderVersionBeganAreThoseOfTheBlocksSince) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 4));
  auto straight = test::filled(comm, c, mesh), begun = test::filled(comm, c, mesh);
  while (!straight->is_complete()) straight->step();
  for (int step = 0; step < 43; ++step) begun->step();  // three steps of the third block
  auto old = begun->snapshot();
  old.header.erase("fluxes");
  auto& run = old.header["run"];
  for (const char* key : {"flux_blocks", "contents", "balance", "begun", "restarts"}) run.erase(key);
  for (auto& row : run["history"]) row.erase(row.begin() + 15, row.end());

  const auto averaging = rest_of(comm, c, mesh, old);

  const auto& state = averaging.state();
  EXPECT_EQ(state.blocks.size(), 12U);
  EXPECT_EQ(state.flux_blocks.size(), 9U);
  EXPECT_EQ(state.flux_blocks.back(), straight->averaging().state().flux_blocks.back());
  EXPECT_EQ(state.balance.n_intervals, 9);
  EXPECT_TRUE(state.balance.holds()) << balance_line(state.balance);
  EXPECT_EQ(state.begun, Begun::by_case);
  EXPECT_EQ(averaging.results().body.drag.value, straight->averaging().results().body.drag.value);
}

}  // namespace flux_test
