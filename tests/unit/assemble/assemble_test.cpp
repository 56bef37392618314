// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/assemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr::assemble {
namespace assemble_test {

using testing::HasSubstr;

void expect_same_fields(const std::vector<mesh::Field>& found, const std::vector<mesh::Field>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t f = 0; f < found.size(); ++f) {
    EXPECT_EQ(found[f].name, expected[f].name);
    EXPECT_EQ(found[f].value, expected[f].value) << found[f].name;
  }
}

void expect_same(const mesh::BlockMesh& found, const mesh::BlockMesh& expected) {
  EXPECT_EQ(found.cell_to_node, expected.cell_to_node);
  EXPECT_EQ(found.cell_to_cell, expected.cell_to_cell);
  EXPECT_EQ(found.node_position, expected.node_position);
  EXPECT_EQ(found.info.patches, expected.info.patches);
  if (!expected.lineage.empty()) {
    EXPECT_EQ(found.lineage, expected.lineage);
  }
  expect_same_fields(found.cell_fields, expected.cell_fields);
  expect_same_fields(found.node_fields, expected.node_fields);
}

/// What `DistMesh` promises of its arrays, apart from the mesh they describe.
void expect_well_kept(const par::Comm& comm, const mesh::DistMesh& mesh) {
  EXPECT_TRUE(std::is_sorted(mesh.cell_global.begin(), mesh.cell_global.end()));
  ASSERT_EQ(mesh.border_offset.size(), mesh.border_rank.size() + 1);
  ASSERT_EQ(mesh.border_face.size(), mesh.border_offset.back());
  ASSERT_EQ(mesh.ghost_global.size(), mesh.border_face.size());
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    EXPECT_NE(mesh.border_rank[i], comm.rank());
    EXPECT_LT(mesh.border_offset[i], mesh.border_offset[i + 1]);
    if (i > 0) {
      EXPECT_LT(mesh.border_rank[i - 1], mesh.border_rank[i]);
    }
  }
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k)
    EXPECT_EQ(mesh.cell_to_cell[static_cast<std::size_t>(mesh.border_face[k].cell)]
                               [static_cast<std::size_t>(mesh.border_face[k].slot)],
              mesh.n_cells() + static_cast<LocalId>(k));
  LocalId next = 0;  // nodes are numbered in order of first use
  for (const auto& nodes : mesh.cell_to_node)
    for (const auto node : nodes) {
      ASSERT_LE(node, next);
      if (node == next) ++next;
    }
  EXPECT_EQ(next, mesh.n_nodes());
}

mesh::BlockMesh with_fields(mesh::BlockMesh block, const par::Comm& comm) {
  mesh::Field number{"number", "1", 1, mesh::StorageType::int64, std::vector<std::int64_t>{}};
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c)
    number.integer().push_back(block.first_cell + static_cast<GlobalId>(c));
  mesh::Field nodes{"nodes", "", 4, mesh::StorageType::float64, std::vector<double>{}};
  for (const auto& cell : block.cell_to_node)
    for (const auto node : cell) nodes.real().push_back(static_cast<double>(node) + 0.5);
  mesh::Field position{"position", "m", 3, mesh::StorageType::float64, std::vector<double>{}};
  for (const auto& p : block.node_position) position.real().insert(position.real().end(), {p.x, p.y, p.z});
  mesh::Field tag{"tag", "", 1, mesh::StorageType::int32, std::vector<std::int64_t>{}};
  const auto range = par::block_range(block.info.n_global_nodes, comm.rank(), comm.size());
  for (auto id = range.begin; id < range.end; ++id) tag.integer().push_back(3 * id);
  block.cell_fields = {number, nodes};
  block.node_fields = {position, tag};
  return block;
}

TEST(Assemble, KeepsTheKuhnCubeWhereItLies) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::kuhn_cube(comm, 3);

  const auto mesh = assemble(comm, block);

  EXPECT_EQ(mesh.cell_to_node.size(), block.cell_to_node.size());
  expect_well_kept(comm, mesh);
  expect_same(test::gather(comm, mesh), test::gather(comm, block));
}

TEST(Assemble, GivesTheSameMeshFromAnyDestinations) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto block = with_fields(test::random_mesh(comm, seed, 3), comm);

    const auto mesh = assemble(comm, block, test::random_destinations(comm, block, seed));

    expect_well_kept(comm, mesh);
    expect_same(test::gather(comm, mesh), test::gather(comm, block));
  }
}

