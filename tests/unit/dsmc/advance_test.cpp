// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/advance.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "solvers/dsmc/run/flow_output.hpp"
#include "solvers/dsmc/run/flow_report.hpp"
#include "solvers/dsmc/run/stop_signals.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace advance_test {

using namespace pamr;
using namespace pamr::dsmc;

/// A name for a file that all ranks share and that is removed in the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const par::Comm& comm) : comm_(&comm) {
    std::string path;
    if (comm.is_first())
      path = std::filesystem::temp_directory_path() / ("pamr_dsmc_" + std::to_string(::getpid()) + ".ck");
    path_ = comm.broadcast(path);
  }
  ~TemporaryFile() {
    if (comm_->is_first()) std::filesystem::remove(path_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  TemporaryFile(TemporaryFile&&) = delete;
  TemporaryFile& operator=(TemporaryFile&&) = delete;
  const std::string& path() const { return path_; }

 private:
  const par::Comm* comm_;
  std::string path_;
};

TEST(Advance, StopsWhenOneRankAsksAndGoesOnFromItsCheckpointWithTheSameBits) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 4));
  const TemporaryFile checkpoint(comm);
  auto whole = test::filled(comm, c, mesh), first = test::filled(comm, c, mesh), rest = test::unfilled(comm, c, mesh);
  int asked = 0;
  Observer last_rank;
  last_rank.wants_stop = [&] { return comm.rank() == comm.size() - 1 && ++asked == 8; };

  const auto all = advance(*whole, {}, {});
  const auto stopped = advance(*first, {{}, checkpoint.path(), 0}, last_rank);
  rest->restart(checkpoint.path());
  const auto resumed = advance(*rest, {}, {});

  EXPECT_TRUE(stopped.was_stopped);
  EXPECT_EQ(first->flow().steps_done, 8U);
  EXPECT_FALSE(all.was_stopped);
  EXPECT_FALSE(resumed.was_stopped);
  EXPECT_EQ(rest->flow().steps_done, 90U);
  EXPECT_EQ(stopped.particle_steps + resumed.particle_steps, all.particle_steps);
  EXPECT_EQ(test::history_of(*rest), test::history_of(*whole));
  comm.barrier();
}

TEST(Advance, GoesOnWithTheBlocksOfItsCheckpointForMoreAverages) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto given = [](const std::string& sampling, const std::string& block) {
    std::string text = test::stream_case;
    const std::string old = "sampling = 60\nblock = 5\n";
    return read_case(text.replace(text.find(old), old.size(), "sampling = " + sampling + "\n" + block), "case.toml");
  };
  const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 4));
  const TemporaryFile checkpoint(comm);
  const auto whole = test::filled(comm, given("120", "block = 3\n"), mesh);
  const auto first = test::filled(comm, given("60", ""), mesh);    // a twentieth: 3
  const auto rest = test::unfilled(comm, given("120", ""), mesh);  // a twentieth would be 6
  const auto other = test::unfilled(comm, given("120", "block = 6\n"), mesh);

  advance(*whole, {}, {});
  advance(*first, {{}, checkpoint.path(), 0}, {});
  rest->restart(checkpoint.path());
  advance(*rest, {}, {});

  const auto a = whole->averaging().results(), b = rest->averaging().results();
  EXPECT_EQ(b.n_blocks, 40U);
  EXPECT_EQ(rest->averaging().block_steps(), 3);
  EXPECT_EQ(b.groups.n_groups, a.groups.n_groups);
  EXPECT_EQ(b.body.drag.error, a.body.drag.error);
  EXPECT_EQ(test::history_of(*rest), test::history_of(*whole));
  try {
    other->restart(checkpoint.path());
    ADD_FAILURE() << "blocks of two lengths were accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("give block = 3"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(checkpoint.path()), std::string::npos) << error.what();
  }
  comm.barrier();
}

TEST(Advance, TellsTheObserverOfPhasesAndSteps) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto computation = test::filled(comm, c, assemble::assemble(comm, test::random_mesh(comm, 5, 4)));
  std::vector<std::int64_t> totals, steps;
  std::vector<std::string> reports;
  Observer observer;
  observer.report = [&](const std::string& line) { reports.push_back(line); };
  observer.begin_phase = [&](const Phase& phase) { totals.push_back(phase.total); };
  observer.after_step = [&](std::int64_t done, const std::string&) { steps.push_back(done); };

  const auto result = advance(*computation, {40, "", 0}, observer);

  EXPECT_FALSE(result.was_stopped);
  EXPECT_EQ(totals, (std::vector<std::int64_t>{90, 90}));
  ASSERT_EQ(steps.size(), 40U);
  EXPECT_EQ(steps.back(), 40);
  EXPECT_EQ(reports, std::vector<std::string>{"averages begin after step 30 as the case says"});
}

TEST(FlowOutput, NamesTheAveragesOnTheMeshAndReportsWhatWasFound) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto computation = test::filled(comm, c, assemble::assemble(comm, test::random_mesh(comm, 5, 4)));
  Outcome outcome;
  outcome.advance = advance(*computation, {}, {});
  std::map<std::string, std::string> written;
  const auto write = [&](const std::string& file, const std::string& text) { written[file] = text; };

  outcome.resolution = write_output(*computation, {"", "", "", "h.csv"}, write);
  outcome.n_particles = computation->flow().n_particles();
  const auto report = report_of(*computation, outcome);

  std::string names;
  for (const auto& field : computation->mesh().cell_fields) names += field.name + " ";
  EXPECT_EQ(names,
            "n rho u T_tr T_rot T Ma tau_c lambda Kn_cell particles n_stderr collision_probability "
            "separation_over_lambda n_scale ");
  EXPECT_EQ(written.size(), 1U);
  EXPECT_EQ(written["h.csv"], test::history_of(*computation));
  EXPECT_EQ(report["steps"], 90);
  EXPECT_EQ(report["blocks"], 12);
  EXPECT_EQ(report["patches"].size(), 2U);
  EXPECT_GT(report["C_D"]["stderr"], 0);
  EXPECT_GT(outcome.resolution.cells_with_gas, 0);
}

TEST(StopSignals, AreHeardWhileTheyAreWatched) {
  EXPECT_FALSE(StopSignals::have_come());
  {
    const StopSignals signals;
    std::raise(SIGUSR1);
    EXPECT_TRUE(StopSignals::have_come());
  }
  const StopSignals again;
  EXPECT_FALSE(StopSignals::have_come());
}

}  // namespace advance_test
