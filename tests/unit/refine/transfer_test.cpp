// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/index.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace transfer_test {

double linear(geometry::Vec3 p) { return 1 + 2 * p.x - 3 * p.y + 0.5 * p.z; }

std::vector<std::uint8_t> near_corner(const mesh::DistMesh& mesh) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(geometry::norm(mesh.points(c)[0]) < 0.6 ? 1 : 0);
  return flags;
}

double integral(const mesh::DistMesh& mesh, const mesh::CellField& field) {
  double sum = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    sum += geometry::volume(mesh.points(c)) * field.real()[static_cast<std::size_t>(c)];
  return sum;
}

mesh::DistMesh mesh_with_fields(const par::Comm& comm) {
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 12, 3));
  std::vector<double> nodal, mass;
  std::vector<std::int64_t> region;
  for (const auto p : mesh.node_position) nodal.push_back(linear(p));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    mass.push_back(1 + std::sin(10 * mesh.points(c)[1].x));
    region.push_back(mesh.points(c)[0].y > 0.5 ? 4 : 2);
  }
  mesh.node_fields.push_back({"linear", "K", 1, mesh::StorageType::float64, nodal});
  mesh.cell_fields.push_back({"mass", "kg", 1, mesh::StorageType::float32, mass});
  mesh.cell_fields.push_back({"region", "", 1, mesh::StorageType::int32, region});
  mesh.cell_fields.push_back({"refine", "", 1, mesh::StorageType::int32, std::vector<std::int64_t>(region.size(), 1)});
  return mesh;
}

TEST(Transfer, KeepsLinearNodalFieldsAndTheIntegralsOfCellFields) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = mesh_with_fields(comm);
  for (int level = 0; level < 3; ++level) {
    auto fine = adapt::refine(comm, mesh, near_corner(mesh), {.marks_field = "refine"}).mesh;

    EXPECT_EQ(fine.find_cell_field("refine"), nullptr);
    const auto& nodal = fine.find_node_field("linear")->real();
    for (std::size_t i = 0; i < nodal.size(); ++i) EXPECT_NEAR(nodal[i], linear(fine.node_position[i]), 1e-14);
    EXPECT_NEAR(integral(fine, *fine.find_cell_field("mass")), integral(mesh, *mesh.find_cell_field("mass")), 1e-12);
    EXPECT_EQ(fine.find_cell_field("mass")->unit, "kg");
    EXPECT_EQ(fine.find_cell_field("mass")->storage, mesh::StorageType::float32);
    mesh = std::move(fine);
  }
}

TEST(Transfer, GivesANewNodeTheIntegerOfTheEndThatComesFirstByPosition) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 12, 3));
  const auto old = test::gather(comm, mesh).node_position;  // by number
  mesh.node_fields.push_back({"name", "", 1, mesh::StorageType::int64, mesh.node_global});

  const auto fine = adapt::refine(comm, mesh, near_corner(mesh)).mesh;

  const auto& name = fine.find_node_field("name")->integer();
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto here = fine.node_position[i], end = old[at(name[i])];
    if (here == end) continue;
    EXPECT_TRUE(geometry::lexicographically_less(end, here));
    const auto is_other_end = [&](geometry::Vec3 p) { return norm(end + p - 2.0 * here) < 1e-12; };
    EXPECT_TRUE(std::any_of(old.begin(), old.end(), is_other_end));
  }
}

TEST(Transfer, LargestValuesStayFinite) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr double huge = 1.7e308;
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 12, 3));
  for (auto& p : mesh.node_position) p = 100.0 * p;  // volumes above 1, so that values times volumes are too large
  mesh.node_fields.push_back(
      {"nodal", "", 1, mesh::StorageType::float64, std::vector<double>(at(mesh.n_nodes()), huge)});
  mesh.cell_fields.push_back(
      {"cell", "", 1, mesh::StorageType::float64, std::vector<double>(at(mesh.n_cells()), -huge)});
  std::int64_t rebuilt = 0;
  for (int level = 0; level < 3; ++level) {
    std::vector<std::uint8_t> flags;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(geometry::norm(mesh.points(c)[0]) < 60 ? 1 : 0);
    auto result = adapt::refine(comm, mesh, flags);
    mesh = std::move(result.mesh);
    rebuilt += result.report.closure.families_rebuilt;

    for (const double value : mesh.find_node_field("nodal")->real()) EXPECT_EQ(value, huge);
    for (const double value : mesh.find_cell_field("cell")->real()) EXPECT_NEAR(value / huge, -1, 1e-15);
  }
  EXPECT_GT(rebuilt, 0);
}

TEST(Transfer, NamesTheInputCellThatHoldsEachNewCellsCentroid) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = mesh_with_fields(comm);
  for (int level = 0; level < 3; ++level) {
    const auto fine = adapt::refine(comm, mesh, near_corner(mesh)).mesh;
    const auto& parent = fine.find_cell_field("parent")->integer();
    const auto& region = fine.find_cell_field("region")->integer();
    for (LocalId c = 0; c < fine.n_cells(); ++c) {
      const auto i = static_cast<std::size_t>(c);
      const auto found = std::lower_bound(mesh.cell_global.begin(), mesh.cell_global.end(), parent[i]);
      ASSERT_TRUE(found != mesh.cell_global.end() && *found == parent[i]) << "cells stay on their rank";
      const auto old = static_cast<LocalId>(found - mesh.cell_global.begin());
      const auto p = fine.points(c);
      const auto x = 0.25 * (p[0] + p[1] + p[2] + p[3]);
      for (std::size_t k = 0; k < 4; ++k) {
        auto q = mesh.points(old);
        q[k] = x;
        EXPECT_GE(geometry::volume(q), -1e-15);
      }
      EXPECT_EQ(region[i], mesh.find_cell_field("region")->integer()[static_cast<std::size_t>(old)]);
    }
    mesh = fine;
  }
}

/// A field of integers of the whole mesh, by cell number.
std::vector<std::int64_t> whole_field(const par::Comm& comm, const mesh::DistMesh& mesh, const char* name) {
  std::vector<std::int64_t> whole(static_cast<std::size_t>(mesh.info.n_global_cells), 0);
  const auto& here = mesh.find_cell_field(name)->integer();
  for (std::size_t c = 0; c < here.size(); ++c)
    whole[static_cast<std::size_t>(mesh.cell_global[c] - mesh.info.first_id)] = here[c];
  comm.sum_in_place(whole);
  return whole;
}

TEST(Transfer, NamesTheSameInputCellsWhenCellsChangeRanksAfterAnEarlyPass) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = mesh_with_fields(comm);
  int early_passes = 0;
  for (int level = 0; level < 3; ++level) {
    const auto flags = near_corner(mesh);
    auto stayed = adapt::refine(comm, mesh, flags);
    const auto moved = adapt::refine(comm, std::move(mesh), flags);

    for (const auto* name : {"parent", "region"})
      EXPECT_EQ(whole_field(comm, moved.mesh, name), whole_field(comm, stayed.mesh, name));
    early_passes += stayed.report.closure.early_passes;
    mesh = std::move(stayed.mesh);
  }
  EXPECT_GT(early_passes, 0);
}

}  // namespace transfer_test
}  // namespace pamr