TEST(Assemble, SendsEachCellToItsDestination) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 4, 2);
  auto whole = test::gather(comm, block);
  const auto all = test::random_destinations(comm, whole, 9);

  const auto mesh = assemble(comm, block, test::random_destinations(comm, block, 9));

  std::vector<GlobalId> expected;
  for (std::size_t c = 0; c < all.size(); ++c)
    if (all[c] == comm.rank()) expected.push_back(static_cast<GlobalId>(c));
  EXPECT_EQ(mesh.cell_global, expected);
}

TEST(Assemble, LeavesRanksEmptyWhenAllCellsGoToOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = with_fields(test::random_mesh(comm, 5, 2), comm);
  const Rank last = comm.size() - 1;

  const auto mesh = assemble(comm, block, std::vector<Rank>(block.cell_to_node.size(), last));

  EXPECT_EQ(mesh.n_cells(), comm.rank() == last ? 48 : 0);
  EXPECT_TRUE(mesh.border_rank.empty());
  expect_same(test::gather(comm, mesh), test::gather(comm, block));
}

TEST(Assemble, WorksWithRanksThatHoldNoCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, test::random_mesh(comm, 6, 2));
  for (Rank holder = 0; holder < comm.size(); ++holder) {
    std::vector<GlobalId> begin;  // ranks up to the holder begin at 0, those after it at the end
    for (Rank r = 0; r < comm.size(); ++r) begin.push_back(r <= holder ? 0 : 48);

    const auto given = assemble(comm, test::cut(comm, whole, begin));
    const auto built = assemble(comm, test::without_neighbors(test::cut(comm, whole, begin)));

    EXPECT_EQ(given.n_cells(), comm.rank() == holder ? 48 : 0);
    EXPECT_EQ(built.n_cells(), comm.rank() == holder ? 48 : 0);
    EXPECT_EQ(test::gather(comm, given).cell_to_cell, whole.cell_to_cell);
  }
}

TEST(Assemble, BuildsTheNeighborsOfTheSerialTwin) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {11U, 12U}) {
    const auto block = test::without_neighbors(test::random_mesh(comm, seed, 3));
    auto expected = test::gather(comm, block);
    expected.cell_to_cell = test::reference_neighbors(expected.cell_to_node);
    expected.info.patches = {mesh::untagged_patch({})};

    const auto stayed = assemble(comm, block);
    const auto sent = assemble(comm, block, test::random_destinations(comm, block, seed));

    expect_well_kept(comm, stayed);
    expect_well_kept(comm, sent);
    expect_same(test::gather(comm, stayed), expected);
    expect_same(test::gather(comm, sent), expected);
  }
}

TEST(Assemble, BuildsTheBorderThatGivenNeighborsDescribe) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::random_mesh(comm, 13, 3);
  const auto to = test::random_destinations(comm, block, 13);
  const auto given = assemble(comm, block, to);

  const auto built = assemble(comm, test::without_neighbors(block), to);

  EXPECT_EQ(built.border_rank, given.border_rank);
  EXPECT_EQ(built.border_offset, given.border_offset);
  EXPECT_EQ(built.border_face, given.border_face);
  EXPECT_EQ(built.ghost_global, given.ghost_global);
}

TEST(Assemble, ListsBorderFacesInTheSameOrderOnBothSides) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 14, 3);
  const auto mesh = assemble(comm, block, test::random_destinations(comm, block, 14));
  par::Pattern pattern{mesh.border_rank, mesh.border_offset, {}};
  std::vector<GlobalId> own;
  for (const auto face : mesh.border_face) {
    pattern.item.push_back(0);
    own.push_back(mesh.cell_global[static_cast<std::size_t>(face.cell)]);
  }

  const auto theirs = par::Exchange(comm, pattern).swap<GlobalId>(own);

  EXPECT_EQ(theirs, mesh.ghost_global);
}

TEST(Assemble, TakesAMeshWithoutCells) {
  const par::Comm comm(MPI_COMM_WORLD);

  const auto mesh = assemble(comm, mesh::BlockMesh{});

  EXPECT_EQ(mesh.n_cells(), 0);
  EXPECT_EQ(mesh.n_nodes(), 0);
}

