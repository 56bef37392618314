// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "support/meshes.hpp"

namespace pamr::validate {
namespace validate_test {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names(const std::vector<Violation>& violations) {
  std::vector<std::string> result;
  for (const auto& violation : violations) result.push_back(violation.invariant);
  return result;
}

const Violation* find(const std::vector<Violation>& violations, const std::string& name) {
  const auto found =
      std::find_if(violations.begin(), violations.end(), [&](const Violation& v) { return v.invariant == name; });
  return found == violations.end() ? nullptr : &*found;
}

class Validate : public testing::Test {
 protected:
  Validate() : comm_(MPI_COMM_WORLD), mesh_(assemble::assemble(comm_, test::random_mesh(comm_, 21, 3))) {}

  /// Local number of a global cell, -1 on the other ranks.
  LocalId local(GlobalId cell) const {
    const auto at = std::lower_bound(mesh_.cell_global.begin(), mesh_.cell_global.end(), cell);
    return at != mesh_.cell_global.end() && *at == cell ? static_cast<LocalId>(at - mesh_.cell_global.begin()) : -1;
  }
  /// Breaks the mesh on the rank that holds the cell.
  void at_cell(GlobalId cell, const std::function<void(std::size_t)>& change) {
    if (local(cell) >= 0) change(static_cast<std::size_t>(local(cell)));
  }
  void expect_broken(const std::string& name, std::int64_t count, GlobalId where) {
    const auto violations = validate(comm_, mesh_);
    const auto* found = find(violations, name);
    ASSERT_NE(found, nullptr) << name << " not among " << testing::PrintToString(names(violations));
    EXPECT_EQ(found->count, count) << name;
    EXPECT_EQ(found->where, where) << name;
  }
  bool is_parallel() const { return comm_.size() > 1; }

  par::Comm comm_;
  mesh::DistMesh mesh_;
};

TEST_F(Validate, FindsNothingInValidMeshes) {
  EXPECT_THAT(names(validate(comm_, mesh_)), IsEmpty());
  EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, test::kuhn_cube(comm_, 1)))), IsEmpty());
  EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, mesh::BlockMesh{}))), IsEmpty());
  for (const std::uint64_t seed : {31U, 32U}) {
    const auto block = test::random_mesh(comm_, seed, 3);
    const auto to = test::random_destinations(comm_, block, seed);
    EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, block, to))), IsEmpty());
    EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, test::without_neighbors(block), to))), IsEmpty());
  }
}

TEST_F(Validate, FindsNothingInClosureFamilies) {
  for (int edge = 0; edge < 6; ++edge) {
    const auto whole = test::closure_family(mesh::FamilyKind::edge, edge);
    EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, test::cut(comm_, whole)))), IsEmpty())
        << "edge " << edge;
  }
  for (int face = 0; face < 4; ++face) {
    const auto whole = test::closure_family(mesh::FamilyKind::face, face);
    EXPECT_THAT(names(validate(comm_, assemble::assemble(comm_, test::cut(comm_, whole)))), IsEmpty())
        << "face " << face;
  }
}

TEST_F(Validate, FindsNumbersOutOfRange) {
  const auto valid = mesh_;
  at_cell(40, [&](std::size_t c) { mesh_.cell_to_node[c][2] = mesh_.n_nodes(); });
  expect_broken("ids_in_range", 1, 40);

  mesh_ = valid;
  at_cell(41, [&](std::size_t c) {
    mesh_.cell_to_cell[c][0] = mesh_.n_cells() + static_cast<LocalId>(mesh_.border_face.size());
  });
  expect_broken("ids_in_range", 1, 41);

  mesh_ = valid;
  at_cell(42, [&](std::size_t) { mesh_.node_global[0] = -5; });
  expect_broken("ids_in_range", 1, invalid_global);

  mesh_ = valid;
  at_cell(43, [&](std::size_t) { mesh_.lineage.pop_back(); });
  expect_broken("ids_in_range", 1, invalid_global);

  mesh_ = valid;
  mesh_.border_offset.push_back(0);
  expect_broken("ids_in_range", comm_.size(), invalid_global);

  at_cell(44, [&](std::size_t c) { mesh_.cell_to_node[c][2] = mesh_.n_nodes(); });
  mesh_.border_offset.pop_back();
  at_cell(45, [&](std::size_t) { mesh_.node_global[0] = -5; });
  expect_broken("ids_in_range", 2, 44);
}

