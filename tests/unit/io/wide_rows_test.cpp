// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of a file beyond 32 bits: their windows, and HDF5's extents through a sparse file.
#include <gmock/gmock.h>

#include <array>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/native/row_transport.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace wide_rows_test {

using test::Folder;

constexpr GlobalId two_to_31 = GlobalId{1} << 31U, two_to_33 = GlobalId{1} << 33U;

TEST(Windows, CoverTheRowsOnceAndInOrderWhateverTheFirstId) {
  constexpr GlobalId slab = GlobalId{1} << 31U;
  for (const IdRange all : {IdRange(5 * two_to_33 + 3), IdRange(5 * two_to_33 + 3, two_to_33), IdRange(7, two_to_33)})
    for (const Rank size : {1, 3, 7}) {
      GlobalId next = all.first;
      for (Rank rank = 0; rank < size; ++rank)
        for (GlobalId step = 0;; ++step) {
          const auto range = io::window({all, 1, {}, {}, {}}, rank, size, step, slab);
          if (range.count() == 0) break;
          EXPECT_EQ(range.begin, next);
          EXPECT_LE(range.count(), slab);
          next = range.end;
        }
      EXPECT_EQ(next, all.end());
    }
}

TEST(Windows, AreFilledFromRowsWithNumbersBeyond32Bits) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::vector<GlobalId> ids;  // dealt around the ranks
  for (GlobalId row = comm.rank(); row < 50; row += comm.size()) ids.push_back(two_to_33 + row);
  const io::HeldRows rows{{50, two_to_33}, 2, ids, {}, [&](std::size_t first, std::size_t n, std::uint64_t* to) {
                            for (auto i = first; i < first + n; ++i, to += 2) {
                              to[0] = static_cast<std::uint64_t>(ids[i]);
                              to[1] = 7;
                            }
                          }};

  io::Window window;
  io::collect(comm, rows, 0, 50, window);

  EXPECT_EQ(window.missing, 0);
  ASSERT_EQ(window.words.size(), static_cast<std::size_t>(2 * window.range.count()));
  for (std::size_t i = 0; i < window.words.size(); i += 2) {
    EXPECT_EQ(static_cast<GlobalId>(window.words[i]), window.range.begin + static_cast<GlobalId>(i / 2));
    EXPECT_EQ(window.words[i + 1], 7U);
  }
}

TEST(Windows, TakeOwnRowsOnceAndCountThoseThatAreMissing) {
  const std::vector<GlobalId> ids{9, 10, 11, 11, 13, 14, 14, 20};
  const std::vector<GlobalId> run{10, 16};
  const io::HeldRows rows{{30, 0}, 1, ids, run, [&](std::size_t first, std::size_t n, std::uint64_t* to) {
                            for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<std::uint64_t>(ids[first + i]);
                          }};

  io::Window window;
  io::take_own(rows, {10, 16}, window);

  EXPECT_EQ(window.missing, 2);  // 12 and 15
  ASSERT_EQ(window.words.size(), 6U);
  for (const std::size_t row : {0U, 1U, 3U, 4U}) EXPECT_EQ(window.words[row], 10 + row);
}

TEST(Extents, ReachRowsBeyond2To33OfASparseFile) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto file = folder / "sparse.hdf";
  constexpr std::int64_t n_rows = two_to_33 + 1000;
  const auto first_of = [&](GlobalId base) { return base - 20 + 10 * comm.rank(); };  // on both sides of the power
  const auto value_of = [](GlobalId row) { return static_cast<std::int8_t>(row % 101 + 1); };
  const auto access = io::hdf5::parallel_access(comm, file, io::hdf5::Access::write);
  const auto transfer = io::hdf5::independent_transfer();
  const io::hdf5::Shape shape{n_rows, 1, true};
  {
    const auto h5 = io::hdf5::take(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "file");
    const auto how = io::hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "properties");
    ASSERT_GE(H5Pset_alloc_time(how.id(), H5D_ALLOC_TIME_EARLY), 0);
    ASSERT_GE(H5Pset_fill_time(how.id(), H5D_FILL_TIME_NEVER), 0);
    const hsize_t extent = n_rows;
    const io::hdf5::Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
    const auto rows = io::hdf5::take(
        H5Dcreate2(h5.id(), "rows", H5T_STD_I8LE, space.id(), H5P_DEFAULT, how.id(), H5P_DEFAULT), H5Dclose, "rows");
    for (const auto base : {two_to_31, 2 * two_to_31, two_to_33}) {
      std::array<std::int8_t, 10> values{};
      for (std::size_t i = 0; i < 10; ++i) values[i] = value_of(first_of(base) + static_cast<GlobalId>(i));
      EXPECT_TRUE(
          io::hdf5::write_rows({rows.id(), shape, first_of(base), 10}, H5T_NATIVE_INT8, values.data(), transfer.id()))
          << io::hdf5::last_error();
    }
  }
  comm.barrier();

  const auto h5 = io::hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "file");
  const auto rows = io::hdf5::take(H5Dopen2(h5.id(), "rows", H5P_DEFAULT), H5Dclose, "rows");
  for (const auto base : {two_to_31, 2 * two_to_31, two_to_33}) {
    const auto n = 10 * comm.size();  // what all ranks wrote
    std::vector<std::int8_t> values(static_cast<std::size_t>(n), 0);
    EXPECT_TRUE(
        io::hdf5::read_rows({rows.id(), shape, base - 20, n}, mesh::StorageType::int8, values.data(), transfer.id()))
        << io::hdf5::last_error();
    for (int i = 0; i < n; ++i) EXPECT_EQ(values[static_cast<std::size_t>(i)], value_of(base - 20 + i));
  }
}

