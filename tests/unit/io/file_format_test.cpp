// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cstdlib>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/io/native/native_file.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace file_format_test {

/// Runs the examples of docs/file-format.md, which write `cube.hdf`, in the folder. Collective.
void run_examples(const par::Comm& comm, const test::Folder& folder) {
  int status = 0;
  test::on_first_rank(comm, [&] {
    const auto command = std::string(PAMR_TEST_PYTHON) + " -B '" + PAMR_TEST_SOURCE +
                         "/tests/unit/io/run_examples.py' '" + PAMR_TEST_SOURCE + "/docs/file-format.md' '" +
                         (folder / "").string() + "'";
    status = std::system(command.c_str());
  });
  ASSERT_EQ(status, 0);
}

TEST(FileFormat, ManualHasExamplesThatTheReaderAccepts) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  run_examples(comm, folder);

  const auto block = io::read_native(comm, folder / "cube.hdf");

  const auto whole = test::gather(comm, block);
  EXPECT_EQ(whole.info.n_global_cells, 6);
  EXPECT_EQ(whole.info.length_unit, "m");
  EXPECT_THAT(whole.info.patches, testing::ElementsAre(mesh::Patch{"floor", ""}, mesh::Patch{"walls", ""}));
  ASSERT_EQ(whole.cell_fields.size(), 1U);
  EXPECT_THAT(whole.cell_fields[0].integer(), testing::ElementsAre(1, 0, 0, 0, 0, 0));
  EXPECT_EQ(whole.node_fields.at(0).unit, "K");
  EXPECT_EQ(assemble::assemble(comm, block).info.n_global_cells, 6);
}

TEST(FileFormat, ManualHasChecksumsThatTheReaderCompares) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  run_examples(comm, folder);
  for (const std::string path : {"/VTKHDF/Points", "/VTKHDF/Connectivity", "/PAMR/cell_to_cell",
                                 "/VTKHDF/PointData/temperature", "/PAMR/patches/names"}) {
    test::on_first_rank(comm, [&] {
      std::filesystem::copy_file(folder / "cube.hdf", folder / "bad.hdf",
                                 std::filesystem::copy_options::overwrite_existing);
      test::write_attribute(folder / "bad.hdf", "/PAMR/checksums", path.substr(1), std::vector<std::int64_t>{1});
    });

    EXPECT_THAT(test::error_of_reading(comm, folder / "bad.hdf"),
                testing::AllOf(testing::HasSubstr(path), testing::HasSubstr("checksum")));
  }
}

}  // namespace file_format_test
}  // namespace pamr