TEST(Assemble, TakesNodeNumbersThatLieFarApart) {
  const par::Comm comm(MPI_COMM_WORLD);
  // Two cells among 5000 nodes: the table from global to local numbers must not grow with their distance.
  std::vector<geometry::Vec3> nodes(5000);
  nodes[7] = {0, 0, 0};
  nodes[1900] = {1, 0, 0};
  nodes[3700] = {0, 1, 0};
  nodes[4999] = {0, 0, 1};
  nodes[2] = {0, 0, -1};
  const auto block = test::small_mesh(comm, nodes, {{7, 1900, 3700, 4999}, {7, 3700, 1900, 2}});

  const auto whole = test::gather(comm, assemble(comm, block));

  EXPECT_EQ(whole.cell_to_cell, (std::vector<std::array<GlobalId, 4>>{{-1, -1, -1, 1}, {-1, -1, -1, 0}}));
  EXPECT_EQ(whole.node_position[1900], (geometry::Vec3{1, 0, 0}));
}

/// Families cut by the block borders in every way: two of four cells, one of two, and regular cells between.
mesh::BlockMesh families_mesh() {
  auto whole = test::closure_family(mesh::FamilyKind::face, 2);
  for (const auto kind : {mesh::FamilyKind::regular, mesh::FamilyKind::edge, mesh::FamilyKind::face}) {
    auto next = kind == mesh::FamilyKind::regular ? test::closure_family(mesh::FamilyKind::edge, 0)
                                                  : test::closure_family(kind, 1);
    if (kind == mesh::FamilyKind::regular) next.lineage = {mesh::Lineage{}, mesh::Lineage{}};
    for (auto cell : next.cell_to_node) {
      for (auto& node : cell) node += whole.info.n_global_nodes;
      whole.cell_to_node.push_back(cell);
    }
    whole.lineage.insert(whole.lineage.end(), next.lineage.begin(), next.lineage.end());
    for (const auto& p : next.node_position)
      whole.node_position.push_back(p + 2.0 * static_cast<double>(whole.info.n_global_cells) * geometry::Vec3{1, 0, 0});
    whole.info.n_global_nodes += next.info.n_global_nodes;
    whole.info.n_global_cells += next.info.n_global_cells;
  }
  return whole;
}

TEST(Assemble, KeepsFamiliesWholeWhereverTheBlocksAreCut) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = families_mesh();
  const auto n = whole.info.n_global_cells;
  for (GlobalId shift = 0; shift <= n; ++shift)
    for (const GlobalId width : {0, 1, 2, 5}) {
      std::vector<GlobalId> begin{0};
      for (Rank r = 1; r < comm.size(); ++r) begin.push_back(std::min(n, shift + (r - 1) * width));

      const auto mesh = assemble(comm, test::cut(comm, whole, begin));

      for (std::size_t c = 0; c < mesh.lineage.size(); ++c) {
        const auto child = static_cast<std::size_t>(mesh.lineage[c].child());
        ASSERT_LE(child, c);
        ASSERT_LE(c - child + static_cast<std::size_t>(mesh.lineage[c].family_size()), mesh.lineage.size());
      }
      const auto found = test::gather(comm, mesh);
      ASSERT_EQ(found.cell_to_node, whole.cell_to_node);
      ASSERT_EQ(found.lineage, whole.lineage);
    }
}

TEST(Assemble, SendsWholeFamiliesToTheDestinationOfTheirFirstMember) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = families_mesh();
  const auto block = test::cut(comm, whole);
  std::vector<Rank> to;  // neighboring cells are sent to different ranks
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c)
    to.push_back(static_cast<Rank>((block.first_cell + static_cast<GlobalId>(c)) % comm.size()));

  const auto mesh = assemble(comm, block, to);

  for (std::size_t c = 0; c < mesh.lineage.size(); ++c)
    EXPECT_EQ((mesh.cell_global[c] - mesh.lineage[c].child()) % comm.size(), comm.rank());
  EXPECT_EQ(test::gather(comm, mesh).cell_to_node, whole.cell_to_node);
}

/// Assembles `whole`, changed and then cut, and returns the message of the error, the same on every rank.
std::string refusal(const par::Comm& comm, mesh::BlockMesh whole, const std::function<void(mesh::BlockMesh&)>& change) {
  change(whole);
  try {
    assemble(comm, test::cut(comm, whole));
  } catch (const Error& error) {
    EXPECT_EQ(comm.broadcast(std::string(error.what())), error.what());
    return error.what();
  }
  ADD_FAILURE() << "expected an Error";
  return "";
}

