// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh whose numbers begin beyond 2^50 goes through every stage and the file like the one that begins at 0.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "pamr/adapt/adapt.hpp"
#include "pamr/check/extract.hpp"
#include "pamr/check/quality_report.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace wide_ids_test {

using refine::QualityControl;

constexpr GlobalId wide = GlobalId{1} << 51U;

/// A random cube with one node and one cell field, whose lower face is tied to a sphere that bulges into it.
mesh::BlockMesh dome(const par::Comm& comm, std::uint64_t seed) {
  constexpr double bulge = 0.4, radius = (0.5 + bulge * bulge) / (2 * bulge);
  auto block = test::random_mesh(comm, seed, 2);
  block.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, " +
                        std::to_string(bulge - radius) + "]\nradius = " + std::to_string(radius) + "\n");
  for (auto& patch : block.info.patches)
    if (patch.name == "zmin") patch.surface = 0;
  std::vector<double> height, volume;
  for (const auto p : block.node_position) height.push_back(p.z);
  for (const auto& nodes : block.cell_to_node) volume.push_back(static_cast<double>(nodes[0] % 7));
  block.node_fields.push_back({"height", "m", 1, mesh::StorageType::float64, std::move(height)});
  block.cell_fields.push_back({"value", "", 1, mesh::StorageType::float64, std::move(volume)});
  return block;
}

/// Cells low in the mesh and some others here and there, whatever their numbers.
std::vector<std::uint8_t> mark(const mesh::DistMesh& mesh) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    const auto row = mesh.cell_global[static_cast<std::size_t>(c)] - mesh.info.first_id;
    flags.push_back(middle.z < 0.1 || row % 23 == 0 ? 1 : 0);
  }
  return flags;
}

/// The same mesh after a trip through a file, cells spread at random.
mesh::DistMesh through_file(const par::Comm& comm, const mesh::DistMesh& mesh, std::uint64_t seed) {
  std::string name;
  if (comm.is_first()) name = std::filesystem::temp_directory_path() / ("pamr_wide_" + std::to_string(::getpid()));
  const std::filesystem::path file = comm.broadcast(name) + ".hdf";
  io::write_native(comm, file, mesh);
  auto block = io::read_native(comm, file);
  comm.barrier();
  if (comm.is_first()) std::filesystem::remove(file);
  const auto destination = test::random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destination);
}

std::vector<mesh::Field> by_name(std::vector<mesh::Field> fields) {
  std::sort(fields.begin(), fields.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return fields;
}

void expect_equal_but_for_numbers(const par::Comm& comm, const mesh::DistMesh& moved, const mesh::DistMesh& plain) {
  auto a = test::numbered_from(0, test::gather(comm, moved));
  const auto b = test::gather(comm, plain);
  for (auto& field : a.cell_fields)
    if (field.name == "parent")
      for (auto& id : field.integer()) id -= moved.info.first_id;
  for (auto& field : a.node_fields)
    if (field.name == mesh::level0_key_field)
      for (std::size_t i = 0; i < field.integer().size(); ++i)
        if (i % 8 < 4 && field.integer()[i] >= 0) field.integer()[i] -= moved.info.first_id;
  EXPECT_EQ(a.info.n_global_cells, b.info.n_global_cells);
  EXPECT_EQ(a.info.n_global_nodes, b.info.n_global_nodes);
  EXPECT_TRUE(a.node_position == b.node_position);
  EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
  EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
  EXPECT_TRUE(a.lineage == b.lineage);
  for (const auto& [mine, theirs] : {std::pair(&a.cell_fields, &b.cell_fields), {&a.node_fields, &b.node_fields}}) {
    const auto x = by_name(*mine), y = by_name(*theirs);  // a file does not keep their order
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(x[i].name, y[i].name);
      EXPECT_TRUE(x[i].value == y[i].value) << x[i].name;
    }
  }
}

