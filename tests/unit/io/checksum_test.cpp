// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/checksum.hpp"

#include <gmock/gmock.h>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/io/native/native_file.hpp"

namespace pamr {
namespace checksum_test {

using test::Folder;

std::vector<std::uint64_t> words(GlobalId n, std::uint64_t seed) {
  std::vector<std::uint64_t> result;
  for (GlobalId i = 0; i < n; ++i) result.push_back(combine(seed, static_cast<std::uint64_t>(i)));
  return result;
}

TEST(Checksum, IsTheSameInWhateverPiecesTheRowsAreHeld) {
  const par::Comm comm(MPI_COMM_WORLD);
  const GlobalId n = 3 * io::Checksum::block_rows - 100;
  const auto values = words(2 * n, 1);
  const auto rows = [&](GlobalId begin, GlobalId end) {
    return std::span<const std::uint64_t>(values).subspan(static_cast<std::size_t>(2 * begin),
                                                          static_cast<std::size_t>(2 * (end - begin)));
  };

  io::Checksum whole(n), pieces(n);
  if (comm.is_first()) whole.add(0, 2, rows(0, n));
  const auto range = par::block_range(n, comm.rank(), comm.size());
  const auto middle = range.begin + range.count() / 3;
  pieces.add(middle, 2, rows(middle, range.end));
  pieces.add(range.begin, 2, rows(range.begin, middle));

  EXPECT_EQ(whole.result(comm), pieces.result(comm));
}

TEST(Checksum, HasTheValueThatTheFormatSpecifies) {
  const par::Comm comm(MPI_COMM_WORLD);
  io::Checksum checksum(2);
  if (comm.is_first()) checksum.add(0, 1, std::vector<std::uint64_t>{5, 6});

  EXPECT_EQ(checksum.result(comm), 0xce9b3f806551c69fU);  // docs/file-format.md, computed by the Python there
  EXPECT_EQ(io::Checksum(0).result(comm), 0U);
}

TEST(Checksum, IsThatOfTheFormatForRowsOfEveryWidthAndInEveryNumber) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (std::size_t width = 1; width <= 6; ++width)
    for (GlobalId n = 1; n <= 40; ++n) {
      const auto n_words = static_cast<GlobalId>(width) * n;
      const auto values = words(n_words, width);
      std::uint64_t block = 0;
      for (GlobalId row = 0; row < n; ++row) {
        auto hash = static_cast<std::uint64_t>(row);
        for (std::size_t i = 0; i < width; ++i) hash = combine(hash, values[static_cast<std::size_t>(row) * width + i]);
        block += mix(hash);
      }
      io::Checksum checksum(n);
      if (comm.is_first()) checksum.add(0, width, values);

      EXPECT_EQ(checksum.result(comm), combine(static_cast<std::uint64_t>(n), block)) << width << " words, " << n;
    }
}

TEST(Checksum, TellsExchangedRowsAndMovedValuesApart) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto of = [&](std::vector<std::uint64_t> values, std::size_t width) {
    io::Checksum checksum(static_cast<GlobalId>(values.size() / width));
    if (comm.is_first()) checksum.add(0, width, values);
    return checksum.result(comm);
  };

  EXPECT_NE(of({1, 2}, 1), of({2, 1}, 1));
  EXPECT_NE(of({1, 2}, 2), of({2, 1}, 2));
  EXPECT_NE(of({1, 2}, 1), of({1, 2}, 2));
  EXPECT_NE(of({0}, 1), of({0, 0}, 1));
}

TEST(Checksum, OfTextsCoversEachOfThem) {
  using Texts = std::vector<std::string>;

  EXPECT_NE(io::checksum_of(Texts{"ab", "c"}), io::checksum_of(Texts{"a", "bc"}));
  EXPECT_NE(io::checksum_of(Texts{"a"}), io::checksum_of(Texts{"a", ""}));
  EXPECT_EQ(io::checksum_of(Texts{}), 0U);
}

TEST(NativeFile, NoticesAFlippedByteInEveryDataset) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "good.hdf", test::mesh_with_fields(comm, 3, 6), {.provenance = "a test"});
  for (const std::string path :
       {"/VTKHDF/NumberOfPoints", "/VTKHDF/NumberOfCells", "/VTKHDF/NumberOfConnectivityIds", "/VTKHDF/Points",
        "/VTKHDF/Connectivity", "/VTKHDF/Offsets", "/VTKHDF/Types", "/VTKHDF/CellData/refine",
        "/VTKHDF/CellData/stress", "/VTKHDF/CellData/région", "/VTKHDF/PointData/potential", "/VTKHDF/PointData/number",
        "/PAMR/cell_to_cell", "/PAMR/lineage", "/PAMR/patches/names", "/PAMR/patches/kinds", "/PAMR/surfaces",
        "/PAMR/provenance"}) {
    for (const double position : {0.0, 0.4, 0.999}) {
      test::on_first_rank(comm, [&] {
        std::filesystem::copy_file(folder / "good.hdf", folder / "bad.hdf",
                                   std::filesystem::copy_options::overwrite_existing);
        const auto extent = test::extent_of(folder / "bad.hdf", path);
        test::flip_byte(folder / "bad.hdf",
                        extent.offset + static_cast<std::uint64_t>(position * static_cast<double>(extent.bytes)));
      });

      const auto error = test::error_of_reading(comm, folder / "bad.hdf");

      EXPECT_THAT(error, testing::StartsWith("file '")) << path << " at " << position;
    }
  }
}

TEST(NativeFile, ReadsDamagedValuesWhenToldNotToVerify) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", test::mesh_with_fields(comm, 2, 7));
  test::on_first_rank(comm, [&] {
    test::flip_byte(folder / "a.hdf", test::extent_of(folder / "a.hdf", "/VTKHDF/CellData/stress").offset);
  });

  EXPECT_THAT(test::error_of_reading(comm, folder / "a.hdf"),
              testing::AllOf(testing::HasSubstr("/VTKHDF/CellData/stress"), testing::HasSubstr("checksum")));
  EXPECT_EQ(io::read_native(comm, folder / "a.hdf", {.verify_checksums = false}).cell_fields.size(), 3U);
}

TEST(NativeFile, RemarksOnFieldsThatSomebodyRewroteAndReadsThem) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", test::mesh_with_fields(comm, 2, 7));
  test::on_first_rank(comm, [&] {
    for (const auto* path : {"/VTKHDF/CellData/refine", "/VTKHDF/PointData/potential"})
      test::flip_byte(folder / "a.hdf", test::extent_of(folder / "a.hdf", path).offset);
  });

  std::vector<std::string> remarks;
  const auto block = io::read_native(comm, folder / "a.hdf",
                                     {.remark = [&](const std::string& remark) { remarks.push_back(remark); }});

  EXPECT_EQ(block.cell_fields.size(), 3U);
  ASSERT_EQ(remarks.size(), 2U);  // on every rank
  EXPECT_THAT(remarks[0], testing::HasSubstr("a.hdf', /VTKHDF/PointData/potential: the values do not agree"));
  EXPECT_THAT(remarks[1], testing::HasSubstr("/VTKHDF/CellData/refine"));
}

}  // namespace checksum_test
}  // namespace pamr
