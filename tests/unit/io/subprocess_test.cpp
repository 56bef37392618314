// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/subprocess.hpp"

#include <gmock/gmock.h>
#include <pthread.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <vector>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/io/native/native_file.hpp"

namespace pamr {
namespace subprocess_test {

using pamr::Subprocess;
constexpr Subprocess::Limits limits{.processor_seconds = 1, .memory_bytes = rlim_t{64} << 20U};

TEST(Subprocess, SendsWhatItsProcessMakes) {
  const std::string text(1000000, 'x');
  Subprocess process([&](const Subprocess::Send& send) { send(text); }, limits);

  std::array<char, 10> front{};
  EXPECT_TRUE(process.receive(front));
  EXPECT_EQ(process.receive_all().size(), text.size() - front.size());
  EXPECT_EQ(process.end(), "");
}

TEST(Subprocess, OutlivesTheDeathOfItsProcess) {
  Subprocess process(
      [](const Subprocess::Send& send) {
        send(std::string("abc"));
        std::raise(SIGSEGV);
      },
      limits);

  std::array<char, 4> more_than_comes{};
  EXPECT_FALSE(process.receive(more_than_comes));
  EXPECT_EQ(process.end(), "Segmentation fault");
}

TEST(Subprocess, EndsAProcessThatComputesForEver) {
  if (!par::Comm(MPI_COMM_WORLD).is_first()) return;  // it takes a second of the processor
  Subprocess process(
      [](const Subprocess::Send&) {
        for (volatile bool go = true; go;) {
        }
      },
      limits);

  EXPECT_EQ(process.receive_all(), "");
  EXPECT_EQ(process.end(), "CPU time limit exceeded");
}

TEST(Subprocess, KeepsItsProcessFromTakingTheMemoryOfTheMachine) {
  Subprocess process([](const Subprocess::Send& send) { send(std::string(std::size_t{1} << 30U, 'x')); }, limits);

  EXPECT_EQ(process.receive_all(), "");
  EXPECT_EQ(process.end(), "failure");
}

/// Sets PAMR_NO_FORK while it lives.
class NoFork {
 public:
  NoFork() { setenv("PAMR_NO_FORK", "1", 1); }
  ~NoFork() { unsetenv("PAMR_NO_FORK"); }
  NoFork(const NoFork&) = delete;
  NoFork& operator=(const NoFork&) = delete;
  NoFork(NoFork&&) = delete;
  NoFork& operator=(NoFork&&) = delete;
};

int n_forks = 0;

TEST(NativeFile, IsReadWithoutForkWhereThatIsForbidden) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  test::on_first_rank(comm, [&] { test::write_plain_vtkhdf(folder / "chunked.hdf", true); });
  ASSERT_EQ(pthread_atfork([] { ++n_forks; }, nullptr, nullptr), 0);
  const auto before = n_forks;

  const auto usual = io::read_native(comm, folder / "chunked.hdf");
  const auto forks = n_forks - before;
  const NoFork no_fork;
  const auto without = io::read_native(comm, folder / "chunked.hdf");

  EXPECT_GT(comm.sum(forks), 0);
  EXPECT_EQ(n_forks - before, forks);
  EXPECT_FALSE(pamr::may_fork());
  EXPECT_EQ(without.cell_to_node, usual.cell_to_node);
  EXPECT_EQ(without.node_position, usual.node_position);
}

TEST(NativeFile, RefusesBadFilesWithoutForkToo) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  const NoFork no_fork;
  test::on_first_rank(comm, [&] {
    test::write_plain_vtkhdf(folder / "a.hdf", true);
    const auto chunk = test::first_chunk_of(folder / "a.hdf", "/VTKHDF/Points");
    for (std::uint64_t i = 0; i < chunk.bytes; ++i) test::flip_byte(folder / "a.hdf", chunk.offset + i);
  });

  EXPECT_THAT(test::error_of_reading(comm, folder / "none.hdf"), testing::HasSubstr("found none"));
  EXPECT_THAT(test::error_of_reading(comm, folder / "a.hdf"), testing::HasSubstr("/VTKHDF/Points"));
}

TEST(NativeFile, RefusesADamagedCompressedChunk) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  test::on_first_rank(comm, [&] {
    test::write_plain_vtkhdf(folder / "a.hdf", true);
    const auto chunk = test::first_chunk_of(folder / "a.hdf", "/VTKHDF/Points");
    for (std::uint64_t i = 0; i < chunk.bytes; ++i) test::flip_byte(folder / "a.hdf", chunk.offset + i);
  });

  const auto error = test::error_of_reading(comm, folder / "a.hdf");

  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("/VTKHDF/Points"), testing::HasSubstr("sound chunks")));
}

}  // namespace subprocess_test
}  // namespace pamr
