// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/isolated.hpp"

#include <gmock/gmock.h>

#include <array>
#include <csignal>
#include <vector>

#include "files.hpp"
#include "hdf5_edit.hpp"

namespace pamr {
namespace {

using io::Isolated;
constexpr Isolated::Limits limits{.processor_seconds = 1, .memory_bytes = rlim_t{64} << 20U};

TEST(Isolated, SendsWhatItsProcessMakes) {
  const std::string text(1000000, 'x');
  Isolated process([&](const Isolated::Send& send) { send(text); }, limits);

  std::array<char, 10> front{};
  EXPECT_TRUE(process.receive(front));
  EXPECT_EQ(process.receive_all().size(), text.size() - front.size());
  EXPECT_EQ(process.end(), "");
}

TEST(Isolated, OutlivesTheDeathOfItsProcess) {
  Isolated process(
      [](const Isolated::Send& send) {
        send(std::string("abc"));
        std::raise(SIGSEGV);
      },
      limits);

  std::array<char, 4> more_than_comes{};
  EXPECT_FALSE(process.receive(more_than_comes));
  EXPECT_EQ(process.end(), "Segmentation fault");
}

TEST(Isolated, EndsAProcessThatComputesForEver) {
  Isolated process(
      [](const Isolated::Send&) {
        for (volatile bool go = true; go;) {
        }
      },
      limits);

  EXPECT_EQ(process.receive_all(), "");
  EXPECT_EQ(process.end(), "CPU time limit exceeded");
}

TEST(Isolated, KeepsItsProcessFromTakingTheMemoryOfTheMachine) {
  Isolated process([](const Isolated::Send& send) { send(std::string(std::size_t{1} << 30U, 'x')); }, limits);

  EXPECT_EQ(process.receive_all(), "");
  EXPECT_EQ(process.end(), "failure");
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

}  // namespace
}  // namespace pamr
