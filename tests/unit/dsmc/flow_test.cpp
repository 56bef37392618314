// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/flow/flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/analytic_flows.hpp"
#include "unit/dsmc/gases.hpp"

namespace flow_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;
using test::totals;
using Kind = BoundaryCondition::Kind;

/// Of all particles, averages and collisions with all their bits, whatever their order and their ranks.
std::int64_t fingerprint(const Flow& flow) {
  std::uint64_t sum = 0;
  const auto& p = flow.particles;
  const auto& global = flow.domain().cell_global;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint64_t h = p.id[i];
    for (const double value : {p.x[i], p.y[i], p.z[i], p.u[i], p.v[i], p.w[i], p.rotation[i]})
      h = combine(h, bits_of(value));
    sum += combine(h, static_cast<std::uint64_t>(global[static_cast<std::size_t>(p.cell[i])]));
  }
  for (std::size_t c = 0; c < global.size(); ++c) {
    auto h = static_cast<std::uint64_t>(global[c]);
    const auto& sums = flow.cells.sums[c];
    for (const double value : {flow.collisions[c].max_sigma_cr, flow.collisions[c].remainder, sums.n, sums.velocity.x,
                               sums.square, sums.rotation})
      h = combine(h, bits_of(value));
    sum += h;
  }
  return flow.comm().sum(static_cast<std::int64_t>(sum));
}

/// A unit cube in a stream of gas that comes in and leaves through all six sides.
Setup open_cube(const mesh::DistMesh& mesh, const Stream& stream, double per_cell, double dt) {
  auto setup =
      test::box_of(test::nitrogen(), mesh, 1, per_cell, stream.density, stream.temperature, stream.temperature, dt);
  setup.stream = {stream};
  for (auto& patch : setup.patch) patch = {Kind::inflow, 0, {}, 1, 1, 1, 1, 0};
  return setup;
}

int patch_named(const mesh::DistMesh& mesh, const std::string& name) {
  for (std::size_t i = 0; i < mesh.info.patches.size(); ++i)
    if (mesh.info.patches[i].name == name) return static_cast<int>(i);
  return -1;
}

TEST(Flow, DeliversOnceInAStepAndNeedsTwoReductions) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  Flow flow(comm, mesh, test::box_of(test::nitrogen(), mesh, 1, 10, 1e20, 300, 300, 1e-4));
  flow.fill(mesh);

  Traffic traffic;
  for (int step = 0; step < 20; ++step) traffic += flow.step().traffic;

  if (comm.size() == 1) {
    EXPECT_EQ(traffic.rounds, 0);
    EXPECT_EQ(traffic.messages, 0);
  } else {
    EXPECT_GE(traffic.rounds, 20);
    EXPECT_LE(traffic.rounds, 22);
    EXPECT_LE(traffic.reductions, 42);
  }
}

TEST(Flow, RunsWithCollisionsInflowAndDiffuseWallsAreBitEqualOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto block = test::random_mesh(comm, 5, 4);
  const auto mesh = assemble::assemble(comm, block), whole = assemble::assemble(alone, test::gather(comm, block));
  const auto setup_for = [](const mesh::DistMesh& some) {
    auto setup = open_cube(some, {"wind", 1e20, 300, 300, {500, 100, 0}, {1}}, 20, 1e-4);
    setup.patch[static_cast<std::size_t>(patch_named(some, "ymin"))] = {Kind::diffuse, 500, {}, 0.7, 1, 1, 1, -1};
    setup.patch[static_cast<std::size_t>(patch_named(some, "zmax"))] = {Kind::cll, 200, {100, 0, 0}, 1,
                                                                        0.5,       0.8, 1,           -1};
    return setup;
  };
  Flow flow(comm, mesh, setup_for(mesh)), serial(alone, whole, setup_for(whole));
  flow.fill(mesh);
  serial.fill(whole);
  ASSERT_EQ(fingerprint(flow), fingerprint(serial));
  flow.start_sampling();
  serial.start_sampling();

  std::int64_t collisions = 0;
  for (int step = 0; step < 15; ++step) {
    flow.step();
    collisions += serial.step().collided.collisions;
    ASSERT_EQ(fingerprint(flow), fingerprint(serial)) << "step " << step;
  }

  EXPECT_GT(collisions, 1000);
  std::int64_t push = 0, serial_push = 0;
  for (const auto& face : flow.end_block()) push += face.momentum[1];
  for (const auto& face : serial.end_block()) serial_push += face.momentum[1];
  EXPECT_NE(serial_push, 0);
  EXPECT_EQ(comm.sum(push), serial_push);
  EXPECT_EQ(flow.lost(), 0);
}

