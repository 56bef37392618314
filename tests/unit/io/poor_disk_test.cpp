// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/poor_disk.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <string>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/partial_file.hpp"
#include "pamr/io/shared_output.hpp"
#include "support/error_of.hpp"

namespace pamr {
namespace poor_disk_test {

using test::error_of;
using test::Folder;
using test::PoorDisk;
using testing::HasSubstr;

TEST(PoorDisk, GetsEveryByteThoughAWriteTakesAFewOnly) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  std::string expected;
  for (Rank r = 0; r < comm.size(); ++r) expected += "the numbers of rank " + std::to_string(r) + "\n";
  {
    const PoorDisk disk(7, false);
    io::SharedOutput out(comm, folder / "shared");
    out.append_once("head\n");
    out.append("the numbers of rank " + std::to_string(comm.rank()) + "\n");
    out.commit();
    test::on_first_rank(comm, [&] {
      io::PartialFile alone(folder / "alone");
      alone.make(0);
      alone.write(expected);
      alone.commit();
    });
  }

  EXPECT_EQ(test::bytes_of(folder / "shared"), "head\n" + expected);
  EXPECT_EQ(test::bytes_of(folder / "alone"), expected);
}

TEST(PoorDisk, LeavesTheOldFileWhereTheNewOneCannotBeFlushed) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  test::on_first_rank(comm, [&] {
    for (const auto* name : {"shared", "alone"}) std::ofstream(folder / name) << "old";
  });
  {
    const PoorDisk disk(1000, true);
    EXPECT_THAT(error_of([&] {
                  io::SharedOutput out(comm, folder / "shared");
                  out.append_once("new");
                  out.commit();
                }),
                HasSubstr("shared'"));
    test::on_first_rank(comm, [&] {
      EXPECT_THAT(error_of([&] {
                    io::PartialFile alone(folder / "alone");
                    alone.make(0);
                    alone.write("new");
                    alone.commit();
                  }),
                  HasSubstr("alone'"));
    });
  }

  EXPECT_EQ(test::bytes_of(folder / "shared"), "old");
  EXPECT_EQ(test::bytes_of(folder / "alone"), "old");
  EXPECT_EQ(folder.n_entries(), 2U);
}

}  // namespace poor_disk_test
}  // namespace pamr