class WideIds : public ::testing::TestWithParam<QualityControl> {};
INSTANTIATE_TEST_SUITE_P(EveryPolicy, WideIds,
                         ::testing::Values(QualityControl::none, QualityControl::isotropic, QualityControl::short_edge,
                                           QualityControl::removable));

TEST_P(WideIds, PassThroughThreeLevelsAndTheFileUnharmed) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = dome(comm, 4);
  const auto destination = test::random_destinations(comm, block, 5);
  auto plain = assemble::assemble(comm, block, destination);
  auto moved = assemble::assemble(comm, test::numbered_from(wide, block), destination);
  std::int64_t n_off_surface = 0, n_moved = 0;
  for (int level = 0; level < 3; ++level) {
    const refine::Options options{.quality_control = GetParam(), .marks_field = ""};
    auto of_plain = adapt::refine(comm, plain, mark(plain), options);
    auto spread = adapt::balancing_named(level == 1 ? "blocks" : "scotch", "exact");
    spread.how.keep_below = 0;
    spread.how.vertices_per_part = 40;
    const auto flags = mark(moved);
    auto of_moved = adapt::refine(comm, std::move(moved), flags, options, spread);
    n_moved += of_moved.report.balance.moved_cells;
    plain = std::move(of_plain.mesh);
    moved = std::move(of_moved.mesh);
    EXPECT_EQ(of_moved.report.closure.families_rebuilt, of_plain.report.closure.families_rebuilt);
    EXPECT_EQ(of_moved.report.marked_not_split, 0);
    n_off_surface += of_moved.report.certificate.n_off_surface;
    EXPECT_EQ(moved.info.first_id, wide);
    EXPECT_EQ(comm.min(moved.cell_global.empty() ? 2 * wide : moved.cell_global.front()), wide);
    EXPECT_EQ(comm.max(moved.cell_global.empty() ? 0 : moved.cell_global.back()), wide + moved.info.n_global_cells - 1);
    for (const auto& violation : validate::validate(comm, moved))
      ADD_FAILURE() << violation.invariant << " " << violation.count << " at " << violation.where;
    expect_equal_but_for_numbers(comm, moved, plain);
    EXPECT_EQ(mesh::fingerprint(comm, moved), mesh::fingerprint(comm, plain));

    moved = through_file(comm, moved, static_cast<std::uint64_t>(level));
    expect_equal_but_for_numbers(comm, moved, plain);
  }
  EXPECT_GT(n_off_surface, 0);  // the ledger, too, has been carried
  EXPECT_EQ(n_moved > 0, comm.size() > 1);
}

TEST(WideIds, AreBuiltFromNodesAlone) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::without_neighbors(test::random_mesh(comm, 8, 3));
  const auto destination = test::random_destinations(comm, block, 9);

  const auto moved = assemble::assemble(comm, test::numbered_from(wide, block), destination);

  expect_equal_but_for_numbers(comm, moved, assemble::assemble(comm, block, destination));
}

TEST(WideIds, AreReportedAndExtractedLikeAnyOthers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = dome(comm, 6);
  const auto destination = test::random_destinations(comm, block, 7);
  const auto plain = assemble::assemble(comm, block, destination);
  const auto moved = assemble::assemble(comm, test::numbered_from(wide, block), destination);

  const auto worst = check::worst_cells(comm, moved, 12);
  const auto cut_out = check::extract_cells(comm, moved, worst);

  EXPECT_EQ(worst, check::worst_cells(comm, plain, 12));
  EXPECT_EQ(cut_out.info.first_id, 0);
  EXPECT_EQ(cut_out.info.n_global_cells, 12);
  for (const auto id : cut_out.find_cell_field("cell")->integer())
    EXPECT_TRUE(moved.info.cell_ids().contains(id)) << id;
  const auto report = check::report_quality(comm, moved);
  const auto same = check::report_quality(comm, plain);
  EXPECT_EQ(report.fingerprint, same.fingerprint);
  EXPECT_EQ(report.volume, same.volume);
  EXPECT_TRUE(report.conforming && report.neighbors_consistent);
}

}  // namespace wide_ids_test
}  // namespace pamr
