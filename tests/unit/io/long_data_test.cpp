// SPDX-License-Identifier: GPL-3.0-or-later
// A message and slabs of a file of more than 2^31 bytes, from and to memory that is 1 MB again and again. In the quick
// level they are shorter, which shows that the test works.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "files.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/par/comm.hpp"
#include "support/aliased_memory.hpp"

namespace pamr {
namespace long_data_test {

using test::AliasedMemory;

/// In the full level more than a count of MPI holds, and no multiple of anything.
std::size_t length() {
  const char* level = std::getenv("PAMR_TEST_LEVEL");  // NOLINT(concurrency-mt-unsafe): nobody changes it
  return (std::size_t{1} << (level != nullptr && std::string_view(level) == "full" ? 31U : 24U)) + 4099;
}

std::byte value_at(std::size_t i) { return static_cast<std::byte>(i % 251 + 1); }

void fill(std::span<std::byte> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = value_at(i);
}

TEST(LongMessage, ArrivesWholeBetweenNeighbors) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto n_bytes = length();
  const AliasedMemory sent(n_bytes), received(n_bytes);
  fill(sent.first_window());
  const std::array<Rank, 1> rank{comm.size() - 1 - comm.rank()};
  const std::array<std::span<const std::byte>, 1> from{sent.bytes()};
  const std::array<std::span<std::byte>, 1> to{received.bytes()};
  const auto before = comm.traffic();
  ASSERT_EQ(comm.size(), 2);

  comm.neighbor_exchange(rank, from, to);

  const auto traffic = comm.traffic() - before;
  EXPECT_EQ(traffic.bytes, static_cast<std::int64_t>(n_bytes));
  EXPECT_EQ(traffic.bytes_received, static_cast<std::int64_t>(n_bytes));
  EXPECT_EQ(traffic.messages, static_cast<std::int64_t>((n_bytes + (std::size_t{1} << 30U) - 1) >> 30U));
  EXPECT_EQ(std::memcmp(received.bytes().data(), sent.bytes().data(), AliasedMemory::window), 0);
}

TEST(LongSlab, IsWrittenAndReadAtOnce) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  const auto file = folder / "long.hdf";
  const auto n_bytes = length();
  const AliasedMemory memory(n_bytes);
  const auto n = static_cast<std::int64_t>(n_bytes), first = n / 2;  // one rank's slab goes over the middle of the rows
  const io::hdf5::Shape shape{2 * n, 1, true};
  const auto access = io::hdf5::parallel_access(comm, file, io::hdf5::Access::write);
  const auto transfer = io::hdf5::independent_transfer();
  fill(memory.first_window());
  {
    const auto h5 = io::hdf5::take(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "file");
    const auto how = io::hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "properties");
    ASSERT_GE(H5Pset_alloc_time(how.id(), H5D_ALLOC_TIME_EARLY), 0);
    ASSERT_GE(H5Pset_fill_time(how.id(), H5D_FILL_TIME_NEVER), 0);
    const auto extent = static_cast<hsize_t>(2 * n);
    const io::hdf5::Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
    const auto rows = io::hdf5::take(
        H5Dcreate2(h5.id(), "rows", H5T_STD_I8LE, space.id(), H5P_DEFAULT, how.id(), H5P_DEFAULT), H5Dclose, "rows");
    if (comm.is_first()) {
      EXPECT_TRUE(
          io::hdf5::write_rows({rows.id(), shape, first, n}, H5T_NATIVE_INT8, memory.bytes().data(), transfer.id()))
          << io::hdf5::last_error();
    }
  }
  comm.barrier();
  std::memset(memory.first_window().data(), 0, AliasedMemory::window);

  const auto h5 = io::hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "file");
  const auto rows = io::hdf5::take(H5Dopen2(h5.id(), "rows", H5P_DEFAULT), H5Dclose, "rows");
  EXPECT_TRUE(
      io::hdf5::read_rows({rows.id(), shape, first, n}, mesh::StorageType::int8, memory.bytes().data(), transfer.id()))
      << io::hdf5::last_error();

  for (std::size_t i = 0; i < AliasedMemory::window; ++i) ASSERT_EQ(memory.bytes()[i], value_at(i)) << i;
  std::array<std::int8_t, 3> around{};  // the last row of the slab and what is behind it, which nobody wrote
  EXPECT_TRUE(
      io::hdf5::read_rows({rows.id(), shape, first + n - 1, 3}, mesh::StorageType::int8, around.data(), transfer.id()));
  EXPECT_EQ(static_cast<std::byte>(around[0]), value_at((n_bytes - 1) % AliasedMemory::window));
  EXPECT_EQ(around[1], 0);
  EXPECT_EQ(around[2], 0);
}

}  // namespace long_data_test
}  // namespace pamr
