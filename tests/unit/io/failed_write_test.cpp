// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/native/native_file.hpp"
#include "size_limit.hpp"

namespace pamr {
namespace failed_write_test {

using test::Folder;
using test::SizeLimit;

std::string error_of_writing(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh) {
  try {
    io::write_native(comm, file, mesh);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(FailedWrite, LeavesNoFileWhenTheDiskIsFull) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_fields(comm, 4, 1);
  for (const rlim_t bytes : {0, 1000, 20000, 60000}) {
    std::string error;
    {
      const SizeLimit limit(bytes);
      error = error_of_writing(comm, folder / "a.hdf", mesh);
    }

    EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("a.hdf'"), testing::HasSubstr("cannot write it"))) << bytes;
    EXPECT_EQ(error, comm.broadcast(error));
    EXPECT_EQ(folder.n_entries(), 0U);
    comm.barrier();
  }
  EXPECT_EQ(error_of_writing(comm, folder / "a.hdf", mesh), "no error");
}

TEST(FailedWrite, LeavesNoNewFolderOfAnOpenFoamCaseWhenTheDiskIsFull) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_fields(comm, 4, 1);
  test::on_first_rank(comm, [&] { std::filesystem::create_directory(folder / "mine"); });
  for (const auto* name : {"new", "mine"}) {
    std::string error;
    {
      const SizeLimit limit(2000);
      try {
        io::write_foam(comm, folder / name, mesh);
      } catch (const Error& failure) {
        error = failure.what();
      }
    }

    EXPECT_THAT(error, testing::AllOf(testing::HasSubstr((folder / name / "constant" / "polyMesh" / "").string()),
                                      testing::HasSubstr("cannot write it")));
    EXPECT_EQ(error, comm.broadcast(error));
    EXPECT_EQ(folder.n_entries(), 1U);
    EXPECT_TRUE(std::filesystem::is_empty(folder / "mine"));
    comm.barrier();
  }
  io::write_foam(comm, folder / "new", mesh);
  EXPECT_TRUE(std::filesystem::exists(folder / "new" / "constant" / "polyMesh" / "points"));
}

TEST(FailedWrite, LeavesAnExistingFileAsItWas) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", assemble::assemble(comm, assemble::kuhn_cube(comm, 1)));
  const auto before = test::bytes_of(folder / "a.hdf");
  const auto mesh = test::mesh_with_fields(comm, 4, 1);
  comm.barrier();
  {
    const SizeLimit limit(50000);
    error_of_writing(comm, folder / "a.hdf", mesh);
  }

  EXPECT_EQ(test::bytes_of(folder / "a.hdf"), before);
  EXPECT_EQ(folder.n_entries(), 1U);
}

TEST(FailedWrite, SaysThatTheFolderIsMissing) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);

  const auto error = error_of_writing(comm, folder / "nowhere" / "a.hdf", test::mesh_with_fields(comm, 1, 1));

  EXPECT_THAT(error, testing::HasSubstr("No such file or directory"));
  EXPECT_EQ(folder.n_entries(), 0U);
}

TEST(FailedWrite, DoesNotReplaceAFolder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  test::on_first_rank(comm, [&] { std::filesystem::create_directory(folder / "a.hdf"); });

  EXPECT_THAT(error_of_writing(comm, folder / "a.hdf", test::mesh_with_fields(comm, 1, 1)),
              testing::HasSubstr("found a folder of that name"));
  EXPECT_EQ(folder.n_entries(), 1U);
}

TEST(FailedWrite, RefusesValuesThatDoNotFitTheirType) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  auto mesh = test::mesh_with_fields(comm, 2, 1);
  if (mesh.n_cells() > 0) mesh.find_cell_field("refine")->integer().front() = 256;

  EXPECT_THAT(error_of_writing(comm, folder / "a.hdf", mesh),
              testing::AllOf(testing::HasSubstr("/VTKHDF/CellData/refine"), testing::HasSubstr("uint8")));
  EXPECT_EQ(folder.n_entries(), 0U);
}

TEST(FailedWrite, RefusesNamesThatCouldNotBeReadBack) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  for (const std::string name : {"a/b", "", ".", "\xff", "stress"}) {
    auto mesh = test::mesh_with_fields(comm, 1, 1);
    mesh.find_cell_field("refine")->name = name;

    EXPECT_THAT(error_of_writing(comm, folder / "a.hdf", mesh), testing::HasSubstr("cell field '" + name + "'"));
  }
  EXPECT_EQ(folder.n_entries(), 0U);
}

}  // namespace failed_write_test
}  // namespace pamr
