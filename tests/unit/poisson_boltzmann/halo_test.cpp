// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "pamr/base/index.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/fem/harmonic.hpp"
#include "solvers/poisson_boltzmann/fem/spread_cells.hpp"

namespace pamr::poisson_boltzmann {
namespace halo_test {

/// All values of all ranks, rank by rank. Collective.
template <class T>
std::vector<T> gather(const par::Comm& comm, const std::vector<T>& here) {
  std::vector<par::Outgoing<T>> messages;
  for (Rank rank = 0; rank < comm.size(); ++rank) messages.push_back({rank, here});
  return comm.sparse_exchange(messages).item;
}

/// A mesh in random order, spread by Scotch, with its boundary named as that of the cube.
struct Spread {
  Spread(const par::Comm& comm, mesh::BlockMesh block)
      : input(read_case(cube_boundary("kind = \"potential\"\nvalue = 1"), "case")),
        mesh(spread_cells(comm, assemble::assemble(comm, std::move(block)), balance::Method::scotch).mesh),
        domain(make_domain(comm, mesh, input, "case")) {}

  Case input;
  mesh::DistMesh mesh;
  Domain domain;
};

/// What the cells of all ranks say: the matrix, by the equations that each equation is coupled to.
std::map<std::int64_t, std::map<std::int64_t, double>> couplings(const par::Comm& comm, const Domain& domain) {
  std::vector<std::int64_t> equations;
  std::vector<double> blocks;
  for (std::size_t c = 0; c < domain.mesh->cell_to_node.size(); ++c) {
    const auto shape = domain.shape(c);
    for (std::size_t i = 0; i < 4; ++i) {
      equations.push_back(domain.nodes.equation()[at(domain.mesh->cell_to_node[c][i])]);
      for (std::size_t j = 0; j < 4; ++j) blocks.push_back(shape.volume * dot(shape.gradient[i], shape.gradient[j]));
    }
  }
  const auto all = gather(comm, equations);
  const auto values = gather(comm, blocks);
  std::map<std::int64_t, std::map<std::int64_t, double>> result;
  for (std::size_t c = 0; c < all.size(); c += 4)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) result[all[c + i]][all[c + j]] += values[4 * (c + i) + j];
  return result;
}

void expect_exact_halo(const par::Comm& comm, mesh::BlockMesh block) {
  const Spread spread(comm, std::move(block));
  const auto& nodes = spread.domain.nodes;
  const auto matrix = assemble_stiffness(comm, spread.domain, stiffness_rows(spread.domain));
  const auto coupled = couplings(comm, spread.domain);

  const auto first = static_cast<std::int64_t>(nodes.first_equation());
  const auto end = first + static_cast<std::int64_t>(nodes.n_owned());
  std::set<std::int64_t> needed;
  for (auto row = first; row < end; ++row) {
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    require(MatGetRow(matrix, static_cast<PetscInt>(row), &n, &columns, &values));
    std::map<std::int64_t, double> found;
    for (PetscInt k = 0; k < n; ++k) {
      found[columns[k]] = values[k];
      if (columns[k] < first || columns[k] >= end) needed.insert(columns[k]);
      EXPECT_EQ(coupled.at(row).count(columns[k]), 1U) << "row " << row;
    }
    // Entries that are zero but for rounding may be left out.
    for (const auto& [column, value] : coupled.at(row))
      EXPECT_NEAR(found[column], value, 1e-12 * coupled.at(row).at(row)) << "row " << row;
    require(MatRestoreRow(matrix, static_cast<PetscInt>(row), &n, &columns, &values));
  }
  if (comm.size() == 1) return;

  PetscInt n_ghosts = 0;
  const PetscInt* ghosts = nullptr;
  require(MatGetGhosts(matrix, &n_ghosts, &ghosts));
  EXPECT_EQ(std::set<std::int64_t>(ghosts, ghosts + n_ghosts), needed);
  EXPECT_EQ(static_cast<std::size_t>(n_ghosts), needed.size());
}

/// Entries of the rows of all ranks, shared rows as often as they are held.
std::int64_t n_entries(const par::Comm& comm, const SymmetricRows& rows) {
  return comm.sum(static_cast<std::int64_t>(2 * rows.column.size() + rows.diagonal.size()));
}

TEST(StiffnessRows, LeaveOutRightAnglesOnly) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread cube(comm, test::kuhn_cube(comm, 6)), random(comm, test::random_mesh(comm, 6, 3));
  const auto of_cube = stiffness_rows(cube.domain), of_random = stiffness_rows(random.domain);

