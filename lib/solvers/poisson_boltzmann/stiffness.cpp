// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/stiffness.hpp"

#include <algorithm>
#include <limits>

#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Rows of the part of the matrix that this rank's cells give, by local nodes.
struct LocalRows {
  std::vector<std::size_t> offset{0};
  std::vector<LocalId> column;
  std::vector<double> value;
};

struct NodeCells {
  std::vector<std::size_t> offset;
  std::vector<std::int32_t> entry;  ///< 4 * cell + corner
};

NodeCells cells_of_nodes(const Domain& domain) {
  const auto& cells = domain.mesh->cell_to_node;
  NodeCells result;
  result.offset.assign(domain.point.size() + 1, 0);
  for (const auto& nodes : cells)
    for (const auto node : nodes) ++result.offset[at(node) + 1];
  for (std::size_t i = 1; i < result.offset.size(); ++i) result.offset[i] += result.offset[i - 1];
  result.entry.resize(result.offset.back());
  auto next = result.offset;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) result.entry[next[at(cells[c][k])]++] = static_cast<std::int32_t>(4 * c + k);
  return result;
}

LocalRows local_rows(const Domain& domain) {
  const auto& cells = domain.mesh->cell_to_node;
  const auto around = cells_of_nodes(domain);
  LocalRows rows;
  rows.column.reserve(domain.point.size() * 15);
  rows.value.reserve(domain.point.size() * 15);
  constexpr auto nowhere = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> place(domain.point.size(), nowhere);
  for (std::size_t node = 0; node < domain.point.size(); ++node) {
    for (std::size_t k = around.offset[node]; k < around.offset[node + 1]; ++k) {
      const auto cell = at(around.entry[k] / 4);
      const auto corner = at(around.entry[k] % 4);
      const auto shape = domain.shape(cell);
      for (std::size_t j = 0; j < 4; ++j) {
        const auto other = at(cells[cell][j]);
        if (place[other] == nowhere) {
          place[other] = rows.column.size();
          rows.column.push_back(static_cast<LocalId>(other));
          rows.value.push_back(0);
        }
        rows.value[place[other]] += shape.volume * dot(shape.gradient[corner], shape.gradient[j]);
      }
    }
    for (std::size_t k = rows.offset.back(); k < rows.column.size(); ++k) place[at(rows.column[k])] = nowhere;
    rows.offset.push_back(rows.column.size());
  }
  return rows;
}

/// Upper bounds of the entries of each owned row: those of this rank and, for shared nodes, of the others.
struct RowLengths {
  std::vector<PetscInt> diagonal, off_diagonal;
};

RowLengths count_entries(const par::Comm& comm, const Domain& domain, const LocalRows& rows) {
  const auto& nodes = domain.nodes;
  const auto n_owned = static_cast<PetscInt>(nodes.n_owned());
  std::vector<std::int32_t> elsewhere(domain.point.size(), 0);
  const auto& shared = nodes.shared();
  const par::Exchange exchange(comm, shared);
  std::vector<std::int32_t> mine(shared.item.size());
  for (std::size_t k = 0; k < mine.size(); ++k) {
    const auto node = at(shared.item[k]);
    mine[k] = static_cast<std::int32_t>(rows.offset[node + 1] - rows.offset[node]);
  }
  const auto theirs = exchange.swap<std::int32_t>(mine);
  for (std::size_t k = 0; k < mine.size(); ++k) elsewhere[at(shared.item[k])] += theirs[k];

  RowLengths lengths;
  for (const auto owned : nodes.owned()) {
    const auto node = at(owned);
    PetscInt here = elsewhere[node], off = elsewhere[node];
    for (std::size_t k = rows.offset[node]; k < rows.offset[node + 1]; ++k)
      ++(nodes.is_owned(at(rows.column[k])) ? here : off);
    lengths.diagonal.push_back(std::min(here, n_owned));
    lengths.off_diagonal.push_back(std::min(off, nodes.n_equations() - n_owned));
  }
  return lengths;
}

}  // namespace

Matrix assemble_stiffness(const par::Comm& comm, const Domain& domain) {
  const auto rows = local_rows(domain);
  const auto& nodes = domain.nodes;
  const auto lengths = count_entries(comm, domain, rows);

  Matrix matrix;
  const auto n_owned = static_cast<PetscInt>(nodes.n_owned());
  require(MatCreate(comm.handle(), matrix.address()));
  require(MatSetSizes(matrix, n_owned, n_owned, nodes.n_equations(), nodes.n_equations()));
  require(MatSetType(matrix, MATAIJ));
  require(MatSeqAIJSetPreallocation(matrix, 0, lengths.diagonal.data()));
  require(MatMPIAIJSetPreallocation(matrix, 0, lengths.diagonal.data(), 0, lengths.off_diagonal.data()));
  std::vector<PetscInt> columns;
  for (std::size_t node = 0; node < domain.point.size(); ++node) {
    columns.clear();
    for (std::size_t k = rows.offset[node]; k < rows.offset[node + 1]; ++k)
      columns.push_back(nodes.equation()[at(rows.column[k])]);
    const PetscInt row = nodes.equation()[node];
    require(MatSetValues(matrix, 1, &row, static_cast<PetscInt>(columns.size()), columns.data(),
                         rows.value.data() + rows.offset[node], ADD_VALUES));
  }
  require(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  require(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  require(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  require(MatSetOption(matrix, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  return matrix;
}

}  // namespace pamr::poisson_boltzmann
