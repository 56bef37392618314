// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that change under a gas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mark/criteria.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/run/adapt_mesh.hpp"
#include "solvers/dsmc/sampling/density_scale.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/transfer_particles.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace adapt_test {

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

/// All that the particles of all ranks carry, whatever their order and cells.
std::int64_t contents(const par::Comm& comm, const Flow& flow) {
  std::uint64_t sum = 0;
  const auto& p = flow.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint64_t h = combine(combine(p.species[i], p.id[i]), p.partner[i]);
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

/// How many different ids the particles of all ranks have. Collective.
std::int64_t n_different(const par::Comm& comm, const std::vector<std::uint64_t>& ids) {
  std::vector<par::Outgoing<std::uint64_t>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (const auto id : ids) messages[id % messages.size()].item.push_back(id);
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  const auto here = comm.sparse_exchange(messages).item;
  return comm.sum(static_cast<std::int64_t>(std::set<std::uint64_t>(here.begin(), here.end()).size()));
}

void expect_ids_in_order(const Flow& flow) {
  const auto& p = flow.particles;
  EXPECT_EQ(p.begin().back(), p.size());
  for (std::size_t i = 1; i < p.size(); ++i)
    if (p.cell[i - 1] == p.cell[i]) {
      EXPECT_LT(p.id[i - 1], p.id[i]);
    }
}

/// The flow on the mesh after it was adapted, with another F_num if one is given; the mesh is replaced.
Transferred adapted(const par::Comm& comm, const char* marks, mesh::DistMesh& mesh, std::optional<Flow>& flow,
                    double fnum = 0) {
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
  if (fnum > 0) setup.fnum = fnum;
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
    for (auto& cell : flow->collisions) cell.energy_deficit = 1e-20;  // as cells of few particles may keep it
    const auto before = contents(comm, *flow);
    const double owed_before = owed(comm, *flow);
    const auto n = flow->n_particles();

    const auto transferred = adapted(comm, marks, mesh, flow);

    EXPECT_EQ(contents(comm, *flow), before) << marks;
    EXPECT_EQ(transferred.removed, 0);
    EXPECT_EQ(transferred.old_particles, n);
    EXPECT_EQ(transferred.new_particles, n);
    EXPECT_TRUE(all_are_inside(*flow));
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
  expect_ids_in_order(*flow);
}

/// A flow whose cells and particles carry values of their own in every member: word k of the row of cell c is
/// `a value of (c, k)`, exact in a double.
double member(GlobalId cell, int k) { return 0.25 + 1e-3 * static_cast<double>(cell % 500) + static_cast<double>(k); }
void set_members(Flow& flow) {
  for (std::size_t c = 0; c < flow.collisions.size(); ++c) {
    const auto cell = flow.domain().cell_global[c];
    auto row = row_of(flow, c);
    row.collisions = {1e-15 * member(cell, 1), member(cell, 0), member(cell, 3),
                      member(cell, 4),         cell + 5,        1e-20 * member(cell, 6)};
    row.block = member(cell, 7);
    row.square_of_blocks = member(cell, 8);
    for (std::size_t s = 0; s < row.sums.size(); ++s) {
      const auto v = member(cell, 9 + 10 * static_cast<int>(s));
      row.sums[s] = {v, {v + 1, v + 2, v + 3}, v + 4, v + 5};
    }
    put(row, c, flow);
  }
  for (std::size_t i = 0; i < flow.particles.size(); ++i) {
    flow.particles.partner[i] = tag_of(7 * flow.particles.id[i]);
    flow.particles.rotation[i] = 1e-21 * static_cast<double>(flow.particles.id[i]);
  }
}

TEST(CellRow, EveryMemberSurvivesACheckpoint) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  const auto setup = test::box_of(argon_with_trace(), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7);
  const auto columns = columns_of(setup.gas);
  Flow flow(comm, mesh, setup), back(comm, mesh, setup);
  flow.fill(mesh);
  set_members(flow);
  RunState run;
  run.face.resize(flow.domain().boundary.size());

  restore(comm, take_snapshot(comm, key_of(comm, mesh), run, flow), back);

  EXPECT_EQ(contents(comm, back), contents(comm, flow));
  Flow unset(comm, mesh, setup);
  for (std::size_t c = 0; c < flow.collisions.size(); ++c) {
    std::vector<std::uint64_t> before, after, otherwise;
    append(row_of(flow, c), columns, before);
    append(row_of(back, c), columns, after);
    append(row_of(unset, c), columns, otherwise);
    EXPECT_EQ(before, after);
    EXPECT_EQ(before.size(), columns.width());
    for (std::size_t k = 0; k < before.size(); ++k)  // the test would see a member that was forgotten
      if (k != CellColumns::volume && k != CellColumns::fnum) {
        EXPECT_NE(before[k], otherwise[k]) << k;
      }
  }
}