TEST_F(Validate, SaysTheKindOfAPlaceAndNothingWhereThereIsNone) {
  EXPECT_EQ(text_of_place({"not_flat", 2, 7}), ", first at cell 7");
  EXPECT_EQ(text_of_place({"unique_nodes", 1, 0}), ", first at node 0");
  EXPECT_EQ(text_of_place({"fields_sized", 1, invalid_global}), "");
}

TEST_F(Validate, FindsCellsThatDoNotAscend) {
  const auto last = mesh_.cell_global.size() - 1;
  if (comm_.is_first()) std::swap(mesh_.cell_global[last], mesh_.cell_global[last - 1]);

  const auto violations = validate(comm_, mesh_);

  EXPECT_THAT(names(violations), Contains("cells_ascend"));
}

TEST_F(Validate, FindsCellNumbersMissingAndTwice) {
  const auto valid = mesh_;
  mesh_.info.n_global_cells += 3;
  expect_broken("unique_cells", 3, 162);

  mesh_ = valid;
  at_cell(60, [&](std::size_t c) { mesh_.cell_global[c] = 61; });
  expect_broken("unique_cells", 2, 60);
}

TEST_F(Validate, FindsARepeatedCorner) {
  at_cell(12, [&](std::size_t c) { mesh_.cell_to_node[c][3] = mesh_.cell_to_node[c][1]; });

  expect_broken("distinct_corners", 1, 12);
}

TEST_F(Validate, FindsFieldsOfTheWrongLength) {
  mesh_.cell_fields.push_back(
      {"u", "K", 2, mesh::StorageType::float64, std::vector<double>(mesh_.lineage.size(), 0.0)});
  mesh_.node_fields.push_back({"v", "K", 0, mesh::StorageType::float64, std::vector<double>{}});

  expect_broken("fields_sized", 2 * comm_.size(), invalid_global);
}

TEST_F(Validate, FindsCoordinatesThatAreNotFinite) {
  for (const auto bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    std::int64_t holders = 0;
    for (std::size_t n = 0; n < mesh_.node_global.size(); ++n)
      if (mesh_.node_global[n] == 17) {
        mesh_.node_position[n].y = bad;
        ++holders;
      }

    expect_broken("finite_coordinates", comm_.sum(holders), 17);
  }
}

TEST_F(Validate, FindsInvertedCells) {
  at_cell(99, [&](std::size_t c) { std::swap(mesh_.cell_to_node[c][0], mesh_.cell_to_node[c][1]); });

  expect_broken("orientation_positive", 1, 99);
}