TEST(Checksums, TakeInRowsBeyond2To33) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr GlobalId n = two_to_33 + 5;
  const std::vector<std::uint64_t> words{5, 6, 7};
  io::Checksum together(n), apart(n), elsewhere(n);
  if (comm.is_first()) {
    together.add(two_to_33 - 1, 1, words);
    for (GlobalId i = 0; i < 3; ++i)
      apart.add(two_to_33 - 1 + i, 1, std::span(words).subspan(static_cast<std::size_t>(i), 1));
    elsewhere.add(two_to_33 - 1 - (GlobalId{1} << 32U), 1, words);
  }

  const auto expected = together.result(comm);

  EXPECT_EQ(apart.result(comm), expected);
  EXPECT_NE(elsewhere.result(comm), expected);
}

TEST(FirstId, IsWrittenOnlyWhereItIsNotZeroAndTellsNeighborsFromRows) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto block = test::kuhn_cube(comm, 2);

  io::write_native(comm, folder / "plain.hdf", assemble::assemble(comm, block));
  io::write_native(comm, folder / "wide.hdf", assemble::assemble(comm, test::numbered_from(two_to_33, block)));

  test::on_first_rank(comm, [&] {
    EXPECT_EQ(test::read_unsigned_attribute(folder / "wide.hdf", "/PAMR", "first_id"), std::uint64_t{1} << 33U);
    const io::hdf5::Silence silence;
    EXPECT_ANY_THROW(test::read_unsigned_attribute(folder / "plain.hdf", "/PAMR", "first_id"));
    const std::string nodes = "/VTKHDF/Connectivity", cells = "/PAMR/cell_to_cell";
    EXPECT_EQ(test::read_dataset<std::int64_t>(folder / "wide.hdf", nodes),
              test::read_dataset<std::int64_t>(folder / "plain.hdf", nodes));
    auto expected = test::read_dataset<std::int64_t>(folder / "plain.hdf", cells);
    for (auto& id : expected) id += id >= 0 ? two_to_33 : 0;
    EXPECT_EQ(test::read_dataset<std::int64_t>(folder / "wide.hdf", cells), expected);
  });
  EXPECT_EQ(io::read_native(comm, folder / "wide.hdf").info.first_id, two_to_33);
}

TEST(FirstId, IsRefusedOutOfRangeOrWhenNeighborsDoNotFollowIt) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto error_with = [&](std::vector<std::int64_t> first_id) {
    io::write_native(comm, folder / "a.hdf", assemble::assemble(comm, test::kuhn_cube(comm, 2)));
    test::on_first_rank(comm, [&] { test::write_attribute(folder / "a.hdf", "/PAMR", "first_id", first_id); });
    return test::error_of_reading(comm, folder / "a.hdf");
  };

  EXPECT_EQ(error_with({0}), "no error");
  EXPECT_THAT(error_with({-1}), testing::HasSubstr("/PAMR@first_id: expected a number from 0"));
  EXPECT_THAT(error_with({(std::int64_t{1} << 53U) + 1}), testing::HasSubstr("/PAMR@first_id: expected a number"));
  EXPECT_THAT(error_with({0, 0}), testing::HasSubstr("/PAMR@first_id"));
  EXPECT_THAT(error_with({two_to_33}),
              testing::HasSubstr("expected a cell from 8589934592 to 8589934639 or a patch from -1 to -6"));
}

}  // namespace wide_rows_test
}  // namespace pamr
