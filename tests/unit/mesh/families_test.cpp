// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/families.hpp"

#include <gtest/gtest.h>

#include "pamr/geometry/tet_shape.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::mesh {
namespace {

using Cells = std::vector<std::array<GlobalId, 4>>;

struct Template {
  FamilyKind kind;
  int index;
};

std::vector<Template> all_templates() {
  std::vector<Template> all;
  for (int edge = 0; edge < 6; ++edge) all.push_back({FamilyKind::edge, edge});
  for (int face = 0; face < 4; ++face) all.push_back({FamilyKind::face, face});
  return all;
}

TEST(Families, FillTheirParentWithPositiveCells) {
  for (const auto [kind, index] : all_templates()) {
    const auto whole = test::closure_family(kind, index);

    EXPECT_DOUBLE_EQ(test::reference_volume(whole), 1.0 / 6.0);
    for (const auto& n : whole.cell_to_node) {
      const auto at = [&](std::size_t i) { return whole.node_position[static_cast<std::size_t>(n[i])]; };
      EXPECT_DOUBLE_EQ(geometry::volume({at(0), at(1), at(2), at(3)}),
                       1.0 / 6.0 / static_cast<double>(whole.cell_to_node.size()));
    }
  }
}

TEST(Families, GiveTheirParentBack) {
  for (const auto [kind, index] : all_templates()) {
    const auto whole = test::closure_family(kind, index);

    EXPECT_TRUE(fits_template<GlobalId>(whole.lineage[0], whole.cell_to_node));
    EXPECT_EQ(parent_corners<GlobalId>(whole.lineage[0], whole.cell_to_node), (std::array<GlobalId, 4>{0, 1, 2, 3}));
  }
}

TEST(Families, DoNotFitWithAnyOneCornerChanged) {
  for (const auto [kind, index] : all_templates()) {
    const auto whole = test::closure_family(kind, index);
    // Corners of the parent held by one child only (4 in all: i, j of 1:2; a, b, c of 1:4 and none else) may be any
    // node.
    int n_accepted = 0;
    for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
      for (std::size_t i = 0; i < 4; ++i) {
        auto cells = whole.cell_to_node;
        cells[c][i] = 99;
        n_accepted += fits_template<GlobalId>(whole.lineage[0], cells) ? 1 : 0;
      }
    EXPECT_EQ(n_accepted, kind == FamilyKind::edge ? 2 : 3);
  }
}

TEST(Families, AreNotTakenForAnotherTemplate) {
  for (const auto [kind, index] : all_templates()) {
    const auto whole = test::closure_family(kind, index);
    for (const auto other : all_templates())
      EXPECT_EQ(other.kind == kind && fits_template<GlobalId>(Lineage(kind, other.index, 0, 0), whole.cell_to_node),
                other.kind == kind && other.index == index);
  }
}

TEST(Lineage, IsWellFormedOnlyWithinItsTables) {
  int n_well_formed = 0;
  for (std::uint32_t bits = 0; bits < 0x80; ++bits) n_well_formed += is_well_formed(Lineage(bits)) ? 1 : 0;

  EXPECT_EQ(n_well_formed, 1 + 6 * 2 + 4 * 4);
  EXPECT_TRUE(is_well_formed(Lineage(FamilyKind::face, 3, 3, 255).broken()));
  EXPECT_FALSE(is_well_formed(Lineage(0x10000U)));
}

TEST(Lineage, NamesItsSiblings) {
  const Lineage first(FamilyKind::face, 2, 0, 7);

  EXPECT_EQ(sibling(first, 3), Lineage(FamilyKind::face, 2, 3, 7));
  EXPECT_EQ(sibling(sibling(first, 3), 0), first);
  EXPECT_EQ(describe(sibling(first, 3)), "1:4 closure cell of face 2, child 3, level 7");
}

}  // namespace
}  // namespace pamr::mesh