TEST_F(Validate, FindsFlatCells) {
  const std::vector<geometry::Vec3> base{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto violations_at = [&](double height) {
    auto nodes = base;
    nodes.push_back({0.25, 0.25, height});
    return names(validate(comm_, assemble::assemble(comm_, test::small_mesh(comm_, nodes, {{0, 1, 2, 3}}))));
  };

  EXPECT_THAT(violations_at(1e-3), IsEmpty());
  EXPECT_THAT(violations_at(1e-20), testing::ElementsAre("not_flat"));
  EXPECT_THAT(violations_at(0), testing::ElementsAre("orientation_positive", "not_flat"));
  EXPECT_THAT(violations_at(-1), testing::ElementsAre("orientation_positive"));
}

TEST_F(Validate, FindsPatchesThatDoNotExist) {
  mesh_.info.patches.pop_back();  // zmax: 18 faces

  const auto violations = validate(comm_, mesh_);

  ASSERT_EQ(names(violations), std::vector<std::string>{"patches_in_range"});
  EXPECT_EQ(violations[0].count, 18);
}

TEST_F(Validate, FindsNeighborsThatAreNotReciprocal) {
  // The first own neighbor of the first cell that has one becomes the cell after it.
  for (LocalId c = 0; comm_.is_first() && c < mesh_.n_cells(); ++c) {
    auto& slots = mesh_.cell_to_cell[static_cast<std::size_t>(c)];
    const auto own = std::find_if(slots.begin(), slots.end(), [&](LocalId slot) { return mesh_.is_own(slot); });
    if (own == slots.end()) continue;
    *own = (*own + 1) % mesh_.n_cells() == c ? (*own + 2) % mesh_.n_cells() : (*own + 1) % mesh_.n_cells();
    break;
  }

  const auto violations = validate(comm_, mesh_);

  EXPECT_THAT(names(violations), Contains("neighbors_reciprocal"));
  EXPECT_THAT(names(violations), Contains("conforming"));
}

TEST_F(Validate, FindsGhostsThatAreNotReciprocal) {
  if (comm_.is_first() && is_parallel()) mesh_.ghost_global[0] = (mesh_.ghost_global[0] + 1) % 162;

  const auto violations = validate(comm_, mesh_);

  const auto expected = is_parallel() ? std::vector<std::string>{"neighbors_reciprocal"} : std::vector<std::string>{};
  EXPECT_EQ(names(violations), expected);
}

TEST_F(Validate, FindsTwoCellsOnTheSameNodes) {
  const auto block =
      test::small_mesh(comm_, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}, {1, 2, 0, 3}});

  const auto violations = validate(comm_, assemble::assemble(comm_, block));

  ASSERT_THAT(names(violations), Contains("neighbors_reciprocal"));
  EXPECT_EQ(find(violations, "neighbors_reciprocal")->count, 8);
}

TEST_F(Validate, FindsACrackWhereTwoCellsMeet) {
  // Both cells at one inner face call it boundary: each on its own is a valid cell.
  auto whole = test::gather(comm_, test::random_mesh(comm_, 22, 2));
  const auto c = GlobalId{24};  // in the middle of the blocks, so that the face lies on a rank border for some counts
  auto& slots = whole.cell_to_cell[24];
  const auto slot = std::find_if(slots.begin(), slots.end(), [](GlobalId neighbor) { return neighbor >= 0; });
  auto& back = whole.cell_to_cell[static_cast<std::size_t>(*slot)];
  *std::find(back.begin(), back.end(), c) = -1;
  *slot = -1;

  const auto violations = validate(comm_, assemble::assemble(comm_, test::cut(comm_, whole)));

  EXPECT_THAT(names(violations), Contains("conforming"));
}

TEST_F(Validate, FindsACellLaidOverOthers) {
  for (const std::size_t c : {0U, 20U, 47U}) {
    auto whole = test::gather(comm_, test::random_mesh(comm_, 23, 2));
    whole.cell_to_node.push_back(whole.cell_to_node[c]);
    whole.cell_to_cell.push_back({-1, -1, -1, -1});
    whole.info.n_global_cells = 49;

    const auto violations = validate(comm_, assemble::assemble(comm_, test::cut(comm_, whole)));

    EXPECT_THAT(names(violations), Contains("conforming")) << "cell " << c;
  }
}

TEST_F(Validate, FindsTwoSoundMeshesOnTheSameNodes) {
  auto whole = test::gather(comm_, test::random_mesh(comm_, 24, 2));
  const auto n = whole.cell_to_node.size();
  for (std::size_t c = 0; c < n; ++c) {
    auto neighbors = whole.cell_to_cell[c];
    for (auto& neighbor : neighbors) neighbor += neighbor < 0 ? 0 : static_cast<GlobalId>(n);
    whole.cell_to_node.push_back(whole.cell_to_node[c]);
    whole.cell_to_cell.push_back(neighbors);
  }
  whole.info.n_global_cells *= 2;

  const auto violations = validate(comm_, assemble::assemble(comm_, test::cut(comm_, whole)));

  EXPECT_THAT(names(violations), Contains("conforming"));
}

