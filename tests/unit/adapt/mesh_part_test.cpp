// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/mesh_part.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/part/put_back.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace mesh_part_test {

/// A mesh with closure families, in runs of cells over the ranks or balanced, so that there are none.
mesh::DistMesh mesh_with_families(const par::Comm& comm, bool in_runs) {
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 4));
  std::vector<std::uint8_t> flags(at(mesh.n_cells()), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) flags[at(c)] = mesh.cell_global[at(c)] % 17 == 0 ? 1 : 0;
  if (in_runs) return adapt::refine(comm, mesh, flags).mesh;
  return adapt::refine(comm, std::move(mesh), flags).mesh;
}

/// A closure that says nothing.
refine::Closure nothing_marked(const mesh::DistMesh& mesh) {
  refine::Closure closure;
  closure.marks.assign(at(mesh.n_cells()), 0);
  closure.cut_faces_conform = mesh.info.cut_faces_conform;
  return closure;
}

class MeshPart : public testing::TestWithParam<bool> {};

TEST_P(MeshPart, GrowsAndIsPutBackAsItWas) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = mesh_with_families(comm, GetParam());
  const auto borders = mesh::find_borders(comm, mesh);
  const auto closure = nothing_marked(mesh);
  const std::vector<std::uint8_t> requests(at(mesh.n_cells()), 0);
  const adapt::WholeMesh whole{mesh, borders, {requests, closure}};
  adapt::Coverage coverage{std::vector<adapt::Coverage::State>(at(mesh.n_cells()), adapt::Coverage::outside), {}};
  std::vector<LocalId> seeds;
  if (comm.is_first()) seeds.push_back(0);

  adapt::MeshPart part;
  std::int64_t before = 0;
  for (int step = 0; step < 3; ++step) {
    adapt::spread(comm, whole, seeds, 1, coverage);
    part = adapt::widen(comm, whole, part, coverage);
    EXPECT_GT(part.mesh.info.n_global_cells, before);
    EXPECT_EQ(comm.sum(part.mesh.n_cells()), part.mesh.info.n_global_cells);
    EXPECT_TRUE(std::is_sorted(part.whole_cell.begin(), part.whole_cell.end()));
    for (LocalId c = 0; c < part.mesh.n_cells(); ++c)
      EXPECT_EQ(part.mesh.points(c), mesh.points(part.whole_cell[at(c)]));
    before = part.mesh.info.n_global_cells;
    seeds.clear();
    for (const auto c : adapt::open_cells(part)) seeds.push_back(part.whole_cell[at(c)]);
  }
  EXPECT_LT(before, mesh.info.n_global_cells);

  const auto joined = adapt::put_back(comm, {adapt::copy_with_room(mesh, 0, 0), whole.cells}, part, coverage, true);
  const auto& again = joined.mesh;

  EXPECT_TRUE(validate::validate(comm, again).empty());
  EXPECT_EQ(mesh::fingerprint(comm, again), mesh::fingerprint(comm, mesh));
  EXPECT_EQ(again.cell_global, mesh.cell_global);
  EXPECT_EQ(again.cell_origin, mesh.cell_global);
  EXPECT_EQ(again.cell_to_node, mesh.cell_to_node);
  EXPECT_EQ(again.node_global, mesh.node_global);
  EXPECT_EQ(again.lineage, mesh.lineage);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) EXPECT_EQ(joined.whole_cell[at(c)], c);
}

INSTANTIATE_TEST_SUITE_P(InRunsAndNot, MeshPart, testing::Bool());

}  // namespace mesh_part_test
}  // namespace pamr
