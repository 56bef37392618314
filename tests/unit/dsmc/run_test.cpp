// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sched.h>

#include <cmath>
#include <limits>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/timer.hpp"
#include "solvers/dsmc/kernel/random.hpp"
#include "solvers/dsmc/run/averaging.hpp"
#include "solvers/dsmc/run/should_move.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/sampling/steadiness.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace run_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;

/// A value that tends to 1 within `time` intervals, with noise of size `noise`.
std::vector<double> tending(std::size_t n, double time, double noise) {
  std::vector<double> values;
  Random random(4, Purpose::seed, 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    values.push_back(1 - 0.5 * std::exp(-static_cast<double>(i) / time) + noise * random.normal_pair().a);
  return values;
}

TEST(Steadiness, IsSeenWhenTwoWindowsHaveStoppedChanging) {
  EXPECT_FALSE(assess_steadiness({{"particles", tending(19, 1, 0.001)}}, 10).is_steady);  // not two windows yet
  EXPECT_FALSE(assess_steadiness({{"particles", tending(20, 20, 0.001)}}, 10).is_steady);
  EXPECT_FALSE(assess_steadiness({{"particles", tending(40, 20, 0.001)}}, 10).is_steady);
  EXPECT_TRUE(assess_steadiness({{"particles", tending(150, 20, 0.001)}}, 10).is_steady);
  EXPECT_TRUE(assess_steadiness({{"particles", tending(60, 1, 0.0)}}, 10).is_steady);
  const auto verdict =
      assess_steadiness({{"particles", tending(150, 20, 0.001)}, {"drag", tending(150, 60, 0.001)}}, 10);
  EXPECT_FALSE(verdict.is_steady);
  EXPECT_NE(verdict.reason.find("drag still changes"), std::string::npos) << verdict.reason;
}

TEST(Steadiness, IsNotSeenInNoiseThatHidesEverything) {
  EXPECT_FALSE(assess_steadiness({{"drag", tending(40, 1, 1.0)}}, 10).is_steady);
}

TEST(FitLine, HasTheChangeFromEndToEndAndItsStandardError) {
  const std::vector<double> straight{1, 2, 3, 4}, bent{0, 3, 0, 3};
  const auto line = fit_line(straight);
  EXPECT_DOUBLE_EQ(line.mean, 2.5);
  EXPECT_DOUBLE_EQ(line.change, 4);
  EXPECT_NEAR(line.change_error, 0, 1e-12);
  // Slope 3/5, what is left of the squares 9 - 5 (3/5)^2 = 7.2; divided by two degrees of freedom, and by 5 under the
  // root.
  EXPECT_DOUBLE_EQ(fit_line(bent).change, 4 * 0.6);
  EXPECT_DOUBLE_EQ(fit_line(bent).change_error, 4 * std::sqrt(3.6 / 5));
}

TEST(Drifts, IsRareInNoiseAndSureInARise) {
  const int n_runs = 20000;
  int by_chance = 0, seen = 0;
  Random random(1, Purpose::seed, 1, 0);
  for (int run = 0; run < n_runs; ++run) {
    std::vector<double> noise, rise;
    for (int i = 0; i < 10; ++i) {
      noise.push_back(1 + 0.01 * random.normal_pair().a);
      rise.push_back(noise.back() + 0.01 * i);
    }
    by_chance += drifts(fit_line(noise)) ? 1 : 0;
    seen += drifts(fit_line(rise)) ? 1 : 0;
  }
  EXPECT_NEAR(1.0 * by_chance / n_runs, 0.0039, 0.0015);  // Student, 8 degrees of freedom, beyond 4
  EXPECT_GT(seen, 0.97 * n_runs);
  EXPECT_FALSE(drifts(fit_line(std::vector<double>{1, 1.001, 1.002, 1.003})));  // sure, and unimportant
}

/// Part of runs in which drag or heat, which scatter by chance, drift after one of the groups from the tenth on. A group is
/// eight blocks, each of which remembers this part of the one before.
double restarted(int n_groups, double memory) {
  const int n_runs = 2000;
  const double fresh = std::sqrt(1 - memory * memory);
  int n_restarted = 0;
  for (int run = 1; run <= n_runs; ++run) {
    Random random(static_cast<std::uint64_t>(run), Purpose::seed, 1, 0);
    auto block = random.normal_pair();
    std::vector<double> drag, heat;
    bool drifted = false;
    while (drag.size() < static_cast<std::size_t>(n_groups) && !drifted) {
      drag.push_back(1);
      heat.push_back(1);
      for (int k = 0; k < 8; ++k) {
        const auto next = random.normal_pair();
        block = {memory * block.a + fresh * next.a, memory * block.b + fresh * next.b};
        drag.back() += 0.1 * block.a;
        heat.back() += 0.1 * block.b;
      }
      drifted = drag.size() >= 10 && (drifts(fit_line(drag)) || drifts(fit_line(heat)));
    }
    n_restarted += drifted ? 1 : 0;
  }
  return 1.0 * n_restarted / n_runs;
}

TEST(Drifts, RestartsTheStatedPartOfRunsByChanceThoughItIsAskedAfterEveryGroup) {
  EXPECT_NEAR(restarted(20, 0), 0.023, 0.01);
  EXPECT_NEAR(restarted(100, 0), 0.033, 0.012);
  EXPECT_NEAR(restarted(20, std::exp(-0.5)), 0.05, 0.015);
  EXPECT_NEAR(restarted(100, std::exp(-0.5)), 0.08, 0.02);
}

/// Averages with eleven blocks whose load on wall `zmin` falls by a part of its mean from each to the next; a step ends
/// the twelfth, without any load.
class FallingAverages : public ::testing::Test {
 protected:
  explicit FallingAverages(const std::string& transient = "") : case_(read_case(text(transient), "case.toml")) {
    flow_.steps_done = 60;
    RunState state;
    state.sampling = true;
    state.block_steps = 5;
    state.in_interval = 4;
    state.face.resize(flow_.domain().boundary.size());
    for (int block = 0; block < 11; ++block) {
      std::vector<Load> loads(mesh_.info.patches.size());
      for (std::size_t p = 0; p < loads.size(); ++p)
        if (mesh_.info.patches[p].name == "zmin") loads[p] = {{11.0 - block, 0, 0}, {}, 7};
      state.blocks.push_back(loads);
      HistoryRow row;
      row.sampled = true;
      state.history.push_back(row);
    }
    averaging_.resume(state);
    averaging_.after_step(flow_, {});
  }

  static std::string text(const std::string& transient) {
    std::string text = test::stream_case;
    return text.replace(text.find("transient = 30"), 14, transient);
  }

  par::Comm comm_{MPI_COMM_WORLD};
  Case case_;
  mesh::DistMesh mesh_ = assemble::assemble(comm_, test::kuhn_cube(comm_, 3));
  Flow flow_{comm_, mesh_, make_setup(comm_, case_, mesh_)};
  Averaging averaging_{case_, mesh_, flow_};
};

TEST_F(FallingAverages, BeginAnew) {
  const auto& state = averaging_.state();
  EXPECT_TRUE(state.blocks.empty());
  EXPECT_EQ(state.sampling_since, 60U);
  EXPECT_TRUE(state.sampling);
  EXPECT_FALSE(averaging_.is_complete(60));
  EXPECT_EQ(state.history.size(), 12U);
  for (const auto& row : state.history) EXPECT_FALSE(row.sampled);
  EXPECT_EQ(state.steady_reason.find(
                "averages begun anew after step 60: in the 12 blocks of 5 steps before the drag changed by"),
            0U)
      << state.steady_reason;
}

class FallingAveragesOfACaseWithATransient : public FallingAverages {
 protected:
  FallingAveragesOfACaseWithATransient() : FallingAverages("transient = 30") {}
};

TEST_F(FallingAveragesOfACaseWithATransient, StayAndAreNamed) {
  EXPECT_EQ(averaging_.state().blocks.size(), 12U);
  EXPECT_TRUE(averaging_.is_complete(60));
  EXPECT_NE(drifts_of(averaging_.results().trends).find("the drag changed by"), std::string::npos);
}

TEST(Results, AreFiniteOnlyIfAllCoefficientsAndTheirErrorsAre) {
  Results results;
  results.walls.resize(2);
  EXPECT_TRUE(is_finite(results));

  results.body.drag.value = std::nan("");
  EXPECT_FALSE(is_finite(results));
  results.body.drag.value = 0;
  results.walls[1].heat.error = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_finite(results));
}