TEST_F(Validate, FindsALinkThatOnlyTheUpperCellKnows) {
  const par::Comm self(MPI_COMM_SELF);
  mesh_ = assemble::assemble(self, test::random_mesh(self, 21, 3));
  for (std::size_t c = 0; c < mesh_.cell_to_cell.size(); ++c)
    for (auto& neighbor : mesh_.cell_to_cell[c]) {
      if (neighbor <= static_cast<LocalId>(c)) continue;
      const auto kept = std::exchange(neighbor, mesh::patch_to_slot(0));
      EXPECT_THAT(names(validate(self, mesh_)), Contains("neighbors_reciprocal")) << "cell " << c;
      neighbor = kept;
    }
}

TEST_F(Validate, FindsBorderFacesInDifferentOrder) {
  if (comm_.is_first() && is_parallel()) {  // a mesh that only the other side can tell from the valid one
    ASSERT_GE(mesh_.border_offset[1], 2U);
    std::swap(mesh_.border_face[0], mesh_.border_face[1]);
    std::swap(mesh_.ghost_global[0], mesh_.ghost_global[1]);
    for (std::size_t k = 0; k < 2; ++k)
      mesh_.cell_to_cell[static_cast<std::size_t>(mesh_.border_face[k].cell)]
                        [static_cast<std::size_t>(mesh_.border_face[k].slot)] =
          mesh_.n_cells() + static_cast<LocalId>(k);
  }

  const auto violations = validate(comm_, mesh_);

  const auto expected = is_parallel() ? std::vector<std::string>{"border_matches"} : std::vector<std::string>{};
  EXPECT_EQ(names(violations), expected);
  if (is_parallel()) {
    EXPECT_EQ(violations[0].count, 4);  // two faces on two sides
  }
}

TEST_F(Validate, FindsAGhostSlotThatTheBorderDoesNotList) {
  if (comm_.is_first() && is_parallel()) mesh_.border_face[0].slot = (mesh_.border_face[0].slot + 1) % 4;

  const auto violations = validate(comm_, mesh_);

  EXPECT_EQ(find(violations, "border_matches") != nullptr, is_parallel());
}

TEST_F(Validate, FindsFamiliesThatAreNotWhole) {
  const auto expect_families_broken = [&](mesh::BlockMesh whole, const std::function<void(mesh::DistMesh&)>& change) {
    auto mesh = assemble::assemble(comm_, test::cut(comm_, whole));
    if (mesh.n_cells() > 0) change(mesh);  // the family lies on one rank
    EXPECT_THAT(names(validate(comm_, mesh)), Contains("families_whole"));
  };
  const auto four = test::closure_family(mesh::FamilyKind::face, 1);
  const auto two = test::closure_family(mesh::FamilyKind::edge, 4);
  expect_families_broken(four, [](mesh::DistMesh& m) { m.lineage[2] = mesh::Lineage{}; });
  expect_families_broken(four, [](mesh::DistMesh& m) { m.lineage[0] = m.lineage[1]; });
  expect_families_broken(four, [](mesh::DistMesh& m) { m.lineage[3] = m.lineage[3].broken(); });
  expect_families_broken(four, [](mesh::DistMesh& m) {
    m.lineage[3] = mesh::Lineage(mesh::FamilyKind::face, m.lineage[3].index(), 3, 1);
  });
  expect_families_broken(four, [](mesh::DistMesh& m) { m.lineage[0] = mesh::Lineage(std::uint64_t{1} << 63U); });
  expect_families_broken(two, [](mesh::DistMesh& m) { std::swap(m.lineage[0], m.lineage[1]); });
  expect_families_broken(two, [](mesh::DistMesh& m) { std::swap(m.cell_to_node[0], m.cell_to_node[1]); });
  expect_families_broken(two, [](mesh::DistMesh& m) {
    for (auto& lineage : m.lineage) lineage = mesh::Lineage(mesh::FamilyKind::edge, 3, lineage.child(), 0);
  });
}

