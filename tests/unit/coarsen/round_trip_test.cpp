// SPDX-License-Identifier: GPL-3.0-or-later
// Refining and then taking everything back gives the mesh that there was, byte for byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "coarsen_case.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/validate/validate.hpp"
#include "support/delaunay.hpp"
#include "support/dice.hpp"

namespace pamr {
namespace round_trip_test {

const adapt::Options plain{{.parent_field = false}, {}};

mesh::BlockMesh any_mesh(const par::Comm& self, std::uint64_t seed) {
  if (seed % 5 == 1) return test::kuhn_cube(self, 2 + static_cast<int>(seed / 5 % 2));
  return test::random_delaunay(seed);
}

constexpr std::array<double, 4> floors{0.3, 0, 0.5, 0.68};

int max_level(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::int64_t deepest = 0;
  for (const auto lineage : mesh.lineage) deepest = std::max<std::int64_t>(deepest, lineage.level());
  return static_cast<int>(comm.max(deepest));
}

TEST(RoundTrip, OfRandomMeshesGivesTheInputInAsManyCallsAsThereAreLevels) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::int64_t n_octets = 0;
  for (const auto i : test::seeds_alone(world)) {
    SCOPED_TRACE("mesh " + std::to_string(i));
    const auto start = any_mesh(self, i);
    const auto input = test::scatter(self, start, 0);
    auto options = plain;
    options.refinement.shape_floor = floors[i % floors.size()];
    auto mesh = input;
    const int n_levels = 1 + static_cast<int>(i % 4);
    for (int level = 0; level < n_levels && mesh.n_cells() < 2500; ++level)
      mesh = adapt::refine(self, mesh, test::mark(mesh, test::law_of(i + at(level)), combine(i, at(level))),
                           options.refinement)
                 .mesh;

    // a red cell's children may have been split in the same call, and closure cells do not count as a level
    for (int level = max_level(self, mesh); level > 0; --level) {
      ASSERT_EQ(max_level(self, mesh), level);
      auto result = adapt::adapt(self, mesh, test::all_may_go(mesh), options);
      ASSERT_TRUE(validate::validate(self, result.mesh).empty());
      ASSERT_EQ(result.coarsening.octets_kept, 0);
      n_octets += result.coarsening.octets_gone;
      mesh = std::move(result.mesh);
    }
    // what is left are closures that nobody needs: of a mesh of level 0 there is none
    ASSERT_TRUE(test::bytes_of(test::gather_on(self, mesh, 0)) == test::bytes_of(test::gather_on(self, input, 0)));
  }
  EXPECT_GT(world.sum(n_octets), 100);
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string written(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name) {
  const auto path =
      std::filesystem::temp_directory_path() / (name + comm.broadcast(std::to_string(wall_seconds())) + ".hdf");
  io::write_native(comm, path, mesh);
  comm.barrier();
  auto content = content_of(path);
  comm.barrier();
  if (comm.is_first()) std::filesystem::remove(path);
  return content;
}

/// A value for each cell or node, constant where coarsening has to give back what refining has spread.
void add_fields(mesh::DistMesh& mesh) {
  std::vector<double> x, y;
  std::vector<std::int64_t> tag;
  for (const auto p : mesh.node_position) x.push_back(std::sin(7 * p.x) + p.y * p.z);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    y.push_back(1 / (3.0 + static_cast<double>(mesh.cell_global[at(c)])));
    y.push_back(1e300);
    tag.push_back(mesh.cell_global[at(c)] % 5);
  }
  mesh.node_fields.push_back({"potential", "V", 1, mesh::StorageType::float64, x});
  mesh.cell_fields.push_back({"density", "kg", 2, mesh::StorageType::float64, y});
  mesh.cell_fields.push_back({"tag", "", 1, mesh::StorageType::int32, tag});
}

TEST(RoundTrip, OfAMeshAtACurvedWallGivesTheFileOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const double bulge : {0.02, 0.1}) {
    SCOPED_TRACE("bulge " + std::to_string(bulge));
    auto block = test::bulging_cube(comm, 3, bulge);
    const auto destination = test::random_destinations(comm, block, 5);
    auto mesh = assemble::assemble(comm, std::move(block), destination);
    mesh.info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh));
    add_fields(mesh);
    const auto before = written(comm, mesh, "round_trip_before");
    std::int64_t n_moved = 0;
    for (int level = 0; level < 3; ++level) {
      const auto near = test::near_dome(mesh, 0.3 / (1 << level));
      auto fine = adapt::refine(comm, std::move(mesh), near, plain.refinement);
      mesh = std::move(fine.mesh);
      n_moved += fine.report.certificate.n_moved;
    }
    EXPECT_GT(n_moved, 20);

    for (int level = max_level(comm, mesh); level > 0; --level) {
      const auto flags = test::all_may_go(mesh);
      auto result = adapt::adapt(comm, std::move(mesh), flags, plain);
      mesh = std::move(result.mesh);
      ASSERT_TRUE(validate::validate(comm, mesh).empty());
    }
    EXPECT_TRUE(written(comm, mesh, "round_trip_after") == before);
  }
}

TEST(RoundTrip, IsPossibleAfterOrderingAlongTheCurve) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto block = test::random_mesh(comm, 21, 3);
  auto mesh = assemble::assemble(comm, block);
  const auto before = mesh::fingerprint(comm, mesh);
  for (int level = 0; level < 3; ++level)
    mesh = adapt::refine(comm, mesh, test::mark(mesh, test::Law::sphere, 4), plain.refinement).mesh;
  const auto n_levels = max_level(comm, mesh);

  auto ordered = order::order_along_curve(comm, test::cut(comm, test::gather(comm, mesh)));
  mesh = assemble::assemble(comm, std::move(ordered.block));
  for (int level = 0; level < n_levels; ++level) mesh = adapt::adapt(comm, mesh, test::all_may_go(mesh), plain).mesh;

  EXPECT_EQ(max_level(comm, mesh), 0);
  EXPECT_EQ(mesh::fingerprint(comm, mesh), before);
}

TEST(Coarsening, OfLevelZeroChangesNothing) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 11, 3);
  const auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 2));
  const auto before = test::bytes_of(test::gather(comm, mesh));

  const auto result = adapt::adapt(comm, mesh, test::all_may_go(mesh), plain);

  EXPECT_TRUE(test::bytes_of(test::gather(comm, result.mesh)) == before);
  EXPECT_EQ(result.coarsening.cells_flagged, mesh.info.n_global_cells);
  EXPECT_EQ(result.coarsening.cells_without_parent, mesh.info.n_global_cells);
  EXPECT_EQ(result.coarsening.octets_gone, 0);
  EXPECT_TRUE(result.merged.empty());
}

TEST(Coarsening, WithoutFlagsBelowZeroIsRefining) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 12, 3);
  auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 2));
  for (int level = 0; level < 2; ++level) {
    const auto split = test::mark(mesh, test::Law::sphere, at(level));
    const auto expected = adapt::refine(comm, mesh, split, plain.refinement);

    auto result = adapt::adapt(comm, mesh, test::with_sign(split), plain);

    ASSERT_TRUE(test::bytes_of(test::gather(comm, result.mesh)) == test::bytes_of(test::gather(comm, expected.mesh)));
    EXPECT_EQ(result.report.closure.n_marked, expected.report.closure.n_marked);
    mesh = std::move(result.mesh);
  }
}

}  // namespace round_trip_test
}  // namespace pamr