TEST(AdaptMesh, CellsKeepWhatTheyRememberOrInheritIt) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  std::optional<Flow> flow;
  flow.emplace(comm, mesh, test::box_of(argon_with_trace(), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7));
  flow->fill(mesh);
  set_members(*flow);
  const auto before = contents(comm, *flow);

  adapted(comm, "--crossing-sphere 0,0,0,0.5", mesh, flow);

  EXPECT_EQ(contents(comm, *flow), before);
  expect_ids_in_order(*flow);
  const auto& parent = mesh::require_cell_field(mesh, {mesh::parent_field, mesh::FieldValues::integer, 1, "test"});
  std::int64_t n_same = 0, n_changed = 0;
  double sum = 0;
  for (std::size_t c = 0; c < flow->collisions.size(); ++c) {
    const auto old = parent.integer()[c] - mesh.info.first_id;
    const auto& cell = flow->collisions[c];
    EXPECT_GE(cell.max_sigma_cr, 1e-15 * member(old, 1));
    EXPECT_EQ(cell.temperature, member(old, 3));
    const double whole = 8e-9 / (6 * 27);  // m3: (2 mm)^3 in 6 * 27 cells
    const double part = flow->domain().volume[c] / whole;
    EXPECT_NEAR(cell.energy_deficit, 1e-20 * member(old, 6) * part, 1e-30);
    if (part > 0.99) {
      EXPECT_EQ(cell.remainder, member(old, 0));
      ++n_same;
    } else {
      EXPECT_NE(cell.remainder, member(old, 0));
      EXPECT_GT(cell.remainder, 0);
      EXPECT_LT(cell.remainder, 1);
      sum += cell.remainder;
      ++n_changed;
    }
  }
  n_changed = comm.sum(n_changed);
  EXPECT_GT(comm.sum(n_same), 20);
  EXPECT_GT(n_changed, 300);
  const double mean = par::reproducible_sum(comm, std::vector<double>{sum}) / static_cast<double>(n_changed);
  EXPECT_NEAR(mean, 0.5, 4 * std::sqrt(1.0 / 12 / static_cast<double>(n_changed)));
}

TEST(AdaptMesh, CoarseCellsHaveTheLargestBoundOfTheCellsThatTheyReplace) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  std::optional<Flow> flow;
  flow.emplace(comm, mesh, test::box_of(argon_with_trace(), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7));
  flow->fill(mesh);
  adapted(comm, "--all", mesh, flow);
  for (std::size_t c = 0; c < flow->collisions.size(); ++c)  // one child in eight
    if (flow->domain().cell_global[c] % 8 == 3) flow->collisions[c].max_sigma_cr = 1e-12;

  adapted(comm, "--box 9,9,9,9,9,9 --coarsen-rest", mesh, flow);

  EXPECT_EQ(mesh.info.n_global_cells, 6 * 27);
  for (const auto& cell : flow->collisions) EXPECT_EQ(cell.max_sigma_cr, 1e-12);
}

TEST(TransferParticles, FurtherCopiesGetIdsOfTheirOwn) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  auto setup = test::box_of(argon_with_trace(), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7);
  std::optional<Flow> flow;
  flow.emplace(comm, mesh, setup);
  flow->fill(mesh);
  for (int turn = 0; turn < 2; ++turn) {  // the second makes copies of copies
    set_members(*flow);
    const auto n = flow->n_particles();
    setup.fnum /= 2.5;

    const auto transferred = adapted(comm, "--crossing-sphere 0,0,0,0.5 --coarsen-rest", mesh, flow, setup.fnum);

    EXPECT_NEAR(static_cast<double>(transferred.new_particles), 2.5 * static_cast<double>(n),
                4 * std::sqrt(0.25 * static_cast<double>(n)));
    expect_ids_in_order(*flow);
    const std::vector<std::uint64_t> ids(flow->particles.id.begin(), flow->particles.id.end());
    EXPECT_EQ(n_different(comm, ids), transferred.new_particles);
  }
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