class AssembleRefuses : public testing::Test {
 protected:
  AssembleRefuses() : comm_(MPI_COMM_WORLD), cube_(test::gather(comm_, test::kuhn_cube(comm_, 2))) {}
  std::string cube(const std::function<void(mesh::BlockMesh&)>& change) const { return refusal(comm_, cube_, change); }

  par::Comm comm_;
  mesh::BlockMesh cube_;
};

TEST_F(AssembleRefuses, NodeNumbersOutOfRange) {
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_node[30][2] = 27; }),
              HasSubstr("cell 30: expected node numbers from 0 to 26, found 27"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_node[47][0] = -1; }), HasSubstr("cell 47"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_node[0][0] = GlobalId{1} << 62U; }), HasSubstr("cell 0"));
}

TEST_F(AssembleRefuses, ANodeTwiceInACell) {
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_node[5][1] = m.cell_to_node[5][3]; }),
              HasSubstr("cell 5: expected four different nodes"));
}

TEST_F(AssembleRefuses, NeighborAndPatchNumbersOutOfRange) {
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_cell[3][0] = 48; }), HasSubstr("neighbors below 48, found 48"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_cell[3][0] = -7; }), HasSubstr("6 patches (-1 to -6), found -7"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { m.cell_to_cell[3][0] = 3; }), HasSubstr("found the cell itself"));
}

TEST_F(AssembleRefuses, NeighborsThatAreNotReciprocal) {
  for (const std::size_t c : {0U, 13U, 47U})
    for (std::size_t f = 0; f < 4; ++f) {
      if (cube_.cell_to_cell[c][f] < 0) continue;
      const auto message = cube([&](mesh::BlockMesh& m) { m.cell_to_cell[c][f] = -1; });
      EXPECT_THAT(message, HasSubstr("to name each other"));
      EXPECT_THAT(message, HasSubstr("cell " + std::to_string(c)));
    }
  EXPECT_THAT(cube([](mesh::BlockMesh& m) { std::swap(m.cell_to_cell[20][0], m.cell_to_cell[20][1]); }),
              HasSubstr("to name each other"));
}

