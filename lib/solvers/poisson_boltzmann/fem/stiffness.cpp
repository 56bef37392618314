// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// All entries of the rows of this rank's part, by local nodes, columns ascending.
struct FullRows {
  std::vector<std::size_t> offset;
  std::vector<LocalId> column;
  std::vector<double> value;
};

struct NodeCells {
  std::vector<std::size_t> offset;
  std::vector<LocalId> cell;
};

template <class Cells>
NodeCells cells_of_nodes(const Cells& cells, std::size_t n_nodes) {
  NodeCells result;
  result.offset.assign(n_nodes + 1, 0);
  for (const auto& nodes : cells)
    for (const auto node : nodes) ++result.offset[at(node) + 1];
  for (std::size_t i = 1; i < result.offset.size(); ++i) result.offset[i] += result.offset[i - 1];
  result.cell.resize(result.offset.back());
  auto next = result.offset;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto node : cells[c]) result.cell[next[at(node)]++] = static_cast<LocalId>(c);
  return result;
}

/// The rows without values: of each node the neighbors of lower number.
template <class Element>
SymmetricRows pattern_of(const Element& element) {
  const auto& cells = element.cells();
  const auto n_nodes = element.domain.point.size();
  const auto around = cells_of_nodes(cells, n_nodes);
  SymmetricRows rows;
  rows.offset.reserve(n_nodes + 1);
  rows.column.reserve(n_nodes * Element::n_left);
  std::vector<LocalId> last_row(n_nodes, -1);
  for (std::size_t node = 0; node < n_nodes; ++node) {
    const auto here = static_cast<LocalId>(node);
    for (std::size_t k = around.offset[node]; k < around.offset[node + 1]; ++k)
      for (const auto other : cells[at(around.cell[k])]) {
        if (other >= here || last_row[at(other)] == here) continue;
        last_row[at(other)] = here;
        rows.column.push_back(other);
      }
    std::sort(rows.column.begin() + static_cast<std::ptrdiff_t>(rows.offset.back()), rows.column.end());
    rows.offset.push_back(rows.column.size());
  }
  rows.value.assign(rows.column.size(), 0);
  rows.diagonal.assign(n_nodes, 0);
  return rows;
}

/// Adds to the entry of two different nodes, which the rows have.
void add_pair(LocalId a, LocalId b, double amount, SymmetricRows& rows) {
  auto place = rows.offset[at(std::max(a, b))];
  for (const auto column = std::min(a, b); rows.column[place] != column;) ++place;
  rows.value[place] += amount;
}

template <class Element>
void add_cells(const Element& element, SymmetricRows& rows) {
  constexpr auto n = Element::n_nodes;
  for (std::size_t c = 0; c < element.cells().size(); ++c) {
    const auto cell = element.cell(c);
    std::array<double, n * n> block{};
    cell.at_gradients([&](double weight, const std::array<geometry::Vec3, n>& gradient) {
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) block[n * i + j] += weight * dot(gradient[i], gradient[j]);
    });
    for (std::size_t i = 0; i < n; ++i) {
      rows.diagonal[at(cell.nodes[i])] += block[(n + 1) * i];
      for (std::size_t j = 0; j < i; ++j) add_pair(cell.nodes[i], cell.nodes[j], block[n * i + j], rows);
    }
  }
}

/// Entries under this share of the diagonal are rounding.
constexpr double rounding = 1e-14;

void drop_zeros(SymmetricRows& rows) {
  std::size_t n_kept = 0, first = 0;
  for (std::size_t row = 0; row < rows.diagonal.size(); ++row) {
    const auto end = rows.offset[row + 1];
    for (auto k = first; k < end; ++k) {
      const auto column = at(rows.column[k]);
      const double value = rows.value[k];
      if (std::abs(value) > rounding * std::min(rows.diagonal[row], rows.diagonal[column])) {
        rows.column[n_kept] = rows.column[k];
        rows.value[n_kept++] = value;
      } else {
        rows.diagonal[row] += value;
        rows.diagonal[column] += value;
      }
    }
    first = end;
    rows.offset[row + 1] = n_kept;
  }
  if (n_kept == rows.column.size()) return;
  rows.column.resize(n_kept);
  rows.value.resize(n_kept);
  rows.column.shrink_to_fit();
  rows.value.shrink_to_fit();
}