TEST(Flow, EquilibriumCollidesAsOftenAsKineticTheorySays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 6));
  const auto gas = test::argon();
  const double density = 7.07043e22, dt = 7e-9;
  Flow flow(comm, mesh, test::box_of(gas, mesh, 1e-4, 15, density, 273.15, 273.15, dt));
  flow.fill(mesh);
  const auto before = totals(flow);
  const double real_density = before.n * flow.setup().fnum / 1e-12;
  const double expected = 0.5 * collision_frequency(gas.species[0], real_density, before.t_tr()) * dt;
  EXPECT_NEAR(collision_frequency(gas.species[0], density, 273.15), 2.01953e7, 1e2);

  for (int step = 0; step < 30; ++step) flow.step();  // let the numbers in the cells become random
  constexpr int n_steps = 250;
  std::int64_t collisions = 0;
  for (int step = 0; step < n_steps; ++step) collisions += flow.step().collided.collisions;

  const auto all = static_cast<double>(comm.sum(collisions));
  const double found = all / before.n / n_steps;
  EXPECT_NEAR(found / expected, 1, 4 / std::sqrt(all)) << found << " and not " << expected;
  const auto after = totals(flow);
  EXPECT_EQ(after.n, before.n);
  EXPECT_NEAR(after.translational / before.translational, 1, 1e-12);
}

TEST(Flow, PartnersOfTheSameSubCellAreBitEqualOnAnyNumberOfRanksAndCloserThanRandomOnes) {
  using Partner = CollisionOptions::Partner;
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto block = test::random_mesh(comm, 3, 3);
  const auto mesh = assemble::assemble(comm, block), whole = assemble::assemble(alone, test::gather(comm, block));
  const auto setup_for = [](const mesh::DistMesh& some, Partner partner) {
    auto setup = test::box_of(test::nitrogen(), some, 1e-4, 400, 7e22, 300, 200, 7e-9);
    setup.collisions.partner = partner;
    return setup;
  };
  Flow flow(comm, mesh, setup_for(mesh, Partner::subcell)), twin(alone, whole, setup_for(whole, Partner::subcell)),
      nearest(comm, mesh, setup_for(mesh, Partner::nearest)), any(comm, mesh, setup_for(mesh, Partner::any));
  const auto separation = [](const Flow& some) {
    double sum = 0;
    std::int64_t n = 0;
    for (const auto& cell : some.collisions) sum += cell.separation * 1e12, n += cell.collisions;
    return static_cast<double>(some.comm().sum(static_cast<std::int64_t>(sum))) /
           static_cast<double>(some.comm().sum(n));
  };
  for (auto* one : {&flow, &nearest, &any}) one->fill(mesh);
  twin.fill(whole);

  for (int step = 0; step < 10; ++step) {
    for (auto* one : {&flow, &nearest, &any}) one->step();
    twin.step();
    ASSERT_EQ(fingerprint(flow), fingerprint(twin)) << "step " << step;
  }

  EXPECT_GT(separation(flow), 1.2 * separation(nearest));  // not all cells have too few particles for sub-cells
  EXPECT_LT(separation(flow), 2 * separation(nearest));
  EXPECT_GT(separation(any), 3 * separation(nearest));
}

TEST(Flow, SoftSpheresAndRandomPartnersCollideAsOftenToo) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 5));
  auto gas = test::argon();
  gas.species[0].alpha = 1.4;
  prepare(gas);
  auto setup = test::box_of(gas, mesh, 1e-4, 20, 7.07043e22, 273.15, 273.15, 7e-9);
  setup.collisions.partner = CollisionOptions::Partner::any;
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  const auto before = totals(flow);
  const double expected =
      0.5 * collision_frequency(gas.species[0], before.n * setup.fnum / 1e-12, before.t_tr()) * 7e-9;

  for (int step = 0; step < 30; ++step) flow.step();
  constexpr int n_steps = 200;
  std::int64_t collisions = 0;
  for (int step = 0; step < n_steps; ++step) collisions += flow.step().collided.collisions;

  const auto all = static_cast<double>(comm.sum(collisions));
  EXPECT_NEAR(all / before.n / n_steps / expected, 1, 4 / std::sqrt(all));
  EXPECT_NEAR(totals(flow).translational / before.translational, 1, 1e-12);
}

