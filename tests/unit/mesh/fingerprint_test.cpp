// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/fingerprint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::mesh {
namespace fingerprint_test {

TEST(Fingerprint, IsThatOfTheDocumentedExample) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::small_mesh(comm, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}});

  EXPECT_EQ(fingerprint(comm, assemble::assemble(comm, block)), 0x77d09ba2d04045caU);
}

TEST(Fingerprint, AgreesWithItsFormulaWrittenOutAgain) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto cube = test::random_mesh(comm, 1, 3);
  auto family = test::closure_family(FamilyKind::face, 0);
  for (auto& lineage : family.lineage) lineage = Lineage(FamilyKind::face, 0, lineage.child(), 3).broken();

  EXPECT_EQ(fingerprint(comm, assemble::assemble(comm, cube)), test::reference_fingerprint(test::gather(comm, cube)));
  const auto mesh = assemble::assemble(comm, test::cut(comm, family));
  EXPECT_EQ(fingerprint(comm, mesh), test::reference_fingerprint(test::gather(comm, mesh)));
}

TEST(Fingerprint, DoesNotDependOnNumberingCornersOrRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const par::Comm alone(MPI_COMM_SELF);
  const auto block = test::random_mesh(comm, 2, 3);
  const auto expected = fingerprint(alone, assemble::assemble(alone, test::random_mesh(alone, 2, 3)));

  EXPECT_EQ(fingerprint(comm, assemble::assemble(comm, block)), expected);
  for (const std::uint64_t seed : {3U, 4U, 5U}) {
    const auto permuted = test::permute(comm, block, seed);
    ASSERT_NE(test::gather(comm, permuted).cell_to_node, test::gather(comm, block).cell_to_node);
    EXPECT_EQ(fingerprint(comm, assemble::assemble(comm, permuted, test::random_destinations(comm, permuted, seed))),
              expected);
  }
}

TEST(Fingerprint, DoesNotDependOnTheSignOfZeroOrTheOrderOfPatches) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto whole = test::gather(comm, test::kuhn_cube(comm, 2));
  const auto expected = fingerprint(comm, assemble::assemble(comm, test::cut(comm, whole)));
  for (auto& p : whole.node_position)
    if (p.x == 0) p.x = -0.0;
  std::swap(whole.info.patches[0], whole.info.patches[4]);
  for (auto& cell : whole.cell_to_cell)
    for (auto& neighbor : cell)
      if (neighbor == -1 || neighbor == -5) neighbor = -6 - neighbor;

  EXPECT_EQ(fingerprint(comm, assemble::assemble(comm, test::cut(comm, whole))), expected);
}

TEST(Fingerprint, ChangesWithEverythingItCovers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, test::random_mesh(comm, 6, 2));
  std::set<std::uint64_t> seen{fingerprint(comm, assemble::assemble(comm, test::cut(comm, whole)))};
  const auto expect_new = [&](const char* what, const std::function<void(BlockMesh&)>& change) {
    auto changed = whole;
    changed.lineage.resize(changed.cell_to_node.size());
    change(changed);
    EXPECT_TRUE(seen.insert(fingerprint(comm, assemble::assemble(comm, test::cut(comm, changed)))).second) << what;
  };
  for (const std::size_t node : {0U, 13U, 26U}) {
    expect_new("a bit of x",
               [&](BlockMesh& m) { m.node_position[node].x = std::nextafter(m.node_position[node].x, 9.0); });
    expect_new("y and z swapped", [&](BlockMesh& m) {
      m.node_position[node].z += 0.125;
      std::swap(m.node_position[node].y, m.node_position[node].z);
    });
  }
  expect_new("name of a patch", [](BlockMesh& m) { m.info.patches[3].name = "wall"; });
  expect_new("patch of a face", [](BlockMesh& m) {
    for (auto& cell : m.cell_to_cell)
      for (auto& neighbor : cell)
        if (neighbor < 0) {
          neighbor = neighbor == -1 ? -2 : -1;
          return;
        }
  });
  expect_new("level", [](BlockMesh& m) { m.lineage[5] = Lineage(FamilyKind::regular, 0, 0, 1); });
  expect_new("kind", [](BlockMesh& m) { m.lineage[5] = Lineage(FamilyKind::edge, 0, 0, 0).broken(); });
  expect_new("other kind", [](BlockMesh& m) { m.lineage[5] = Lineage(FamilyKind::face, 0, 0, 0).broken(); });
}

TEST(Fingerprint, IsZeroForAMeshWithoutCells) {
  const par::Comm comm(MPI_COMM_WORLD);

  EXPECT_EQ(fingerprint(comm, DistMesh{}), 0U);
}

}  // namespace fingerprint_test
}  // namespace pamr::mesh