FullRows full_rows(const SymmetricRows& half) {
  const auto n_nodes = half.diagonal.size();
  FullRows rows;
  rows.offset.assign(n_nodes + 1, 0);
  for (std::size_t i = 0; i < n_nodes; ++i) rows.offset[i + 1] = half.offset[i + 1] - half.offset[i] + 1;
  for (const auto column : half.column) ++rows.offset[at(column) + 1];
  for (std::size_t i = 0; i < n_nodes; ++i) rows.offset[i + 1] += rows.offset[i];
  rows.column.resize(rows.offset.back());
  rows.value.resize(rows.offset.back());
  std::vector<std::size_t> next(rows.offset.begin(), rows.offset.end() - 1);
  const auto put = [&](std::size_t row, std::size_t column, double value) {
    rows.column[next[row]] = static_cast<LocalId>(column);
    rows.value[next[row]++] = value;
  };
  // When row i comes, rows under it hold all up to their diagonal, and those above have their later columns put behind.
  for (std::size_t i = 0; i < n_nodes; ++i) {
    for (auto k = half.offset[i]; k < half.offset[i + 1]; ++k) {
      const auto j = at(half.column[k]);
      put(i, j, half.value[k]);
      put(j, i, half.value[k]);
    }
    put(i, i, half.diagonal[i]);
  }
  return rows;
}

/// Upper bounds of the entries of each owned row: those of this rank and, for shared nodes, of the others.
struct RowLengths {
  std::vector<PetscInt> diagonal, off_diagonal;
};

RowLengths count_entries(const par::Comm& comm, const Domain& domain, const FullRows& rows) {
  const auto& nodes = domain.nodes;
  const auto n_owned = static_cast<PetscInt>(nodes.n_owned());
  std::vector<std::int32_t> elsewhere(domain.point.size(), 0);
  par::fold_shared(
      par::Exchange(comm, nodes.shared()),
      [&](LocalId node) { return static_cast<std::int32_t>(rows.offset[at(node) + 1] - rows.offset[at(node)]); },
      [&](LocalId node, std::int32_t theirs) { elsewhere[at(node)] += theirs; });

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

double SymmetricRows::multiply(std::span<const double> x, std::span<double> y) const {
  double product = 0;
  auto k = offset[0];
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    const double here = x[row];
    double left = 0;
    for (const auto end = offset[row + 1]; k < end; ++k) {
      const auto other = at(column[k]);
      left += value[k] * x[other];
      y[other] += value[k] * here;
    }
    const double own = diagonal[row] * here;
    y[row] = own + left;
    product += here * (own + 2 * left);
  }
  return product;
}

SymmetricRows stiffness_rows(const Domain& domain, bool keep_zeros) {
  auto rows = with_element(domain, [](const auto& element) {
    auto result = pattern_of(element);
    add_cells(element, result);
    return result;
  });
  if (!keep_zeros) drop_zeros(rows);
  return rows;
}

void add_far_field(const Problem& problem, SymmetricRows& rows) {
  const auto& domain = problem.domain;
  with_element(domain, [&](const auto& element) {
    if (element.has_lumped_walls) return;
    for (std::size_t f = 0; f < domain.faces.size(); ++f) {
      if (problem.boundary_of(domain.faces[f]).condition != Condition::far_field) continue;
      const auto face = element.face(f);
      face.at_wall_points([&](const auto& point) {
        const double amount = point.area * far_field_coefficient(problem.input.spheres, point.middle, point.normal);
        for (std::size_t i = 0; i < face.nodes.size(); ++i) {
          rows.diagonal[at(face.nodes[i])] += amount * point.value[i] * point.value[i];
          for (std::size_t j = 0; j < i; ++j)
            add_pair(face.nodes[i], face.nodes[j], amount * point.value[i] * point.value[j], rows);
        }
      });
    }
  });
}

Matrix assemble_stiffness(const par::Comm& comm, const Domain& domain, const SymmetricRows& half) {
  const auto rows = full_rows(half);
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