TEST_F(Validate, FindsANodeHeldTwice) {
  at_cell(70, [&](std::size_t c) {
    const auto node = static_cast<std::size_t>(mesh_.cell_to_node[c][0]);
    mesh_.node_position.push_back(mesh_.node_position[node]);
    mesh_.node_global.push_back(mesh_.node_global[node]);
    mesh_.cell_to_node[c][0] = mesh_.n_nodes() - 1;
  });

  const auto violations = validate(comm_, mesh_);

  ASSERT_THAT(names(violations), Contains("unique_nodes"));
  EXPECT_EQ(find(violations, "unique_nodes")->count, 1);
}

TEST_F(Validate, FindsSharedNodesThatDifferInOneBit) {
  GlobalId node = std::numeric_limits<GlobalId>::max();
  if (comm_.is_first() && is_parallel()) {
    const auto face = mesh_.border_face[0];
    const auto corner = static_cast<std::size_t>(face.slot == 0 ? 1 : 0);
    const auto local = static_cast<std::size_t>(mesh_.cell_to_node[static_cast<std::size_t>(face.cell)][corner]);
    mesh_.node_position[local].x = std::nextafter(mesh_.node_position[local].x, 2.0);
    node = mesh_.node_global[local];
  }
  node = comm_.min(node);

  const auto violations = validate(comm_, mesh_);

  const auto expected = is_parallel() ? std::vector<std::string>{"shared_nodes_equal"} : std::vector<std::string>{};
  ASSERT_EQ(names(violations), expected);
  if (is_parallel()) {
    EXPECT_EQ(violations[0].where, node);
  }
}

TEST_F(Validate, FindsNodesWithoutCells) {
  const auto valid = mesh_;
  mesh_.info.n_global_nodes += 2;
  expect_broken("nodes_referenced", 2, 64);

  mesh_ = valid;
  at_cell(3, [&](std::size_t) {
    mesh_.node_position.push_back({9, 9, 9});
    mesh_.node_global.push_back(5);
  });
  expect_broken("nodes_referenced", 1, 5);
}

TEST_F(Validate, FindsAnEdgeWhereTheBoundaryTouchesItself) {
  const auto block = test::small_mesh(comm_, {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                                      {{0, 2, 3, 1}, {0, 4, 5, 1}});

  const auto violations = validate(comm_, assemble::assemble(comm_, block));

  ASSERT_EQ(names(violations), std::vector<std::string>{"boundary_manifold"});
  EXPECT_EQ(violations[0].count, 1);
  EXPECT_EQ(violations[0].where, 0);
}

TEST_F(Validate, SaysTheSameOnAnyNumberOfRanks) {
  const par::Comm alone(MPI_COMM_SELF);
  const auto report = [](const par::Comm& comm) {
    auto whole = test::gather(comm, test::random_mesh(comm, 24, 2));
    whole.node_position[11] = {5, 5, 5};
    return validate(comm, assemble::assemble(comm, test::cut(comm, whole)));
  };

  const auto found = report(comm_);

  const auto expected = report(alone);
  ASSERT_EQ(names(found), names(expected));
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].count, expected[i].count) << found[i].invariant;
    EXPECT_EQ(found[i].where, expected[i].where) << found[i].invariant;
  }
}

TEST_F(Validate, RequireValidNamesTheFirstViolationOnEveryRank) {
  EXPECT_NO_THROW(require_valid(comm_, mesh_, "input"));
  at_cell(99, [&](std::size_t c) { std::swap(mesh_.cell_to_node[c][0], mesh_.cell_to_node[c][1]); });

  try {
    require_valid(comm_, mesh_, "cube.hdf");
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cube.hdf: expected a valid mesh, found `orientation_positive` broken 1 time, "
                                        "first at cell 99"));
  }
}

}  // namespace validate_test
}  // namespace pamr::validate
