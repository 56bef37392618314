// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that change under a gas.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mark/criteria.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/run/adapt_mesh.hpp"
#include "solvers/dsmc/sampling/density_scale.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/transfer_particles.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace {

using namespace pamr;
using namespace pamr::dsmc;

/// Argon with a trace whose particles weigh less, so that cells owe energy.
Gas argon_with_trace() {
  Gas gas;
  gas.species = {{"Ar", 6.63e-26, 4.17e-10, 0.81, 273, 1, 0, 1}, {"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2, 0.1}};
  gas.fraction = {0.9, 0.1};
  prepare(gas);
  return gas;
}

/// Places, velocities and kinds of all particles of all ranks, whatever their order and cells.
std::int64_t contents(const par::Comm& comm, const Flow& flow) {
  std::uint64_t sum = 0;
  const auto& p = flow.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint64_t h = p.species[i];
    for (const double value : {p.x[i], p.y[i], p.z[i], p.u[i], p.v[i], p.w[i], p.rotation[i]})
      h = combine(h, bits_of(value));
    sum += h;
  }
  return comm.sum(static_cast<std::int64_t>(sum));
}

double owed(const par::Comm& comm, const Flow& flow) {
  double sum = 0;
  for (const auto& cell : flow.collisions) sum += cell.energy_deficit;
  double all = 0;
  for (const double one : comm.all_gather(sum)) all += one;
  return all;
}

bool all_are_inside(const Flow& flow) {
  for (std::size_t i = 0; i < flow.particles.size(); ++i)
    if (!is_inside(flow.domain(), flow.particles.cell[i], flow.particles.position(i), 1e-12)) return false;
  return true;
}

/// The flow on the mesh after it was adapted; the mesh is replaced.
Transferred adapted(const par::Comm& comm, const char* marks, mesh::DistMesh& mesh, std::optional<Flow>& flow) {
  Adaptation how;
  how.every = 1;
  how.request = mark::read_request(mark::split_options(marks));
  RunState run;
  run.face.resize(flow->domain().boundary.size());
  auto snapshot = take_snapshot(comm, key_of(comm, mesh), run, *flow);
  OldFlow old{"here", std::move(snapshot.cells), std::move(snapshot.particles), {1, 0.1}, true, flow->steps_done};
  auto result = adapt_mesh(comm, std::move(mesh), how, {}, "here");
  mesh = std::move(result.mesh);
  auto setup = flow->setup();
  flow.emplace(comm, mesh, std::move(setup));
  return transfer_particles(comm, old, result.gone, mesh, *flow);
}

TEST(AdaptMesh, EveryParticleKeepsItsPlaceThroughRefiningAndCoarsening) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  std::optional<Flow> flow;
  flow.emplace(comm, mesh, test::box_of(argon_with_trace(), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7));
  flow->fill(mesh);
  const char* nowhere = "--box 9,9,9,9,9,9 --coarsen-rest";
  for (const char* marks : {"--crossing-sphere 0,0,0,0.5 --coarsen-rest", "--crossing-sphere 0,0,0,0.7 --coarsen-rest",
                            "--crossing-sphere 0,0,0,0.9 --coarsen-rest", "--crossing-sphere 1,1,1,0.4 --coarsen-rest",
                            nowhere, nowhere, nowhere}) {
    flow->step();
    const auto before = contents(comm, *flow);
    const double owed_before = owed(comm, *flow);
    const auto n = flow->n_particles();

    const auto transferred = adapted(comm, marks, mesh, flow);

    EXPECT_EQ(contents(comm, *flow), before) << marks;
    EXPECT_EQ(transferred.removed, 0);
    EXPECT_EQ(transferred.old_particles, n);
    EXPECT_EQ(transferred.new_particles, n);
    EXPECT_TRUE(all_are_inside(*flow));
    ASSERT_NE(owed_before, 0);
    EXPECT_NEAR(owed(comm, *flow), owed_before, 1e-12 * std::fabs(owed_before));
    EXPECT_TRUE(validate::validate(comm, mesh).empty());
  }
  EXPECT_EQ(mesh.info.n_global_cells, 6 * 27);
}

TEST(AdaptMesh, ParticlesOfManyRoundsAreTakenPutBackAndMovedLikeThoseOfOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  std::optional<Flow> flow;
  const auto setup = test::box_of(argon_with_trace(), mesh, 2e-3, 800, 1e22, 400, 100, 2e-7);
  flow.emplace(comm, mesh, setup);
  flow->fill(mesh);
  flow->step();
  ASSERT_GT(comm.max(static_cast<std::int64_t>(flow->particles.size())), std::int64_t{particles_of_round});
  const auto before = contents(comm, *flow);
  RunState run;
  run.face.resize(flow->domain().boundary.size());

  const auto snapshot = take_snapshot(comm, key_of(comm, mesh), run, *flow);
  Flow back(comm, mesh, setup);
  restore(comm, snapshot, back);
  const auto again = take_snapshot(comm, key_of(comm, mesh), run, back);

  EXPECT_EQ(contents(comm, back), before);
  EXPECT_EQ(again.particles.block, snapshot.particles.block);
  EXPECT_EQ(again.cells.block, snapshot.cells.block);
  const auto n = flow->n_particles();
  const auto transferred = adapted(comm, "--crossing-sphere 0,0,0,0.7", mesh, flow);
  EXPECT_EQ(contents(comm, *flow), before);
  EXPECT_EQ(transferred.new_particles, n);
  EXPECT_TRUE(all_are_inside(*flow));
  const auto begin = flow->particles.begin();
  for (std::size_t i = 1; i < flow->particles.size(); ++i) EXPECT_LT(flow->particles.id[i - 1], flow->particles.id[i]);
  EXPECT_EQ(begin.back(), flow->particles.size());
}

TEST(DensityScale, IsTheLengthOfAnExponentialAndEndlessWhereNothingChanges) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 10));
  constexpr double length = 0.4;
  std::vector<double> density, x;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    x.push_back(0.25 * (p[0].x + p[1].x + p[2].x + p[3].x));
    density.push_back(1e20 * std::exp(x.back() / length));
  }

  const auto scale = density_scale(comm, mesh, density);

  for (std::size_t c = 0; c < scale.size(); ++c)
    if (x[c] > 0.15 && x[c] < 0.85) {
      EXPECT_NEAR(scale[c], length, 0.08 * length) << x[c];
    }
  for (const double one : density_scale(comm, mesh, std::vector<double>(x.size(), 3e19))) EXPECT_GT(one, 1e9);
  for (const double one : density_scale(comm, mesh, std::vector<double>(x.size(), 0.0))) EXPECT_EQ(one, 1e30);
}

TEST(SplitOptions, RefusesWhatIsNoCriterion) {
  EXPECT_EQ(mark::split_options(" --all  --max-level 2 ").size(), 2U);
  EXPECT_THROW(mark::split_options("--all yes"), Error);
  EXPECT_THROW(mark::split_options("--field n --above"), Error);
  EXPECT_THROW(mark::split_options("--max-cells 5"), Error);
}

}  // namespace
