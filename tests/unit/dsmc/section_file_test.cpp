// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/section_file.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "support/poor_disk.hpp"
#include "unit/io/files.hpp"

namespace pamr::dsmc {
namespace section_file_test {

/// Words 0, 1, 2, ... times a number, in rows of three.
Section table(const par::Comm& comm, std::uint64_t times) {
  Section section{"words", 20, 3, {}};
  const auto range = par::block_range(section.rows, comm.rank(), comm.size());
  for (auto word = 3 * range.begin; word < 3 * range.end; ++word)
    section.block.push_back(times * static_cast<std::uint64_t>(word));
  return section;
}

TEST(SectionFile, HoldsEveryWordThoughAWriteTakesAFewBytesOnly) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  const auto file = (folder / "state").string();
  const auto section = table(comm, 0x0123456789abcdefU);
  {
    const test::PoorDisk disk(5, false);
    write_sections(comm, file, {{"step", 7}}, {&section});
  }

  const SectionFile written(comm, file);

  EXPECT_EQ(written.header()["step"], 7);
  EXPECT_EQ(written.read("words", 3).block, section.block);
}

TEST(SectionFile, StaysAsItWasWhereTheNewOneCannotBeFlushed) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  const auto file = (folder / "state").string();
  const auto old = table(comm, 1), section = table(comm, 2);
  write_sections(comm, file, {{"step", 7}}, {&old});
  {
    const test::PoorDisk disk(1000, true);
    EXPECT_THROW(write_sections(comm, file, {{"step", 8}}, {&section}), Error);
  }

  const SectionFile left(comm, file);

  EXPECT_EQ(left.header()["step"], 7);
  EXPECT_EQ(left.read("words", 3).block, old.block);
  EXPECT_EQ(folder.n_entries(), 1U);
}

}  // namespace section_file_test
}  // namespace pamr::dsmc