  // In Kuhn's cube only neighbors along the axes remain: 3 n (n + 1)^2 edges.
  if (comm.size() == 1) {
    EXPECT_EQ(n_entries(comm, of_cube), 7 * 7 * 7 + 2 * 3 * 6 * 7 * 7);
  }
  const auto memory = memory_needed(random.mesh, random.input);
  if (comm.size() == 1) {
    EXPECT_EQ(n_entries(comm, stiffness_rows(random.domain, true)), memory.n_entries);
  }
  for (const auto* rows : {&of_cube, &of_random}) {
    std::vector<double> product(rows->diagonal.size());
    const std::vector<double> constant(product.size(), 1);
    EXPECT_NEAR(rows->multiply(constant, product), 0, 1e-10);
    for (const double sum : product) EXPECT_NEAR(sum, 0, 1e-12);
  }
}

TEST(StiffnessRows, MultiplyAsTheMatrixDoes) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread spread(comm, test::random_mesh(comm, 5, 3));
  const auto& nodes = spread.domain.nodes;
  const auto rows = stiffness_rows(spread.domain);
  const auto matrix = assemble_stiffness(comm, spread.domain, rows);
  std::vector<double> x, product(nodes.n_nodes(), std::nan(""));
  for (const auto& p : spread.domain.point) x.push_back(std::sin(3 * p.x) + p.y * p.z);
  Vector of_x, of_product;
  require(MatCreateVecs(matrix, of_x.address(), of_product.address()));
  {
    Entries entries(of_x);
    for (std::size_t k = 0; k < nodes.n_owned(); ++k) entries[k] = x[at(nodes.owned()[k])];
  }

  const auto squares = gather(comm, std::vector<double>{rows.multiply(x, product)});
  nodes.sum_copies(comm, product);
  require(MatMult(matrix, of_x, of_product));

  const ConstEntries expected(of_product);
  for (std::size_t k = 0; k < nodes.n_owned(); ++k) EXPECT_NEAR(product[at(nodes.owned()[k])], expected[k], 1e-13);
  double square = 0;
  require(VecDot(of_x, of_product, &square));
  EXPECT_NEAR(std::accumulate(squares.begin(), squares.end(), 0.0), square, 1e-12 * square);
}

TEST(HarmonicFunction, LeavesAThousandthOfTheResidualAndWhatIsGiven) {
  par::Comm comm(MPI_COMM_WORLD);
  const Spread spread(comm, test::random_mesh(comm, 6, 3));
  const auto& domain = spread.domain;
  const auto rows = stiffness_rows(domain);
  const std::uint64_t one = 1, zero = 2;

  const auto harmonic = harmonic_function(comm, domain, rows, one, zero);

  std::vector<double> first(harmonic.size(), 0), before(harmonic.size()), after(harmonic.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    if ((domain.node_patches[i] & one) != 0) first[i] = 1;
    if ((domain.node_patches[i] & (one | zero)) != 0) {
      EXPECT_EQ(harmonic[i], first[i]);
    }
  }
  rows.multiply(first, before);
  rows.multiply(harmonic, after);
  domain.nodes.sum_copies(comm, before);
  domain.nodes.sum_copies(comm, after);
  double squared_before = 0, squared_after = 0;
  for (const auto node : domain.nodes.owned()) {
    if ((domain.node_patches[at(node)] & (one | zero)) != 0) continue;
    squared_before += before[at(node)] * before[at(node)];
    squared_after += after[at(node)] * after[at(node)];
  }
  const auto all_before = gather(comm, std::vector<double>{squared_before});
  const auto all_after = gather(comm, std::vector<double>{squared_after});
  const double ratio = std::sqrt(std::accumulate(all_after.begin(), all_after.end(), 0.0) /
                                 std::accumulate(all_before.begin(), all_before.end(), 0.0));
  EXPECT_LE(ratio, 1.001e-3);
  EXPECT_GT(ratio, 1e-5);
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
  const auto matrix = assemble_stiffness(comm, spread.domain, stiffness_rows(spread.domain));
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

}  // namespace halo_test
}  // namespace pamr::poisson_boltzmann
