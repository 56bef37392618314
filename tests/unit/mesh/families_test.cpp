// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/families.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "pamr/geometry/tet_shape.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::mesh {
namespace families_test {

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
  for (std::uint64_t bits = 0; bits < 0x800; ++bits) n_well_formed += is_well_formed(Lineage(bits)) ? 1 : 0;

  EXPECT_EQ(n_well_formed, n_family_codes);
  EXPECT_TRUE(is_well_formed(Lineage(FamilyKind::face, 3, 3, 255).broken()));
  EXPECT_FALSE(is_well_formed(Lineage::regular(1).broken()));
  EXPECT_FALSE(is_well_formed(Lineage(Lineage::regular(1).red_child(0).closed(1, 0).bits() | 1U << 11U)));
}

TEST(Lineage, HasAPathOfWholeNumbersNoLongerThanTheLevel) {
  const auto with = [](int level, std::uint64_t path) { return Lineage(Lineage::regular(level).bits() | path << 20U); };
  for (int level = 0; level <= 20; ++level)
    for (unsigned top = 0; top < 44; ++top) {
      const bool can_be = top % 3 == 0 && top > 0 && top <= 42 && static_cast<int>(top) / 3 <= level;
      EXPECT_EQ(is_well_formed(with(level, std::uint64_t{1} << top)), can_be) << level << " " << top;
      EXPECT_EQ(is_well_formed(with(level, (std::uint64_t{2} << top) - 1)), can_be) << level << " " << top;
    }
  EXPECT_TRUE(is_well_formed(with(0, 0)));
}

TEST(Lineage, LevelZeroIsTheWordZero) {
  EXPECT_EQ(Lineage{}.bits(), 0U);
  EXPECT_EQ(Lineage{}, Lineage::regular(0));
  EXPECT_EQ(Lineage{}, Lineage(FamilyKind::regular, 0, 0, 0));
  EXPECT_EQ(Lineage{}.depth(), 0);
}

TEST(Lineage, KeepsStateAndChildApartFromEverythingElse) {
  for (int state = 1; state < n_family_states; ++state)
    for (int child = 0; child < family_size_of_state[static_cast<std::size_t>(state)]; ++child) {
      const auto base = Lineage::regular(8).red_child(5).red_child(7);
      const auto cell = base.closed(state, child);
      EXPECT_EQ(cell.state(), state);
      EXPECT_EQ(cell.child(), child);
      EXPECT_EQ(cell.family_size(), family_size_of_state[static_cast<std::size_t>(state)]);
      EXPECT_EQ(cell.base(), base);
      EXPECT_TRUE(is_well_formed(cell) && is_well_formed(cell.broken()) && cell.is_removable());
      EXPECT_EQ(cell.broken().state(), state);
      EXPECT_EQ(cell.broken().child(), child);
      EXPECT_EQ(cell.broken().level(), 10);
      EXPECT_EQ(cell.broken().depth(), 0);
      EXPECT_EQ(cell.base_for_split(), Lineage::regular(10));
      EXPECT_EQ(cell.broken().base_for_split(), Lineage::regular(10));
      EXPECT_EQ(base.base_for_split(), base);
      if (state <= 10) {
        EXPECT_EQ(Lineage(cell.kind(), cell.index(), child, 3), Lineage::regular(3).closed(state, child));
      }
    }
}

TEST(Lineage, RemembersTheLastFourteenChildNumbersAndAllLevels) {
  const auto number = [](int level) { return (3 * level + 1) % 8; };
  auto cell = Lineage{};
  std::vector<Lineage> ancestor{cell};
  while (cell.level() < max_level) {
    cell = cell.red_child(number(cell.level()));
    ancestor.push_back(cell);
    EXPECT_TRUE(is_well_formed(cell));
    EXPECT_EQ(cell.level(), static_cast<int>(ancestor.size()) - 1);
    EXPECT_EQ(cell.depth(), std::min(cell.level(), max_known_depth));
    EXPECT_EQ(cell.bits() >> 63U, 0U);
  }
  for (int back = 1; back <= max_known_depth; ++back) {
    EXPECT_EQ(cell.child_number(), number(cell.level() - 1));
    cell = cell.red_parent();
    EXPECT_TRUE(is_well_formed(cell));
    EXPECT_EQ(cell.level(), max_level - back);
    EXPECT_EQ(cell.depth(), max_known_depth - back);
  }
  EXPECT_EQ(cell, Lineage::regular(max_level - max_known_depth));

  EXPECT_EQ(ancestor[9].red_parent(), ancestor[8]);
  EXPECT_EQ(ancestor[1].red_parent(), Lineage{});
}

TEST(Lineage, NamesItsSiblings) {
  const Lineage first(FamilyKind::face, 2, 0, 7);

  EXPECT_EQ(sibling(first, 3), Lineage(FamilyKind::face, 2, 3, 7));
  EXPECT_EQ(sibling(sibling(first, 3), 0), first);
  EXPECT_EQ(describe(sibling(first, 3)), "1:4 closure cell of face 2, child 3, level 7");
  EXPECT_EQ(describe(Lineage{}.red_child(4).red_child(1).red_child(7)), "regular cell, level 3, child numbers 4 1 7");
}

/// The cells of a tree in the order of their numbers: each is split or not by lot, down to a level.
void append_tree(Lineage cell, int levels, std::uint64_t& dice, std::vector<Lineage>& cells) {
  dice = dice * 6364136223846793005U + 1442695040888963407U;
  if (levels > 0 && dice >> 62U != 0) {
    for (int child = 0; child < 8; ++child) append_tree(cell.red_child(child), levels - 1, dice, cells);
  } else if (dice >> 60U & 1U) {
    for (int child = 0; child < 3; ++child) cells.push_back(cell.closed(11, child));
  } else {
    cells.push_back(cell);
  }
}

TEST(Lineage, TellsWhichCellsFollowInATree) {
  std::uint64_t dice = 1;
  for (int i = 0; i < 20; ++i) {
    std::vector<Lineage> cells;
    append_tree(Lineage::regular(i / 2), 1 + i % 4, dice, cells);
    for (std::size_t c = 1; c < cells.size(); ++c) ASSERT_TRUE(follows_in_tree(cells[c - 1], cells[c]));
    for (std::size_t c = 2; c < cells.size(); ++c) {  // not what comes after, nor what came before
      if (!cells[0].is_closure()) {
        ASSERT_FALSE(follows_in_tree(cells[c], cells[0])) << c;
      }
      if (!cells[c].is_closure() && cells[c - 2].base() != cells[c - 1].base()) {
        ASSERT_FALSE(follows_in_tree(cells[c - 2], cells[c])) << c;
      }
    }
  }
  const auto root = Lineage::regular(0);
  EXPECT_FALSE(follows_in_tree(root, root));
  EXPECT_FALSE(follows_in_tree(root.red_child(7), root.red_child(0))) << "the next tree";
  EXPECT_FALSE(follows_in_tree(root.red_child(3), Lineage::regular(1).red_child(4))) << "another level";
  EXPECT_TRUE(follows_in_tree(root.red_child(2).red_child(7), root.red_child(3)));
  EXPECT_TRUE(follows_in_tree(root.red_child(2), root.red_child(3).red_child(0).red_child(0)));
}

}  // namespace families_test
}  // namespace pamr::mesh
