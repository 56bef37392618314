// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints whose checksums are right and whose contents are wrong: the mutants are written as any checkpoint is.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"
#include "support/strange_values.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace checkpoint_damage_test {

using namespace pamr;
using namespace pamr::dsmc;
using nlohmann::json;

/// A short run, its checkpoint, and what comes of reading altered ones.
class CheckpointContents : public testing::Test {
 protected:
  CheckpointContents() {
    auto computation = test::filled(comm_, case_, mesh_);
    for (int step = 0; step < 45; ++step) computation->step();
    sound_.emplace(computation->snapshot());
    std::string path;
    if (comm_.is_first())
      path = std::filesystem::temp_directory_path() / fmt::format("pamr_dsmc_damage_{}.ck", ::getpid());
    file_ = comm_.broadcast(path);
  }
  ~CheckpointContents() override {
    comm_.barrier();
    if (comm_.is_first()) std::filesystem::remove(file_);
  }

  /// Writes the snapshot and goes on from it for two steps. The error, or nothing when it was accepted.
  std::string error_of(const Snapshot& snapshot) {
    auto computation = test::unfilled(comm_, case_, mesh_);
    try {
      write_checkpoint(comm_, file_, snapshot);
      computation->restart(file_);
    } catch (const Error& error) {
      return error.what();
    }
    for (int step = 0; step < 2; ++step) computation->step();
    const auto& p = computation->flow().particles;
    for (const auto* values : {&p.x, &p.y, &p.z, &p.u, &p.v, &p.w, &p.rotation})
      for (const double value : *values) EXPECT_TRUE(std::isfinite(value));
    return "";
  }

  /// Sets a word of a row, on the rank that has the row.
  void set(Section& section, std::int64_t row, std::size_t word, std::uint64_t value) const {
    const auto range = par::block_range(section.rows, comm_.rank(), comm_.size());
    if (row >= range.begin && row < range.end) section.block[at(row - range.begin) * section.width + word] = value;
  }

  const par::Comm comm_{MPI_COMM_WORLD};
  const Case case_ = read_case(test::stream_case, "case.toml");
  const mesh::DistMesh mesh_ = assemble::assemble(comm_, test::random_mesh(comm_, 5, 3));
  std::optional<Snapshot> sound_;
  std::string file_;
};

TEST_F(CheckpointContents, ThatAreSoundAreAccepted) { EXPECT_EQ(error_of(*sound_), ""); }

TEST_F(CheckpointContents, OfTablesAreRefusedWithTheirRow) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Wrong {
    const char* table;
    std::size_t word;
    std::uint64_t value;
    const char* says;
  };
  const std::vector<Wrong> wrongs{
      {"particles", 1, 7, "a species"},
      {"particles", 2, word(infinity), "a position"},
      {"particles", 3, word(0.9e3), "outside of the cell"},
      {"particles", 5, word(infinity), "a velocity"},
      {"particles", 6, word(std::nan("")), "a velocity"},
      {"particles", 7, word(1e200), "a velocity"},
      {"particles", 8, word(-1e-21), "a rotational energy"},
      {"cells", 0, word(std::int64_t{-1}), "particles"},
      {"cells", 0, word(std::int64_t{1} << 62U), "particles"},
      {"cells", 1, word(1e300), "(sigma c_r)_max"},
      {"cells", 1, word(-1.0), "(sigma c_r)_max"},
      {"cells", 2, word(1e18), "remainder"},
      {"cells", 3, word(infinity), "temperature"},
      {"cells", 4, word(-1.0), "separations"},
      {"cells", 5, word(std::int64_t{-5}), "collisions"},
      {"cells", 7, word(infinity), "squares"},
      {"cells", CellColumns::volume, word(0.0), "volume"},
      {"cells", CellColumns::fnum, word(-1.0), "molecules"},
      {"cells", 10, word(-1.0), "the sum of its particles"},
      {"cells", 11, word(1e300), "velocities"},
      {"cells", 15, word(infinity), "rotational energies"},
      {"faces", 0, word(std::int64_t{-1}), "hits"},
      {"faces", 4, word(std::numeric_limits<std::int64_t>::max()), "sums"},
      {"faces", 11, word(std::nan("")), "squares"},
  };
  for (const auto& wrong : wrongs) {
    auto snapshot = *sound_;
    auto& section = wrong.table == std::string("cells")   ? snapshot.cells
                    : wrong.table == std::string("faces") ? snapshot.faces
                                                          : snapshot.particles;
    set(section, section.rows / 2, wrong.word, wrong.value);

    const auto error = error_of(snapshot);

    EXPECT_NE(error.find(wrong.says), std::string::npos) << wrong.table << " " << wrong.word << ": " << error;
    EXPECT_NE(error.find(file_), std::string::npos) << error;
    EXPECT_EQ(error, comm_.broadcast(error));
  }
}

