// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "pamr/base/index.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/spread_cells.hpp"
#include "solvers/poisson_boltzmann/stiffness.hpp"

namespace pamr::poisson_boltzmann {
namespace {

/// All values of all ranks, rank by rank. Collective.
std::vector<std::int64_t> gather(const par::Comm& comm, const std::vector<std::int64_t>& here) {
  std::vector<par::Outgoing<std::int64_t>> messages;
  for (Rank rank = 0; rank < comm.size(); ++rank) messages.push_back({rank, here});
  return comm.sparse_exchange(messages).item;
}

/// A mesh in random order, spread by Scotch, with its boundary named as that of the cube.
struct Spread {
  Spread(const par::Comm& comm, mesh::BlockMesh block)
      : input(read_case(cube_boundary("condition = \"potential\"\nvalue = 1"), "case")),
        mesh(spread_cells(comm, assemble::assemble(comm, std::move(block)), balance::Method::scotch).mesh),
        domain(make_domain(comm, mesh, input, "case")) {}

  Case input;
  mesh::DistMesh mesh;
  Domain domain;
};

/// What the cells of all ranks say: the equations that each equation is coupled to.
std::map<std::int64_t, std::set<std::int64_t>> couplings(const par::Comm& comm, const Domain& domain) {
  std::vector<std::int64_t> equations;
  for (const auto& nodes : domain.mesh->cell_to_node)
    for (const auto node : nodes) equations.push_back(domain.nodes.equation()[at(node)]);
  const auto all = gather(comm, equations);
  std::map<std::int64_t, std::set<std::int64_t>> result;
  for (std::size_t c = 0; c < all.size(); c += 4)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) result[all[c + i]].insert(all[c + j]);
  return result;
}

void expect_exact_halo(const par::Comm& comm, mesh::BlockMesh block) {
  const Spread spread(comm, std::move(block));
  const auto& nodes = spread.domain.nodes;
  const auto matrix = assemble_stiffness(comm, spread.domain);
  const auto coupled = couplings(comm, spread.domain);

  const auto first = static_cast<std::int64_t>(nodes.first_equation());
  const auto end = first + static_cast<std::int64_t>(nodes.n_owned());
  std::set<std::int64_t> needed;
  for (auto row = first; row < end; ++row) {
    for (const auto column : coupled.at(row))
      if (column < first || column >= end) needed.insert(column);
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    require(MatGetRow(matrix, static_cast<PetscInt>(row), &n, &columns, nullptr));
    EXPECT_EQ(std::set<std::int64_t>(columns, columns + n), coupled.at(row)) << "row " << row;
    require(MatRestoreRow(matrix, static_cast<PetscInt>(row), &n, &columns, nullptr));
  }
  if (comm.size() == 1) return;

  PetscInt n_ghosts = 0;
  const PetscInt* ghosts = nullptr;
  require(MatGetGhosts(matrix, &n_ghosts, &ghosts));
  EXPECT_EQ(std::set<std::int64_t>(ghosts, ghosts + n_ghosts), needed);
  EXPECT_EQ(static_cast<std::size_t>(n_ghosts), needed.size());
}

TEST(Halo, HoldsAllGhostsThatAreNeededAndNoOthers) {
  par::Comm comm(MPI_COMM_WORLD);
  expect_exact_halo(comm, test::kuhn_cube(comm, 6));
  expect_exact_halo(comm, test::random_mesh(comm, 6, 3));
}

TEST(Halo, GivesProductsTheGhostsOfAllRanks) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread spread(comm, test::random_mesh(comm, 5, 4));
  const auto& nodes = spread.domain.nodes;
  const auto matrix = assemble_stiffness(comm, spread.domain);
  Vector x, y;
  require(MatCreateVecs(matrix, x.address(), y.address()));
  {
    Entries entries(x);
    for (std::size_t k = 0; k < nodes.n_owned(); ++k) {
      const auto p = spread.domain.point[at(nodes.owned()[k])];
      entries[k] = p.x + 2 * p.y - 3 * p.z;
    }
  }

  require(MatMult(matrix, x, y));

  // Linear functions are harmonic.
  const ConstEntries product(y);
  for (std::size_t k = 0; k < nodes.n_owned(); ++k) {
    const bool is_inside = spread.domain.node_patches[at(nodes.owned()[k])] == 0;
    EXPECT_NEAR(is_inside ? product[k] : 0, 0, 1e-11);
  }
}

TEST(Halo, BringsTheValuesOfTheirOwners) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread spread(comm, test::random_mesh(comm, 6, 3));
  const auto& nodes = spread.domain.nodes;
  std::vector<double> owned(nodes.n_owned());
  for (std::size_t k = 0; k < owned.size(); ++k)
    owned[k] = static_cast<double>(spread.mesh.node_global[at(nodes.owned()[k])]);

  const auto local = nodes.spread(comm, owned);

  for (std::size_t i = 0; i < local.size(); ++i) EXPECT_EQ(local[i], static_cast<double>(spread.mesh.node_global[i]));
}

TEST(NodeMap, GivesEveryNodeOneOwnerAndNoRankAllOfItsBorder) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread spread(comm, test::kuhn_cube(comm, 8));
  const auto& nodes = spread.domain.nodes;

  std::vector<std::int64_t> numbers;
  for (const auto node : nodes.owned()) numbers.push_back(spread.mesh.node_global[at(node)]);
  auto all = gather(comm, numbers);
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), 729U);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], static_cast<std::int64_t>(i));

  const auto& shared = nodes.shared();
  if (comm.size() == 2) {
    const auto mine =
        std::count_if(shared.item.begin(), shared.item.end(), [&](LocalId i) { return nodes.is_owned(at(i)); });
    EXPECT_LE(std::abs(2 * mine - static_cast<std::int64_t>(shared.item.size())), 1);
  }
  EXPECT_LT(static_cast<double>(comm.max(static_cast<std::int64_t>(nodes.n_owned()))), 1.2 * 729 / comm.size());
}

}  // namespace
}  // namespace pamr::poisson_boltzmann