TEST(DensityScale, IsAsGoodInSmallCellsBesideLargeOnes) {
  // Each layer of cells is ten times as thick as the one before: nodes see the same cells but for that scale, so that
  // means at nodes of a density like x are like x, and x is the length.
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr int n = 20;
  auto block = test::kuhn_cube(comm, n);
  for (auto& p : block.node_position) p.x = p.x > 0 ? std::pow(10.0, std::round(n * p.x) - n) : 0;
  const auto mesh = assemble::assemble(comm, std::move(block));
  std::vector<double> density, x;
  std::vector<bool> is_inside;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    x.push_back(0.25 * (p[0].x + p[1].x + p[2].x + p[3].x));
    density.push_back(1e20 * x.back());
    is_inside.push_back(std::all_of(p.begin(), p.end(), [](Vec3 q) {
      return q.x > 5e-19 && q.x < 0.5 && std::min({q.y, q.z, 1 - q.y, 1 - q.z}) > 0.01;
    }));
  }

  const auto scale = density_scale(comm, mesh, density);

  for (std::size_t c = 0; c < scale.size(); ++c)
    if (is_inside[c]) {
      ASSERT_NEAR(scale[c], x[c], 1e-11 * x[c]);
    }
}

TEST(DensityScale, TakesMeansAtNodesThatAreWeightedByVolume) {
  // Layers of unequal thickness: as much of each cell's volume at a node lies before it as behind it, but for the
  // thickness. So the mean there is known.
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr std::array<double, 7> plane{0, 0.1, 0.5, 0.55, 0.85, 0.9, 1.3};
  constexpr std::array<double, 6> density_of{1, 5, 2, 7, 3, 4};
  auto block = test::kuhn_cube(comm, 6);
  for (auto& p : block.node_position) p.x = plane[static_cast<std::size_t>(std::lround(6 * p.x))];
  const auto mesh = assemble::assemble(comm, std::move(block));
  const auto layer_of = [&](LocalId c) {
    const auto p = mesh.points(c);
    const double x = 0.25 * (p[0].x + p[1].x + p[2].x + p[3].x);
    return static_cast<std::size_t>(std::upper_bound(plane.begin(), plane.end(), x) - plane.begin()) - 1;
  };
  std::vector<double> density;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) density.push_back(1e20 * density_of[layer_of(c)]);
  const auto mean_at = [&](std::size_t i) {
    const double before = plane[i] - plane[i - 1], behind = plane[i + 1] - plane[i];
    return 1e20 * (before * density_of[i - 1] + behind * density_of[i]) / (before + behind);
  };

  const auto scale = density_scale(comm, mesh, density);

  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto layer = layer_of(c);
    const bool is_inside = std::all_of(p.begin(), p.end(), [](Vec3 q) {
      return std::min({q.y, q.z, 1 - q.y, 1 - q.z}) > 0.01;
    });
    if (layer == 0 || layer == 5 || !is_inside) continue;
    double mean = 0;
    for (const auto& q : p) mean += 0.25 * mean_at(q.x > plane[layer] ? layer + 1 : layer);
    const double slope = (mean_at(layer + 1) - mean_at(layer)) / (plane[layer + 1] - plane[layer]);
    ASSERT_NEAR(scale[at(c)], mean / std::abs(slope), 1e-11 * scale[at(c)]);
  }
}

TEST(SplitOptions, RefusesWhatIsNoCriterion) {
  EXPECT_EQ(mark::split_options(" --all  --max-level 2 ").size(), 2U);
  EXPECT_THROW(mark::split_options("--all yes"), Error);
  EXPECT_THROW(mark::split_options("--field n --above"), Error);
  EXPECT_THROW(mark::split_options("--max-cells 5"), Error);
}

}  // namespace adapt_test
