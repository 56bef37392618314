// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/native/native_file.hpp"

namespace pamr {
namespace boundary_test {

using testing::HasSubstr;

/// A script's file: the plain cube of 6 cells, two patches, the four triangles of the faces z = 0 and z = 1.
void write_tagged(const std::filesystem::path& file, std::vector<std::int64_t> nodes,
                  const std::vector<std::int32_t>& patch) {
  test::write_plain_vtkhdf(file, false);
  test::create_group(file, "/PAMR");
  test::write_attribute(file, "/PAMR", "format", std::vector<std::int64_t>{1});
  test::create_group(file, "/PAMR/patches");
  test::write_texts(file, "/PAMR/patches/names", {"floor", "roof"});
  test::create_group(file, "/PAMR/boundary");
  test::write_dataset(file, "/PAMR/boundary/triangles", {nodes.size() / 3, 3}, nodes);
  test::write_dataset(file, "/PAMR/boundary/patch", {patch.size()}, patch);
}

const std::vector<std::int64_t> floor_and_roof{0, 1, 3, 3, 2, 0, 4, 5, 7, 7, 6, 4};

TEST(Boundary, IsReadFromTaggedTrianglesOfAFile) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  test::on_first_rank(comm, [&] { write_tagged(folder / "tagged.hdf", floor_and_roof, {0, 0, 1, 1}); });

  const auto block = io::read_native(comm, folder / "tagged.hdf");
  const auto mesh = assemble::assemble(comm, block);

  EXPECT_EQ(comm.sum(std::ssize(block.boundary.node)), 4);
  ASSERT_EQ(mesh.info.patches.size(), 3U);
  EXPECT_EQ(mesh.info.patches[2].name, "boundary");
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[std::size_t(c)][f];
      if (slot >= 0) continue;
      double z = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != f) z += mesh.points(c)[i].z;
      EXPECT_EQ(mesh.info.patches[std::size_t(mesh::slot_to_patch(slot))].name, z == 0   ? "floor"
                                                                                : z == 3 ? "roof"
                                                                                         : "boundary");
    }
}

TEST(Boundary, IsRefusedWhereItsDatasetsDoNotFit) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  const auto file = folder / "bad.hdf";
  const auto error_of = [&](const std::function<void()>& make) {
    test::on_first_rank(comm, make);
    return test::error_of_reading(comm, file);
  };

  EXPECT_THAT(error_of([&] {
                write_tagged(file, floor_and_roof, {0, 0, 1});
              }),
              HasSubstr("/PAMR/boundary/patch: expected shape 4, found 3"));
  EXPECT_THAT(error_of([&] {
                write_tagged(file, floor_and_roof, {0, 0, 1, 2});
              }),
              HasSubstr("/PAMR/boundary/patch, row 3: expected a patch from 0 to 1, found 2"));
  EXPECT_THAT(error_of([&] { write_tagged(file, floor_and_roof, {0, -1, 1, 1}); }), HasSubstr("row 1"));
  EXPECT_THAT(error_of([&] {
                write_tagged(file, {0, 1, 3, 3, 2, 8}, {0, 0});
              }),
              HasSubstr("/PAMR/boundary/triangles, row 1: expected a node from 0 to 7, found 8"));
  EXPECT_THAT(error_of([&] {
                write_tagged(file, floor_and_roof, {0, 0, 1, 1});
                test::remove_object(file, "/PAMR/boundary/patch");
              }),
              HasSubstr("/PAMR/boundary/patch: expected this dataset, found none"));
  EXPECT_THAT(error_of([&] {
                write_tagged(file, floor_and_roof, {0, 0, 1, 1});
                test::remove_object(file, "/PAMR/patches");
              }),
              HasSubstr("expected names, because there are boundary triangles"));
  EXPECT_THAT(error_of([&] {
                write_tagged(file, floor_and_roof, {0, 0, 1, 1});
                test::remove_object(file, "/PAMR/boundary");
              }),
              HasSubstr("this dataset or /PAMR/boundary, because there are 2 patches"));
}

}  // namespace boundary_test
}  // namespace pamr