TEST(Flow, RotationRelaxesAsTheProbabilityPerMoleculeSays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 7));
  const auto gas = test::nitrogen();
  const double tau = 2.43426e-7, dt = 0.2 * tau;
  Flow flow(comm, mesh, test::box_of(gas, mesh, 2e-3, 30, 1e22, 500, 100, dt));
  flow.fill(mesh);
  const auto before = totals(flow);
  double t_tr = before.t_tr(), t_rot = before.t_rot(2);
  const double total = 3 * t_tr + 2 * t_rot, real_density = before.n * flow.setup().fnum / 8e-9;

  for (int step = 1; step <= 60; ++step) {
    flow.step();
    for (int part = 0; part < 20; ++part) {  // d T_r / dt = nu P zt / (zt + 2) (T_t - T_r)
      const double zt = 5 - 2 * 0.74;
      t_rot += dt / 20 * collision_frequency(gas.species[0], real_density, t_tr) * 0.2 * zt / (zt + 2) * (t_tr - t_rot);
      t_tr = (total - 2 * t_rot) / 3;
    }
    if (step % 20 != 0) continue;
    const auto now = totals(flow);
    const double bar = 4 * t_rot / std::sqrt(now.n) + 0.3;
    EXPECT_NEAR(now.t_rot(2), t_rot, bar) << "after " << step * 0.2 << " collision times";
    EXPECT_NEAR((now.translational + now.rotational) / (before.translational + before.rotational), 1, 1e-12);
  }
}

TEST(Flow, RotationWhoseRateGoesByTheTemperatureComesToEquilibrium) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 6));
  auto gas = test::nitrogen();
  gas.rotation = {Rotation::Model::variable, 0, 18.1, 91.5};
  const double tau = 2.43426e-7, dt = 0.3 * tau;
  Flow flow(comm, mesh, test::box_of(gas, mesh, 2e-3, 30, 1e22, 500, 100, dt));
  flow.fill(mesh);
  const auto before = totals(flow);
  double t_tr = before.t_tr(), t_rot = before.t_rot(2), clamped = 0;
  const double total = 3 * t_tr + 2 * t_rot, real_density = before.n * flow.setup().fnum / 8e-9;

  for (int step = 1; step <= 60; ++step) {
    clamped += static_cast<double>(flow.step().collided.clamped);
    for (int part = 0; part < 20; ++part) {  // as with one probability, which now falls with the temperature
      const double zt = 5 - 2 * 0.74, chance = relaxation_probability(gas.rotation, 2, 0.74, t_tr);
      t_rot +=
          dt / 20 * collision_frequency(gas.species[0], real_density, t_tr) * chance * zt / (zt + 2) * (t_tr - t_rot);
      t_tr = (total - 2 * t_rot) / 3;
    }
    if (step % 20 != 0) continue;
    // The cells' temperatures are smoothed over 50 steps: the chance lags a little.
    EXPECT_NEAR(totals(flow).t_rot(2), t_rot, 4 * t_rot / std::sqrt(before.n) + 1.5) << step;
  }
  EXPECT_EQ(clamped, 0);

  double rotational = 0, translational = 0;
  for (int step = 0; step < 120; ++step) {
    flow.step();
    const auto now = totals(flow);
    rotational += now.t_rot(2) / 120;
    translational += now.t_tr() / 120;
  }
  EXPECT_NEAR(rotational / translational, 1, 4 * std::sqrt(5.0 / 3 / before.n / 8) + 0.003);
}

