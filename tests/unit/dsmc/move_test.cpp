// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/move.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "solvers/dsmc/kernel/halo.hpp"
#include "support/meshes.hpp"

namespace move_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;

Gas nitrogen() {
  Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  gas.fraction = {1};
  prepare(gas);
  return gas;
}

/// A mesh with particles in it and what moves them.
struct Box {
  Box(const par::Comm& on, const mesh::BlockMesh& block, double dt, BoundaryCondition wall = {})
      : comm(&on), mesh(assemble::assemble(on, block)), domain(make_gas_domain(mesh, 1, dt, 1)), gas(nitrogen()) {
    add_border();
    patch.assign(mesh.info.patches.size(), wall);
    tally.face.resize(domain.boundary.size());
    tally.set_units(4.65e-26, 1);
  }
  void add_border() {
    add_halo(*comm, domain);
    border.emplace(domain);
  }
  MoveCounts step() {
    const MoveRules rules{&domain, &gas, patch, 7, n_steps++};
    const auto counts = move(*comm, rules, particles, entering, {*border, tally});
    particles.sort_by_cell(domain.n_cells());
    return counts;
  }
  std::int64_t n_particles() const { return comm->sum(static_cast<std::int64_t>(particles.size())); }
  /// Of all particles with all their bits, whatever their order and their ranks.
  std::int64_t fingerprint() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      std::uint64_t h = particles.id[i];
      for (const double value : {particles.x[i], particles.y[i], particles.z[i], particles.u[i], particles.v[i],
                                 particles.w[i], particles.rotation[i]})
        h = combine(h, bits_of(value));
      sum += combine(h, static_cast<std::uint64_t>(domain.cell_global[static_cast<std::size_t>(particles.cell[i])]));
    }
    return comm->sum(static_cast<std::int64_t>(sum));
  }
  bool all_inside(double tolerance) const {
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (!is_inside(domain, particles.cell[i], particles.position(i), tolerance)) return false;
    return true;
  }

  const par::Comm* comm;
  mesh::DistMesh mesh;
  GasDomain domain;
  std::optional<BorderExchange> border;
  Gas gas;
  std::vector<BoundaryCondition> patch;
  Particles particles;
  std::vector<Flight> entering;
  SurfaceTally tally;
  std::uint64_t n_steps = 0;
};

/// `per_cell` particles in each cell, drawn by the cell's global number, speed about 1.
void fill(Box& box, std::uint32_t per_cell) {
  for (LocalId cell = 0; cell < box.domain.n_cells(); ++cell) {
    const auto global = static_cast<std::uint64_t>(box.domain.cell_global[static_cast<std::size_t>(cell)]);
    const auto corner = corners(box.mesh, 1, cell);
    Random random(1, Purpose::seed, global, 0);
    for (std::uint32_t k = 0; k < per_cell; ++k) {
      double weight[4], sum = 0;
      for (auto& w : weight) sum += w = -std::log(random.uniform());
      Particle p;
      for (std::size_t i = 0; i < 4; ++i) p.position = p.position + (weight[i] / sum) * corner[i];
      const auto [a, b] = random.normal_pair();
      p.velocity = {a, b, random.normal_pair().a};
      p.id = global * per_cell + k;
      p.cell = cell;
      box.particles.append(p);
    }
  }
  box.particles.sort_by_cell(box.domain.n_cells());
}

/// Where a point of the line comes to lie in [0, 1] between two mirrors.
double folded(double x) {
  const double turns = std::fabs(std::fmod(x, 2.0));
  return turns > 1 ? 2 - turns : turns;
}

BoundaryCondition diffuse(double temperature) {
  BoundaryCondition wall;
  wall.kind = BoundaryCondition::Kind::diffuse;
  wall.temperature = temperature;
  return wall;
}

TEST(Move, AMillionFlightsInAMirroredBoxEndWhereTheStraightLineDoesAndLoseNoParticle) {
  const par::Comm comm(MPI_COMM_WORLD);
  Box box(comm, test::random_mesh(comm, 3, 5), 0.35);  // 750 cells
  fill(box, 134);
  const auto n = box.n_particles();
  ASSERT_GE(10 * n, 1000000);
  std::vector<Vec3> start(static_cast<std::size_t>(n)), velocity(static_cast<std::size_t>(n));
  double worst = 0;

  for (int step = 0; step < 10; ++step) {
    // Every particle's place is sent to all ranks' owners by its id: gather what this rank holds before the step.
    std::vector<double> before(static_cast<std::size_t>(6 * n), 0);
    for (std::size_t i = 0; i < box.particles.size(); ++i) {
      const auto at = 6 * box.particles.id[i];
      const Vec3 x = box.particles.position(i), v = box.particles.velocity(i);
      const double row[] = {x.x, x.y, x.z, v.x, v.y, v.z};
      std::copy(row, row + 6, before.begin() + static_cast<std::ptrdiff_t>(at));
    }
    std::vector<std::int64_t> bits(before.size());
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = static_cast<std::int64_t>(bits_of(before[i]));
    comm.sum_in_place(bits);

    const auto counts = box.step();

    EXPECT_EQ(counts.stuck, 0);
    EXPECT_EQ(box.n_particles(), n);
    EXPECT_TRUE(box.all_inside(1e-14));
    for (std::size_t i = 0; i < box.particles.size(); ++i) {
      const auto at = 6 * box.particles.id[i];
      const auto value = [&](std::size_t k) { return std::bit_cast<double>(bits[at + k]); };
      const Vec3 x = box.particles.position(i);
      worst = std::max({worst, std::fabs(x.x - folded(value(0) + 0.35 * value(3))),
                        std::fabs(x.y - folded(value(1) + 0.35 * value(4))),
                        std::fabs(x.z - folded(value(2) + 0.35 * value(5)))});
    }
  }

  EXPECT_LT(comm.max(worst), 1e-12);
}