/// Intervals until the next move, with the same imbalance in each.
int intervals(ShouldMove& rule, double longest, double mean) {
  int n = 1;
  while (!rule.add(longest, mean)) ++n;
  return n;
}

TEST(ShouldMove, WhenImbalanceHasCostAsMuchAsTheLastMove) {
  ShouldMove rule;
  rule.moved(1.0);
  EXPECT_FALSE(rule.add(2.0, 1.9));
  EXPECT_FALSE(rule.add(2.0, 1.5));
  EXPECT_TRUE(rule.add(2.5, 2.0));  // 0.1 + 0.5 + 0.5

  rule.moved(1.0);
  EXPECT_EQ(intervals(rule, 2.03, 2.0), 34);  // the loss counts anew
}

TEST(ShouldMove, WhenImbalanceIsThereFromTheStart) {  // as where a stream enters an empty domain
  ShouldMove rule;
  rule.moved(1.0);
  EXPECT_EQ(intervals(rule, 1.3, 1.0), 4);
}

TEST(ShouldMove, EverMoreSeldomWhereItDoesNotHelp) {
  ShouldMove rule;
  rule.moved(1.0);
  for (const int expected : {3, 5, 9, 17, 33, 65, 129, 129}) {
    EXPECT_EQ(intervals(rule, 1.5, 1.0), expected);
    rule.moved(1.0);
  }
  EXPECT_FALSE(rule.add(1.1, 1.0));  // the last one did help
  EXPECT_EQ(intervals(rule, 1.5, 1.0), 2);
}

