// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/read_for_refinement.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/balance/expected_work.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace read_for_refinement_test {

namespace fs = std::filesystem;

/// The file of a mesh, in a folder of the test's own, removed at the end. Collective.
class MeshFile {
 public:
  MeshFile(const par::Comm& comm, const mesh::DistMesh& mesh)
      : comm_(&comm), path_(fs::temp_directory_path() / (comm.broadcast(std::to_string(getpid())) + "-read.hdf")) {
    io::write_native(comm, path_, mesh);
  }
  ~MeshFile() {
    comm_->barrier();
    if (comm_->is_first()) fs::remove(path_);
  }
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;
  MeshFile(MeshFile&&) = delete;
  MeshFile& operator=(MeshFile&&) = delete;
  const fs::path& path() const { return path_; }

 private:
  const par::Comm* comm_;
  fs::path path_;
};

/// A cube marked in one of its corners.
mesh::DistMesh marked_cube(const par::Comm& comm) {
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 8));
  mesh::CellField marks{"refine", "", 1, mesh::StorageType::int8, std::vector<std::int64_t>{}};
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c)[0];
    marks.integer().push_back(p.x < 0.4 && p.y < 0.4 && p.z < 0.4 ? 1 : 0);
  }
  mesh.cell_fields.push_back(std::move(marks));
  return mesh;
}

mesh::DistMesh read(const par::Comm& comm, const fs::path& file, const adapt::ReadingOptions& options) {
  StepTimer timer([&] { return comm.traffic(); });
  return adapt::read_for_refinement(comm, file, options, timer);
}

std::int64_t work_of(const mesh::DistMesh& mesh) {
  std::int64_t n = 0;
  for (const auto mark : mesh.cell_fields.front().integer()) n += mark == 1 ? 8 : 1;
  return n;
}

TEST(ReadForRefinement, GivesEachRankAboutTheSameWorkByTheMarks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = marked_cube(comm);
  const MeshFile file(comm, mesh);

  const auto fair = read(comm, file.path(), {.ordering = adapt::Ordering::keep});
  const auto in_order = read(comm, file.path(), {.ordering = adapt::Ordering::curve});
  const auto even = read(comm, file.path(), {.marks_field = "refine", .ordering = adapt::Ordering::automatic});

  const auto mean = static_cast<double>(comm.sum(work_of(fair))) / comm.size();
  EXPECT_LE(static_cast<double>(comm.max(work_of(fair))), 1.25 * mean);  // closure is foreseen too, not only marks
  EXPECT_LE(static_cast<double>(comm.max(work_of(in_order))), 1.25 * mean);
  EXPECT_EQ(mesh::fingerprint(comm, fair), mesh::fingerprint(comm, mesh));
  EXPECT_EQ(mesh::fingerprint(comm, even), mesh::fingerprint(comm, mesh));
  const auto canonical = assemble::assemble(comm, io::read_native(comm, file.path()));
  if (comm.size() == 4) {
    EXPECT_GT(comm.max(work_of(canonical)), comm.max(work_of(fair)));
  }
}

TEST(ReadForRefinement, FollowsTheFieldOfTheWorkAndLeavesItOut) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = marked_cube(comm);
  std::vector<std::uint8_t> work;
  for (const auto id : mesh.cell_global) work.push_back(id < 100 ? 255 : 1);
  balance::set_work(mesh, "refine", work);
  const MeshFile file(comm, mesh);

  const auto fair = read(comm, file.path(), {.ordering = adapt::Ordering::keep});

  EXPECT_EQ(fair.find_cell_field("refine_work"), nullptr);
  std::int64_t here = 0;
  for (const auto id : fair.cell_global) here += id < 100 ? 255 : 1;
  EXPECT_NEAR(static_cast<double>(here), static_cast<double>(comm.sum(here)) / comm.size(), 256);
}

TEST(ReadForRefinement, NamesCellsAsTheFileDoesWhenItWasPutInOrder) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = marked_cube(comm);
  for (std::size_t c = 0; c < mesh.cell_global.size(); ++c)
    if (mesh.cell_global[c] == 1234) mesh.cell_fields.front().integer()[c] = 7;
  const MeshFile file(comm, mesh);

  // the caller finds the bad mark in the mesh as it is in the file
  const auto as_it_is = read(comm, file.path(), {.ordering = adapt::Ordering::curve});

  EXPECT_TRUE(as_it_is.cell_origin.empty());
  EXPECT_EQ(mesh::fingerprint(comm, as_it_is), mesh::fingerprint(comm, mesh));
}

TEST(ReadForRefinement, RefusesAMissingFileOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);

  EXPECT_THROW(read(comm, "no such file.hdf", {}), Error);
}

}  // namespace read_for_refinement_test
}  // namespace pamr
