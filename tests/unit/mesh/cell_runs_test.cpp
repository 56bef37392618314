// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/cell_runs.hpp"

#include <gtest/gtest.h>

namespace pamr {
namespace cell_runs_test {

mesh::DistMesh cells(std::vector<GlobalId> ids, GlobalId first, GlobalId n) {
  mesh::DistMesh mesh;
  mesh.info.first_id = first;
  mesh.info.n_global_cells = n;
  mesh.cell_global = std::move(ids);
  return mesh;
}

TEST(CellRuns, AreFoundWithRanksThatHoldNothing) {
  const par::Comm comm(MPI_COMM_WORLD);
  // ranks 0, 2, ... hold none, ranks 1, 3, ... three each
  std::vector<GlobalId> ids, expected{100};
  for (Rank r = 0; r < comm.size(); ++r) {
    for (int k = 0; r % 2 == 1 && k < 3; ++k)
      if (r == comm.rank()) ids.push_back(expected.back() + k);
    expected.push_back(expected.back() + (r % 2 == 1 ? 3 : 0));
  }

  EXPECT_EQ(mesh::cell_runs(comm, cells(ids, 100, expected.back() - 100)), expected);
}

TEST(CellRuns, AreNoneWhereOneRankHoldsCellsOfAnother) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::vector<GlobalId> ids{2 * comm.rank(), 2 * comm.rank() + 1};
  if (comm.size() > 1 && comm.rank() == 0) ids = {0, 2};
  if (comm.size() > 1 && comm.rank() == 1) ids = {1, 3};

  EXPECT_EQ(mesh::cell_runs(comm, cells(ids, 0, 2 * comm.size())).empty(), comm.size() > 1);
}

}  // namespace cell_runs_test
}  // namespace pamr