TEST(Flow, ColdRotationIsHeldToOneRelaxingMoleculeInTwoAndCounted) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  auto gas = test::nitrogen();
  gas.rotation = {Rotation::Model::variable, 0, 18.1, 91.5};
  EXPECT_GT(relaxation_probability(gas.rotation, 2, 0.74, 13.6), 1);
  EXPECT_LT(relaxation_probability(gas.rotation, 2, 0.74, 300), 0.5);
  Flow flow(comm, mesh, test::box_of(gas, mesh, 2e-3, 30, 1e22, 13.6, 13.6, 2e-7));
  flow.fill(mesh);
  const auto before = totals(flow);

  std::int64_t collisions = 0, clamped = 0;
  for (int step = 0; step < 60; ++step) {
    const auto counts = flow.step().collided;
    collisions += counts.collisions;
    clamped += counts.clamped;
  }

  EXPECT_GT(comm.sum(collisions), 10000);
  EXPECT_EQ(comm.sum(clamped), comm.sum(collisions));
  const auto after = totals(flow);
  EXPECT_NEAR((after.translational + after.rotational) / (before.translational + before.rotational), 1, 1e-12);
  EXPECT_NEAR(after.t_rot(2) / after.t_tr(), 1, 4 * std::sqrt(5.0 / 3 / before.n));
}

TEST(Flow, AMixtureComesToOneTemperature) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 6));
  Gas gas;
  gas.species = {{"Ar", 6.63e-26, 4.17e-10, 0.81, 273, 1, 0}, {"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  gas.fraction = {0.4, 0.6};
  prepare(gas);
  Flow flow(comm, mesh, test::box_of(gas, mesh, 2e-3, 30, 1e22, 400, 100, 1e-7));
  flow.fill(mesh);
  const auto before = totals(flow);

  for (int step = 0; step < 120; ++step) flow.step();
  flow.start_sampling();
  for (int step = 0; step < 20; ++step) flow.step();

  const double t = (before.translational + before.rotational) / (boltzmann * before.n * (1.5 + 0.6));
  std::array<double, 2> n{}, square{}, rotation{};
  for (std::size_t i = 0; i < flow.cells.sums.size(); ++i) {
    n[i % 2] += flow.cells.sums[i].n;
    square[i % 2] += flow.cells.sums[i].square;
    rotation[i % 2] += flow.cells.sums[i].rotation;
  }
  for (std::size_t s = 0; s < 2; ++s) {
    const double count = static_cast<double>(comm.sum(static_cast<std::int64_t>(n[s])));
    const auto sum = [&](double value) { return par::reproducible_sum(comm, std::vector<double>{value}); };
    const double independent = count / 20;  // the sampled steps are hardly independent
    const double bar = 4 * std::sqrt(2.0 / 3.0 / independent) + 0.001;
    EXPECT_NEAR(sum(square[s]) * gas.species[s].mass / (3 * boltzmann * count) / t, 1, bar) << gas.species[s].name;
    if (s == 1) {
      EXPECT_NEAR(sum(rotation[s]) / (boltzmann * count) / t, 1, 4 / std::sqrt(independent) + 0.001);
    }
  }
}

TEST(Flow, GasEntersAnEmptyBoxWithTheFluxesOfAMaxwellian) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  const auto gas = test::nitrogen();
  const double c = most_probable_speed(300, gas.species[0].mass), root = std::sqrt(std::numbers::pi);
  for (const double s : {0.0, 1.0, 5.0, -1.0, -2.0}) {
    auto setup = open_cube(mesh, {"wind", 1e20, 300, 200, {s * c, 0.5 * c, 0}, {1}}, 400, 1e-4);
    for (auto& patch : setup.patch) patch = {Kind::outflow, 0, {}, 1, 1, 1, 1, -1};
    setup.patch[static_cast<std::size_t>(patch_named(mesh, "xmin"))] = {Kind::inflow, 0, {}, 1, 1, 1, 1, 0};
    setup.initial = -1;
    if (s < 0) setup.fnum /= 20;
    Flow flow(comm, mesh, setup);
    const MoveRules rules{&flow.domain(), &flow.setup().gas, flow.setup().patch, 3};
    const Inflow inflow(comm, rules, flow.setup().stream);
    std::vector<Flight> entering;

    for (std::uint64_t step = 0; step < 8; ++step) inflow.draw(step, entering);

    double number = 0, push = 0, drag = 0, heat = 0, rotation = 0, number_squared_push = 0;
    for (const auto& flight : entering) {
      const auto& p = flight.particle;
      number += 1;
      push += p.velocity.x / c;
      number_squared_push += p.velocity.x * p.velocity.x / c / c;
      drag += p.velocity.y / c;
      heat += squared_norm(p.velocity) / c / c;
      rotation += p.rotation / (boltzmann * 200);
      EXPECT_GE(p.velocity.x, 0);
    }
    const double all = static_cast<double>(comm.sum(static_cast<std::int64_t>(number)));
    const auto mean = [&](double value) { return par::reproducible_sum(comm, std::vector<double>{value}) / all; };
    const double per_step = molecular_flux(1e20, 300, gas.species[0].mass, s * c) * 1e-4 / setup.fnum;
    const double error = 4 / std::sqrt(all), chi = flux_factor(s), gauss = std::exp(-s * s), up = 1 + std::erf(s);
    EXPECT_NEAR(all / 8 / per_step, 1, 4 / std::sqrt(8.0 * 32) * 32 / per_step) << s;  // 32 faces, rounded at random
    EXPECT_NEAR(mean(push), (s * gauss + root * (0.5 + s * s) * up) / chi,
                error * std::sqrt(mean(number_squared_push)));
    EXPECT_NEAR(mean(drag), 0.5, error);
    const double energy = ((s * s + 1) * gauss + root * s * (s * s + 1.5) * up) / chi + 1.25;  // 1 and 0.25 across
    EXPECT_NEAR(mean(heat) / energy, 1, error);
    EXPECT_NEAR(mean(rotation), 1, error);
  }
}

