// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/dual_graph.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "refined_mesh.hpp"

namespace pamr {
namespace dual_graph_test {

using Arcs = std::map<std::pair<GlobalId, GlobalId>, std::int64_t>;

/// Every arc of the graph on every rank: from, to, faces.
Arcs gather_arcs(const par::Comm& comm, const balance::DualGraph& graph) {
  struct Arc {
    GlobalId from, to;
    std::int64_t n_faces;
  };
  std::vector<Arc> mine;
  for (std::size_t v = 0; v < graph.n_vertices(); ++v)
    for (auto a = graph.arc_begin[v]; a < graph.arc_begin[v + 1]; ++a)
      mine.push_back({graph.first_vertex + static_cast<GlobalId>(v), graph.neighbor[static_cast<std::size_t>(a)],
                      graph.n_faces[static_cast<std::size_t>(a)]});
  std::vector<par::Outgoing<Arc>> messages;
  for (Rank r = 0; r < comm.size(); ++r) messages.push_back({r, mine});
  Arcs arcs;
  for (const auto& arc : comm.sparse_exchange(messages).item)
    EXPECT_TRUE(arcs.emplace(std::pair{arc.from, arc.to}, arc.n_faces).second) << "parallel arc";
  return arcs;
}

std::vector<std::int64_t> ones(const mesh::DistMesh& mesh) {
  return std::vector<std::int64_t>(mesh.cell_global.size(), 1);
}

void expect_sound(const par::Comm& comm, const mesh::DistMesh& mesh, const balance::Groups& groups) {
  const auto graph = balance::build_dual_graph(comm, mesh, groups, ones(mesh));
  const auto arcs = gather_arcs(comm, graph);

  std::set<GlobalId> vertices;
  for (const auto& [ends, n_faces] : arcs) {
    EXPECT_NE(ends.first, ends.second);
    EXPECT_GE(n_faces, 1);
    const auto back = arcs.find({ends.second, ends.first});
    ASSERT_NE(back, arcs.end());
    EXPECT_EQ(back->second, n_faces);
    vertices.insert(ends.first);
  }
  EXPECT_EQ(static_cast<GlobalId>(vertices.size()), graph.n_global_vertices);
  EXPECT_EQ(*vertices.rbegin(), graph.n_global_vertices - 1);
  std::int64_t weight = 0;
  for (const auto w : graph.weight) weight += w;
  EXPECT_EQ(comm.sum(weight), mesh.info.n_global_cells);

  // faces between cells of different groups, counted from both sides
  std::vector<std::size_t> group_of(mesh.cell_global.size());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const auto cell : groups.cells(g)) group_of[static_cast<std::size_t>(cell)] = g;
  std::int64_t expected = 0, found = 0;
  for (std::size_t c = 0; c < group_of.size(); ++c)
    for (const auto neighbor : mesh.cell_to_cell[c])
      expected +=
          mesh.is_ghost(neighbor) || (neighbor >= 0 && group_of[static_cast<std::size_t>(neighbor)] != group_of[c]) ? 1
                                                                                                                    : 0;
  for (const auto& arc : arcs) found += arc.second;
  EXPECT_EQ(found, comm.sum(expected));
}

void expect_whole_families(const mesh::DistMesh& mesh, const balance::Groups& groups) {
  std::vector<int> group_of(mesh.cell_global.size(), -1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    EXPECT_FALSE(groups.cells(g).empty());
    for (const auto cell : groups.cells(g)) {
      EXPECT_EQ(group_of[static_cast<std::size_t>(cell)], -1) << "a cell in two groups";
      group_of[static_cast<std::size_t>(cell)] = static_cast<int>(g);
    }
  }
  for (std::size_t c = 0; c < group_of.size(); ++c) {
    EXPECT_GE(group_of[c], 0) << "a cell in no group";
    const auto child = mesh.lineage[c].is_removable() ? mesh.lineage[c].child() : 0;
    EXPECT_EQ(group_of[c], group_of[c - static_cast<std::size_t>(child)]) << "a family is torn";
  }
}

TEST(DualGraph, HasOneVertexForEachFamilyAndNoParallelArcs) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 1);
  const auto groups = balance::group_families(mesh);

  std::int64_t expected = 0;
  for (const auto lineage : mesh.lineage) expected += lineage.is_removable() && lineage.child() > 0 ? 0 : 1;
  EXPECT_EQ(static_cast<std::int64_t>(groups.size()), expected);
  EXPECT_LT(groups.size(), mesh.cell_global.size());
  expect_whole_families(mesh, groups);
  expect_sound(comm, mesh, groups);
}

TEST(DualGraph, GroupsCellsOfAboutTheSameWeight) {
  const par::Comm comm(MPI_COMM_WORLD);
  // Few cells are sorted, many counted.
  for (const auto& mesh :
       {test::refined_mesh(comm, 2), assemble::assemble(comm, assemble::kuhn_cube(comm, comm.size() == 1 ? 24 : 4))}) {
    const auto groups = balance::group_by_weight(mesh, ones(mesh), 10);
    expect_whole_families(mesh, groups);
    for (std::size_t g = 0; g < groups.size(); ++g)
      EXPECT_LT(groups.cells(g).size(), std::size_t{10 + mesh::max_family_size});
    EXPECT_LT(groups.size(), mesh.cell_global.size() / 5 + 1);
    expect_sound(comm, mesh, groups);
  }
}

TEST(DualGraph, GroupsAreCompactOnAnyNumberOfCells) {
  const par::Comm comm(MPI_COMM_SELF);
  for (const int n : {18, 24}) {  // one cube of each is cut into groups of some 60 cells: 35,000 and 83,000 cells
    const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, n));
    const auto groups = balance::group_by_weight(mesh, ones(mesh), 60);
    double size = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      geometry::Box box;
      for (const auto cell : groups.cells(g)) box.extend(geometry::centroid(mesh.points(cell)));
      size += box.diagonal() * n / static_cast<double>(groups.size());
    }
    EXPECT_LT(size, 5) << n;  // sides of a cube of six cells; in the order of the file it is 10
  }
}

}  // namespace dual_graph_test
}  // namespace pamr
