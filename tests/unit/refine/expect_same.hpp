// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "support/reference_refine.hpp"

/// What the refiner made beside what its twin made.
namespace pamr::test {

template <class T>
void expect_same_rows(const std::vector<T>& found, const std::vector<T>& expected, const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(found[i] == expected[i]) << what << " " << i;
}

/// Corners, neighbors, patches, lineage and parents of all cells by number, and all nodes by number, to the last bit.
inline void expect_same(const mesh::BlockMesh& found, const ReferenceRefinement& expected) {
  expect_same_rows(found.cell_to_node, expected.mesh.cell_to_node, "corners of cell");
  expect_same_rows(found.node_position, expected.mesh.node_position, "position of node");
  expect_same_rows(found.cell_to_cell, expected.mesh.cell_to_cell, "neighbors and patches of cell");
  expect_same_rows(found.lineage, expected.mesh.lineage, "lineage of cell");
  ASSERT_EQ(found.cell_fields.size(), 1U);
  expect_same_rows(found.cell_fields.front().integer(), expected.parent, "parent of cell");
}

inline void expect_same_counts(const adapt::Report& report, const ReferenceRefinement& expected) {
  EXPECT_EQ(report.cells_out, expected.mesh.info.n_global_cells);
  EXPECT_EQ(report.nodes_out, expected.mesh.info.n_global_nodes);
  EXPECT_EQ(report.closure.families_rebuilt, expected.families_rebuilt);
  EXPECT_EQ(report.closure.families_kept, expected.families_kept);
}

}  // namespace pamr::test
