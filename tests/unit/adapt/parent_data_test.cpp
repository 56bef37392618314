// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/parent_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "support/meshes.hpp"

namespace pamr::adapt {
namespace parent_data_test {

struct Item {
  std::int32_t cell = 0;
  std::int16_t place = 0;
};

/// As many items as the number of the cell says: 0 to 4.
CellRows<Item> rows_of(const std::vector<GlobalId>& cells) {
  CellRows<Item> rows;
  for (const auto id : cells) {
    for (GlobalId k = 0; k < id % 5; ++k)
      rows.value.push_back({static_cast<std::int32_t>(id), static_cast<std::int16_t>(k)});
    rows.offset.push_back(rows.value.size());
  }
  return rows;
}

void expect_rows(const CellRows<Item>& rows, const std::vector<GlobalId>& cells) {
  ASSERT_EQ(rows.offset.size(), cells.size() + 1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ASSERT_EQ(std::ssize(rows.row(i)), cells[i] % 5);
    for (std::size_t k = 0; k < rows.row(i).size(); ++k) {
      EXPECT_EQ(rows.row(i)[k].cell, cells[i]);
      EXPECT_EQ(rows.row(i)[k].place, std::int16_t(k));
    }
  }
}

TEST(DataOfParents, FollowsTheCellsThroughRefinementsWhereverTheyGo) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 2, 3));
  for (int turn = 0; turn < 2; ++turn) {
    const auto before = mesh.info.cell_ids();
    const auto held = mesh.cell_global;
    const auto rows = rows_of(held);
    std::vector<std::uint8_t> flags;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(norm(mesh.points(c)[0]) < 0.5 ? 1 : 0);

    auto result = refine(comm, std::move(mesh), flags);
    mesh = std::move(result.mesh);
    const auto of_parents = data_of_parents(comm, before, held, rows, mesh);

    expect_rows(of_parents, mesh.find_cell_field(mesh::parent_field)->integer());
  }
}

TEST(FetchCellRows, SaysWhatIsWrongOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto error_of = [&](const std::vector<GlobalId>& held, const CellRows<Item>& rows,
                            const std::vector<GlobalId>& wanted) {
    std::string error = "no error";
    try {
      (void)fetch_cell_rows(comm, 100, held, rows, wanted);
    } catch (const Error& thrown) {
      error = thrown.what();
    }
    EXPECT_EQ(error, comm.broadcast(error));
    return error;
  };
  const std::vector<GlobalId> own{comm.rank(), 50 + comm.rank()}, none;
  const bool is_last = comm.rank() == comm.size() - 1;
  auto broken = rows_of(own);
  if (is_last) broken.offset.pop_back();

  EXPECT_EQ(error_of(own, rows_of(own), {50, 0, 0}), "no error");
  EXPECT_EQ(error_of(own, rows_of(own), is_last ? std::vector<GlobalId>{99} : none),
            "data of cells: expected a row for cell 99, found none on any rank");
  EXPECT_THAT(error_of(own, rows_of(own), is_last ? std::vector<GlobalId>{100} : none),
              testing::HasSubstr("expected cells from 0 to 99, found 100"));
  EXPECT_THAT(error_of(own, broken, none), testing::HasSubstr("found other offsets"));
}

}  // namespace parent_data_test
}  // namespace pamr::adapt