TEST(Loads, OfANewtonianStreamOnAPlateAreThoseOfTheClosedForm) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::kuhn_cube(comm, 3);
  for (auto& p : block.node_position) p.z += 0.4 * p.y * p.z * (1 - p.z);  // no two faces are alike
  const auto mesh = assemble::assemble(comm, std::move(block));
  const auto gas = test::nitrogen();
  const double angle = 0.3, speed = 1000;
  const Stream stream{"free", 1e20, 300, 300, {speed * std::cos(angle), 0, speed * std::sin(angle)}, {1}};
  const auto domain = make_gas_domain(mesh, 1, 1, 1);
  Reference reference;
  reference.length = 2;
  reference.point = {1, 0, 0};
  const Scale scale(gas, stream, reference);

  const auto loads =
      integrate_law(comm, domain.boundary, newtonian_law(gas, stream), reference.point, mesh.info.patches.size());

  // Face x = 1: C_p = 2 cos^2 along x, with its middle at z = 1/2 beside the point of reference.
  std::vector<bool> wanted;
  for (const auto& patch : mesh.info.patches) wanted.push_back(patch.name == "xmax");
  const auto k = scale.coefficients(sum_of(loads, wanted));
  const double cp = 2 * std::pow(std::cos(angle), 2);
  EXPECT_NEAR(k.drag, cp * std::cos(angle), 1e-12);
  EXPECT_NEAR(k.lift, -cp * std::sin(angle), 1e-12);
  EXPECT_NEAR(k.moment, 0.5 * cp / 2, 1e-12);  // z F_x
}

TEST(Computation, IsTheSameWhetherCellsMoveToOtherRanksOrNot) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto block = test::random_mesh(comm, 8, 4);
  auto computation = test::filled(comm, c, assemble::assemble(comm, block));
  auto serial = test::filled(alone, c, assemble::assemble(alone, test::gather(comm, block)));

  bool moved = false, complete = false;
  for (int step = 1; !complete; ++step) {
    complete = computation->step().is_complete;
    ASSERT_EQ(serial->step().is_complete, complete);
    if (step % 25 == 0) moved = computation->rebalance() || moved;
  }

  EXPECT_EQ(moved, comm.size() > 1);
  const auto a = computation->averaging().results(), b = serial->averaging().results();
  EXPECT_EQ(a.body.drag.value, b.body.drag.value);
  EXPECT_EQ(a.body.drag.error, b.body.drag.error);
  EXPECT_EQ(a.body.heat.value, b.body.heat.value);
  EXPECT_GT(b.body.drag.error, 0);
  EXPECT_EQ(b.n_blocks, 12U);
  EXPECT_EQ(test::history_of(*computation), test::history_of(*serial));
  EXPECT_EQ(computation->flow().lost(), 0);
}