TEST(Move, ParticlesAimedAtCornersAlongEdgesAndInFacesArriveWhereTheyAreAimed) {
  const par::Comm comm(MPI_COMM_WORLD);
  Box box(comm, test::kuhn_cube(comm, 4), 1);
  std::uint64_t id = 0;
  std::vector<Vec3> target;
  for (int i = 0; i <= 8; ++i)  // all points of a lattice of half cells: corners, middles of edges, of faces, of cells
    for (int j = 0; j <= 8; ++j)
      for (int k = 0; k <= 8; ++k) target.push_back({i / 8.0, j / 8.0, k / 8.0});
  for (LocalId cell = 0; cell < box.domain.n_cells(); cell += 5) {
    const auto corner = corners(box.mesh, 1, cell);
    for (const auto& to : target) {
      Particle p;
      // From a corner of the cell, from the middle of an edge, from the middle of the cell.
      p.position = id % 3 == 0   ? corner[id % 4]
                   : id % 3 == 1 ? midpoint(corner[0], corner[1 + id % 2])
                                 : midpoint(midpoint(corner[0], corner[1]), midpoint(corner[2], corner[3]));
      p.velocity = to - p.position;
      p.rotation = static_cast<double>(id % target.size());
      p.id = id++;
      p.cell = cell;
      box.particles.append(p);
    }
  }
  const auto n = box.n_particles();

  const auto counts = box.step();

  EXPECT_EQ(counts.stuck, 0);
  EXPECT_EQ(box.n_particles(), n);
  EXPECT_TRUE(box.all_inside(1e-15));
  for (std::size_t i = 0; i < box.particles.size(); ++i) {
    const auto& to = target[static_cast<std::size_t>(box.particles.rotation[i])];
    EXPECT_LT(norm(box.particles.position(i) - to), 1e-15);
  }
}

TEST(Move, ParticlesAimedExactlyAtCornersOfAnIrregularMeshAreNeverLost) {
  const par::Comm comm(MPI_COMM_WORLD);
  Box box(comm, test::random_mesh(comm, 11, 4), 3);  // beyond the corner they are aimed at, off the walls and on
  std::uint64_t id = 0;
  for (LocalId cell = 0; cell < box.domain.n_cells(); ++cell) {
    const auto corner = corners(box.mesh, 1, cell);
    const Vec3 middle = midpoint(midpoint(corner[0], corner[1]), midpoint(corner[2], corner[3]));
    for (LocalId node = 0; node < box.mesh.n_nodes(); ++node) {
      Particle p;
      p.position = middle;
      p.velocity = box.mesh.point(node) - middle;
      p.id = id++;
      p.cell = cell;
      box.particles.append(p);
    }
  }
  const auto n = box.n_particles();

  for (int step = 0; step < 3; ++step) {
    const auto counts = box.step();
    EXPECT_EQ(counts.stuck, 0);
  }

  EXPECT_EQ(box.n_particles(), n);
  EXPECT_TRUE(box.all_inside(1e-13));
}

TEST(Move, TrajectoriesBetweenDiffuseWallsAreBitEqualOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto block = test::random_mesh(comm, 5, 4);
  Box box(comm, block, 0.2, diffuse(1e-3)), serial(alone, test::gather(comm, block), 0.2, diffuse(1e-3));
  fill(box, 20);
  fill(serial, 20);
  ASSERT_EQ(box.fingerprint(), serial.fingerprint());

  for (int step = 0; step < 20; ++step) {
    box.step();
    serial.step();
    ASSERT_EQ(box.fingerprint(), serial.fingerprint()) << "step " << step;
  }

  std::int64_t hits = 0, serial_hits = 0, energy = 0, serial_energy = 0;
  for (const auto& face : box.tally.face) hits += face.hits, energy += face.energy;
  for (const auto& face : serial.tally.face) serial_hits += face.hits, serial_energy += face.energy;
  EXPECT_GT(serial_hits, 10000);
  EXPECT_EQ(comm.sum(hits), serial_hits);
  EXPECT_EQ(comm.sum(energy), serial_energy);
}

TEST(Move, ATimeStepThatVariesFromCellToCellScalesTheTimeThatIsLeft) {
  const par::Comm comm(MPI_COMM_WORLD);
  Box box(comm, test::kuhn_cube(comm, 2), 1);
  box.domain = make_gas_domain(box.mesh, 1, 1, 1);
  box.domain.uniform_dt = false;
  for (LocalId cell = 0; cell < box.domain.n_cells(); ++cell) {  // half as long where x > 1/2
    const auto corner = corners(box.mesh, 1, cell);
    double x = 0;
    for (const auto& p : corner) x += p.x / 4;
    box.domain.dt[static_cast<std::size_t>(cell)] = x < 0.5 ? 1 : 0.5;
    if (x < 0.5)
      box.particles.append({0.25 * (corner[0] + corner[1] + corner[2] + corner[3]), {0.4, 0, 0}, 0, 1, cell});
  }
  box.add_border();
  for (std::size_t i = 0; i < box.particles.size(); ++i) {
    box.particles.id[i] =
        static_cast<std::uint64_t>(box.domain.cell_global[static_cast<std::size_t>(box.particles.cell[i])]);
    box.particles.rotation[i] = box.particles.x[i];
  }

  box.step();

  for (std::size_t i = 0; i < box.particles.size(); ++i) {
    const double straight = box.particles.rotation[i] + 0.4;
    EXPECT_NEAR(box.particles.x[i], straight < 0.5 ? straight : 0.5 + 0.5 * (straight - 0.5), 1e-14);
  }
  EXPECT_TRUE(box.all_inside(1e-14));
}

}  // namespace move_test