TEST_F(CheckpointContents, OfTheHeaderAreRefusedByName) {
  const auto refused = [&](const std::string& pointer, const json& value, const std::string& says) {
    auto snapshot = *sound_;
    snapshot.header[json::json_pointer(pointer)] = value;
    const auto error = error_of(snapshot);
    EXPECT_NE(error.find(says), std::string::npos) << pointer << ": " << error;
  };
  refused("/steps_done", -1, "steps_done");
  refused("/steps_done", 1e300, "steps_done");
  refused("/steps_done", std::uint64_t{1} << 63U, "steps_done");
  refused("/sampled_steps", 7, "add up");
  refused("/fingerprint", "f", "fingerprint");
  refused("/n_cells", json::array(), "n_cells");
  refused("/run", nullptr, "the place of sampling");
  refused("/run/first_step", 1000000, "first_step");
  refused("/run/in_interval", -3, "in_interval");
  refused("/run/history/0", json::array({1, 2}), "a row of the history");
  refused("/run/history/1/0", 0, "one after another");
  refused("/run/block_steps", 1e300, "block_steps");
  refused("/run/block_steps", 0, "blocks of 0");
  refused("/run/block_steps", 44, "blocks of 44");
  refused("/run/sampling", false, "expected no averages");
  refused("/run/in_interval", 5, "and 5 more");
  refused("/run/blocks/0", json::array(), "a block of loads");
  refused("/run/blocks/0/0/6", nullptr, "number 6 of a load");
  refused("/run/steady_reason", 5, "steady_reason");
  refused("/run/begun", "yesterday", "why averages began");
  refused("/run/restarts", -1, "restarts");
  refused("/run/history/0/20", nullptr, "a flux of the history");
  refused("/run/flux_blocks/0", json::array(), "a block of fluxes");
  refused("/run/flux_blocks/3", sound_->header["run"]["flux_blocks"][0], "at most 3 blocks of fluxes");
  refused("/run/contents/particles/0", -1, "particles");
  refused("/run/contents/sums/3", std::int64_t{1} << 60U, "a sum over the particles");
  refused("/run/balance/in", 0.5, "in");
  refused("/fluxes", json::array({1, 2}), "fluxes");
  refused("/fluxes/4", "many", "a word of the fluxes");
}

TEST_F(CheckpointContents, OfOtherSizesAreRefused) {
  for (Section Snapshot::*const table : {&Snapshot::cells, &Snapshot::faces, &Snapshot::particles}) {
    auto snapshot = *sound_;
    auto& section = snapshot.*table;
    if (comm_.rank() == comm_.size() - 1) section.block.resize(section.block.size() + section.width, 0);
    ++section.rows;
    if (comm_.size() > 1) continue;  // the other blocks would have to change as well
    EXPECT_NE(error_of(snapshot), "") << section.name;
  }
}

TEST_F(CheckpointContents, ThatDiceHaveMadeAreRefusedOrHarmless) {
  const char* level = std::getenv("PAMR_TEST_LEVEL");  // NOLINT(concurrency-mt-unsafe): nobody changes it
  const bool is_full = level != nullptr && level == std::string("full");
  // others on several ranks, which wait for each other: what is wrong in a row is found by the rank that has it
  const int first = is_full && comm_.size() > 1 ? 20000 : 0;
  const int n_mutants = !is_full ? 250 : comm_.size() > 1 ? 4000 : 20000;
  int n_refused = 0;
  for (int i = first; i < first + n_mutants; ++i) {
    test::Dice dice(static_cast<std::uint64_t>(i));
    auto snapshot = *sound_;
    const std::array<Section*, 3> tables{&snapshot.cells, &snapshot.faces, &snapshot.particles};
    for (auto n = 1 + dice.below(3); n > 0; --n) {
      if (dice.below(3) == 0) {
        test::damage_json(snapshot.header, dice);
        continue;
      }
      auto& table = *tables.at(dice.below(3));
      const auto row = static_cast<std::int64_t>(dice.below(at(table.rows)));
      const auto word = dice.below(table.width);
      set(table, row, word, test::strange_word(dice));
    }
    SCOPED_TRACE(i);
    if (!error_of(snapshot).empty()) ++n_refused;
  }
  EXPECT_GT(n_refused, n_mutants / 2);
}

}  // namespace checkpoint_damage_test