/// Keeps this process on the first core that it may use, as all ranks of this machine.
class OnOneCore {
 public:
  OnOneCore() {
    if (sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    int first = 0;
    while (!CPU_ISSET(first, &before_)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OnOneCore() { sched_setaffinity(0, sizeof before_, &before_); }
  OnOneCore(const OnOneCore&) = delete;
  OnOneCore& operator=(const OnOneCore&) = delete;

 private:
  cpu_set_t before_;
};

TEST(Computation, CountsProcessorTimeOfAMoveWhereRanksShareACore) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c = read_case(test::stream_case, "case.toml");
  auto computation = test::filled(comm, c, assemble::assemble(comm, test::random_mesh(comm, 8, 4)));
  const OnOneCore here;
  comm.barrier();

  const double start = cpu_seconds();
  computation->rebalance();

  EXPECT_LE(computation->move_seconds(), comm.max(cpu_seconds() - start));
  EXPECT_EQ(computation->move_seconds() > 0, comm.size() > 1);
}

/// The small case with other lines for all of its patches, and the setup of the cube with it.
Setup setup_with(const std::string& boundary, const std::string& reference = "area = 1.0") {
  std::string text = test::stream_case;
  const auto begin = text.find("xmin =");
  text.replace(begin, text.find("[initial]") - begin, boundary + "\n");
  text.replace(text.find("area = 1.0"), 10, reference);
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  const auto c = read_case(text, "case.toml");
  return make_setup(comm, c, mesh);
}

TEST(Patterns, StandForPatches) {
  const auto setup = setup_with(
      R"("?max" = { kind = "outflow" }
"[xy]min" = { kind = "diffuse", temperature = 400.0 }
"*" = { kind = "inflow" }
ymax = { kind = "specular" })",
      "area = 1.0\npatches = [\"x*\"]");
  using Kind = BoundaryCondition::Kind;  // xmin xmax ymin ymax zmin zmax
  const Kind expected[] = {Kind::diffuse, Kind::outflow, Kind::diffuse, Kind::specular, Kind::inflow, Kind::outflow};
  for (std::size_t p = 0; p < 6; ++p) EXPECT_EQ(setup.patch[p].kind, expected[p]) << p;
}

TEST(Patterns, AreRefusedWhereTheyAreAmbiguousOrStandForNothing) {
  const auto refused = [](const std::string& boundary, const std::string& reference, const std::string& says) {
    try {
      setup_with(boundary, reference);
      ADD_FAILURE() << boundary << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  const std::string walls = "\"*\" = { kind = \"diffuse\", temperature = 400.0 }\n", area = "area = 1.0";
  refused(walls + "\"*min\" = { kind = \"outflow\" }\n\"x*\" = { kind = \"outflow\" }", area,
          "expected one name that stands for \"xmin\", found \"*min\" and \"x*\"");
  refused(walls + "\"w*\" = { kind = \"outflow\" }", area, "found \"w*\"");
  refused("\"x*\" = { kind = \"outflow\" }", area, "found none for ymin, ymax, zmin, zmax");
  refused(walls, area + "\npatches = [\"w*\"]",
          "expected patches = names of walls of the mesh in [reference], found \"w*\"");
  refused(walls + "xmax = { kind = \"outflow\" }", area + "\npatches = [\"xm*x\"]", "found \"xm*x\"");
}

TEST(CaseFile, ThatIsRefusedNamesTheLine) {
  const auto refused = [](const std::string& old, const std::string& with, const std::string& says) {
    std::string text = test::stream_case;
    text.replace(text.find(old), old.size(), with);
    try {
      read_case(text, "case.toml");
      ADD_FAILURE() << with << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refused("[time]", "[times]", "case.toml:33");
  refused("[time]", "[times]", "unknown key 'times'; did you mean 'time'?");
  refused("sphere = [0.2, 0.2, 0.2, 0.3]", "sphere = [0.2, 0.2, 0.3]", "case.toml:27");
  refused("stream = \"puff\"", "stream = \"pouf\"", "\"pouf\"");
  refused("area = 1.0", "area = 1.0\npatches = [\"zmax\"]", "zmax");
  refused("zmin = { kind = \"diffuse\", temperature = 500.0 }", "\"z*\" = { kind = \"periodic\", partner = \"zmax\" }",
          "case.toml:23:17: expected kind = another kind for several patches at once");
  refused("omega = 0.74", "omega = 0.3", "case.toml:5");
  refused("[stream.free]", "[stream.far]", "[stream.free]");
}

}  // namespace run_test