TEST(Flow, AUniformStreamStaysUniformWhereTheTimeStepVaries) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 9, 4));
  const auto gas = test::nitrogen();
  const double c = most_probable_speed(300, gas.species[0].mass);
  auto setup = open_cube(mesh, {"wind", 1e20, 300, 300, {c, 0.3 * c, 0}, {1}}, 60, 2e-4);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corner = corners(mesh, 1, cell);
    setup.cell_dt.push_back(corner[0].x + corner[1].x + corner[2].x + corner[3].x < 2 ? 2e-4 : 0.5e-4);
  }
  setup.collisions.enabled = false;
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  for (int step = 0; step < 100; ++step) flow.step();
  flow.start_sampling();
  for (int step = 0; step < 60; ++step) flow.step();

  // Real molecules, momentum and energy in each half.
  for (const bool left : {true, false}) {
    double volume = 0, molecules = 0, velocity = 0, square = 0, count = 0;
    for (std::size_t i = 0; i < setup.cell_dt.size(); ++i) {
      if ((setup.cell_dt[i] > 1e-4) != left) continue;
      const auto& sums = flow.cells.sums[i];
      volume += flow.domain().volume[i];
      molecules += sums.n / 60 * flow.domain().fnum[i];
      velocity += sums.velocity.x;
      square += sums.square;
      count += sums.n;
    }
    const auto sum = [&](double value) { return par::reproducible_sum(comm, std::vector<double>{value}); };
    const double n = sum(count);
    const double independent = n / 10;  // a particle stays for some steps
    EXPECT_NEAR(sum(molecules) / sum(volume) / 1e20, 1, 4 / std::sqrt(independent)) << left;
    EXPECT_NEAR(sum(velocity) / n / c, 1, 4 / std::sqrt(independent)) << left;
    EXPECT_NEAR(sum(square) / n / (c * c * (1.5 + 1.09)), 1, 4 / std::sqrt(independent)) << left;
  }
}