TEST_F(AssembleRefuses, AFaceInThreeCellsWhereverTheyLie) {
  // Cells 0, k and the last one stand on the same triangle; the blocks are cut differently on each number of ranks.
  for (GlobalId k = 1; k < 7; ++k) {
    std::vector<geometry::Vec3> nodes{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<std::array<GlobalId, 4>> cells;
    for (GlobalId c = 0; c < 8; ++c) {
      const auto first = static_cast<GlobalId>(nodes.size());
      const auto at = static_cast<double>(c + 1);
      nodes.push_back({0, 0, at});
      if (c == 0 || c == k || c == 7) {
        cells.push_back({0, 1, 2, first});
      } else {
        nodes.insert(nodes.end(), {{at, 5, 0}, {at, 6, 0}, {at, 5, 1}});
        cells.push_back({first, first + 1, first + 2, first + 3});
      }
    }
    mesh::BlockMesh whole;
    whole.info.n_global_cells = 8;
    whole.info.n_global_nodes = static_cast<GlobalId>(nodes.size());
    whole.node_position = nodes;
    whole.cell_to_node = cells;
    const auto message = refusal(comm_, whole, [](mesh::BlockMesh&) {});
    EXPECT_THAT(message, HasSubstr("found cells 0 " + std::to_string(k) + " 7 at the face of nodes 0 1 2"));
  }
}

TEST_F(AssembleRefuses, FamiliesThatAreNotWhole) {
  const auto families = families_mesh();
  const auto change = [&](std::size_t cell, mesh::Lineage lineage) {
    return refusal(comm_, families, [&](mesh::BlockMesh& m) { m.lineage[cell] = lineage; });
  };
  EXPECT_THAT(change(2, mesh::Lineage{}), HasSubstr("lineage, cell"));
  EXPECT_THAT(change(0, mesh::Lineage{}), HasSubstr("lineage, cell"));
  EXPECT_THAT(change(3, mesh::Lineage(mesh::FamilyKind::face, 2, 2, 0)), HasSubstr("cell 3"));
  EXPECT_THAT(change(3, mesh::Lineage(mesh::FamilyKind::face, 1, 3, 0)), HasSubstr("cell 3"));
  EXPECT_THAT(change(3, mesh::Lineage(mesh::FamilyKind::face, 2, 3, 1)), HasSubstr("cell 3"));
  EXPECT_THAT(change(4, mesh::Lineage(mesh::FamilyKind::edge, 0, 1, 0)), HasSubstr("lineage, cell"));
  EXPECT_THAT(change(11, mesh::Lineage(mesh::FamilyKind::face, 1, 0, 0)), HasSubstr("lineage, cell"));
  EXPECT_THAT(change(11, families.lineage[11].broken()), HasSubstr("lineage, cell"));
  EXPECT_THAT(change(5, mesh::Lineage(std::uint64_t{1} << 63U)), HasSubstr("cell 5"));
  EXPECT_THAT(change(5, mesh::Lineage(mesh::n_family_codes)), HasSubstr("cell 5"));
}

TEST_F(AssembleRefuses, FamiliesThatDoNotFitTheirTemplate) {
  EXPECT_THAT(refusal(comm_, families_mesh(),
                      [](mesh::BlockMesh& m) { std::swap(m.cell_to_node[3][0], m.cell_to_node[3][1]); }),
              HasSubstr("cells 0 to 3 to share their nodes as one closure family"));
}

TEST_F(AssembleRefuses, BlocksWhoseSizesDoNotFit) {
  const auto block = test::kuhn_cube(comm_, 2);
  const auto expect_error = [&](const std::function<void(mesh::BlockMesh&)>& change, const std::string& text) {
    auto changed = block;
    change(changed);
    try {
      assemble(comm_, changed);
      ADD_FAILURE() << "expected an Error: " << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(text));
    }
  };
  const bool is_last = comm_.rank() == comm_.size() - 1;
  expect_error([&](mesh::BlockMesh& m) { m.info.n_global_cells = 49; }, "expected 49 cells, found 48");
  expect_error(
      [&](mesh::BlockMesh& m) {
        if (is_last) m.cell_to_cell.pop_back();
      },
      "cell_to_cell: expected");
  expect_error(
      [&](mesh::BlockMesh& m) {
        if (is_last) m.node_position.pop_back();
      },
      "node block: expected");
  expect_error(
      [&](mesh::BlockMesh& m) {
        if (is_last) ++m.first_cell;
      },
      "to begin at cell");
  expect_error(
      [&](mesh::BlockMesh& m) {
        m.cell_fields = {mesh::Field{"u", "", 1, mesh::StorageType::float64, {}}};
      },
      "field `u`: expected");
  expect_error([&](mesh::BlockMesh& m) { m.info.n_global_nodes += is_last ? 1 : 0; },
               comm_.size() > 1 ? "expected the same counts" : "node block: expected");
}

TEST_F(AssembleRefuses, FieldsNamedAsThoseOfTheMapOfLevel0InAnotherShape) {
  using mesh::StorageType;
  EXPECT_THAT(cube([](mesh::BlockMesh& m) {
                m.cell_fields = {
                    {mesh::level0_cell_field, "", 1, StorageType::float64, std::vector<double>(m.cell_to_node.size())}};
              }),
              HasSubstr("field 'level0_cell': expected another name"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) {
                m.node_fields = {{mesh::level0_key_field, "", 4, StorageType::int64,
                                  std::vector<std::int64_t>(4 * m.node_position.size())}};
              }),
              HasSubstr("or 8 integers, found 4 integers"));
  EXPECT_THAT(cube([](mesh::BlockMesh& m) {
                m.cell_fields = {{mesh::level0_cell_field, "", 1, StorageType::int64,
                                  std::vector<std::int64_t>(m.cell_to_node.size())}};
              }),
              HasSubstr("or a mesh with such a map, found none"));
}

TEST_F(AssembleRefuses, DestinationsThatAreNoRanks) {
  const auto block = test::kuhn_cube(comm_, 2);
  std::vector<Rank> to(block.cell_to_node.size(), 0);
  if (comm_.rank() == comm_.size() - 1) to.back() = comm_.size();

  EXPECT_THROW(assemble(comm_, block, to), Error);
}

}  // namespace assemble_test
}  // namespace pamr::assemble