TEST(Flow, AFreeMolecularStreamPressesRubsAndHeatsAPlateAsTheClosedFormsSay) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  const auto gas = test::nitrogen();
  const double c = most_probable_speed(200, gas.species[0].mass), s = 5, density = 1e20;
  for (const double angle : {90.0, 20.0, 0.0}) {
    const double theta = angle * std::numbers::pi / 180;
    auto setup = open_cube(
        mesh, {"wind", density, 200, 200, {s * c * std::sin(theta), s * c * std::cos(theta), 0}, {1}}, 60, 1e-4);
    const auto wall = patch_named(mesh, "xmax");
    setup.patch[static_cast<std::size_t>(wall)] = {Kind::diffuse, 200, {}, 1, 1, 1, 1, -1};
    setup.collisions.enabled = false;
    Flow flow(comm, mesh, setup);
    flow.fill(mesh);
    for (int step = 0; step < 30; ++step) flow.step();
    flow.start_sampling();
    constexpr int n_steps = 100;
    for (int step = 0; step < n_steps; ++step) flow.step();

    std::int64_t hits = 0, push = 0, rub = 0, heat = 0;
    for (std::size_t f = 0; f < flow.surface.face.size(); ++f) {
      if (flow.domain().boundary[f].patch != wall) continue;
      hits += flow.surface.face[f].hits;
      push += flow.surface.face[f].momentum[0];
      rub += flow.surface.face[f].momentum[1];
      heat += flow.surface.face[f].energy;
    }
    const auto closed = test::free_molecular_plate(s, theta, 1, 2);
    const double scale = setup.fnum / (n_steps * setup.dt), rho = density * gas.species[0].mass, v = s * c;
    const auto sum = [&](std::int64_t fixed) { return static_cast<double>(comm.sum(fixed)); };
    const double error = 4 / std::sqrt(sum(hits)), q = 0.5 * rho * v * v;
    EXPECT_NEAR(sum(push) * flow.surface.momentum_unit * scale / q / closed.pressure, 1, error) << angle;
    EXPECT_NEAR(sum(rub) * flow.surface.momentum_unit * scale / q, closed.shear, error * (closed.shear + 0.4)) << angle;
    EXPECT_NEAR(sum(heat) * flow.surface.energy_unit * scale / (q * v) / closed.heat, 1, 2 * error) << angle;
  }
}

TEST(Flow, RefusesATimeStepOrAWeightThatIsNotPositive) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 1));
  auto setup = test::box_of(test::argon(), mesh, 1, 10, 1e20, 300, 300, 1e-6);
  setup.dt = -1;
  EXPECT_THROW(Flow(comm, mesh, setup), Error);
  setup.dt = 1e-6;
  setup.fnum = 0;
  EXPECT_THROW(Flow(comm, mesh, setup), Error);
}

TEST(Flow, TellsEveryRankBeforeItBeginsThatTooManyParticlesWouldEnterThroughAFaceOfOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 1));
  auto setup = open_cube(mesh, {"wind", 1e20, 300, 300, {500, 0, 0}, {1}}, 1, 1e-4);
  for (auto& patch : setup.patch) patch = {Kind::outflow, 0, {}, 1, 1, 1, 1, -1};
  setup.patch[static_cast<std::size_t>(patch_named(mesh, "xmin"))] = {Kind::inflow, 0, {}, 1, 1, 1, 1, 0};
  setup.fnum = 1e20 * 500 * 1e-4 / 40000;  // 20,000 particles through each half of the side

  try {
    const Flow flow(comm, mesh, setup);
    ADD_FAILURE() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("through each inflow face"), std::string::npos) << error.what();
  }
}

TEST(Flow, TellsEveryRankWhenTheSumsOnAFaceOfOneAreNearlyFull) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  auto setup = open_cube(mesh, {"wind", 1e20, 300, 300, {500, 0, 0}, {1}}, 400, 1e-4);
  for (auto& patch : setup.patch) patch = {Kind::diffuse, 300, {}, 1, 1, 1, 1, -1};
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  flow.step();
  const bool has_it = comm.rank() == comm.size() - 1 && !flow.surface.face.empty();
  if (has_it) flow.surface.face.front().energy = (std::int64_t{1} << 61U) + (std::int64_t{1} << 60U);
  if (!comm.any(has_it)) FAIL() << "the last rank has no face";

  try {
    for (int step = 0; step < 100; ++step) flow.step();  // until there have been many hits on walls of that rank
    ADD_FAILURE() << "the steps were done";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("more than can be added up"), std::string::npos) << error.what();
  }
}

TEST(Tally, IsNearlyFullBeforeASumOverflows) {
  SurfaceTally tally;
  tally.face.resize(3);
  tally.set_units(1, 1);

  tally.add(1, {0x1p30, 0, 0}, 0);  // 2^60 units
  EXPECT_FALSE(tally.is_nearly_full());
  tally.add(1, {0x1p30, 0, 0}, 0);
  tally.add(1, {0x1p30, 0, 0}, 0);
  EXPECT_TRUE(tally.is_nearly_full());
}

}  // namespace flow_test
