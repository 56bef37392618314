// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/quadratic_stiffness.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_element.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Entries of each cell's block of the stiffness, row by row.
using CellBlock = std::array<double, 100>;
using FaceBlock = std::array<double, 36>;

CellBlock stiffness_of(const Domain& domain, std::size_t cell) {
  const auto node = domain.quadratic->points(domain, cell);
  CellBlock block{};
  for (const auto& point : cell_points()) {
    const auto placed = place(node, point);
    const double weight = point.weight * placed.jacobian / 6;
    for (std::size_t i = 0; i < 10; ++i)
      for (std::size_t j = 0; j <= i; ++j) block[10 * i + j] += weight * dot(placed.gradient[i], placed.gradient[j]);
  }
  for (std::size_t i = 0; i < 10; ++i)
    for (std::size_t j = 0; j < i; ++j) block[10 * j + i] = block[10 * i + j];
  return block;
}

FaceBlock far_field_of(const Problem& problem, std::size_t face) {
  const auto node = problem.domain.quadratic->face_points(problem.domain, face);
  FaceBlock block{};
  for (const auto& point : face_points()) {
    const auto placed = place(node, point);
    const double alpha = far_field_coefficient(problem.input.spheres, placed.position, placed.normal);
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) block[6 * i + j] += alpha * placed.area * point.value[i] * point.value[j];
  }
  return block;
}

template <std::size_t N>
std::array<PetscInt, N> rows_of(const Domain& domain, const std::array<LocalId, N>& nodes) {
  std::array<PetscInt, N> rows{};
  for (std::size_t k = 0; k < N; ++k) rows[k] = domain.nodes.equation()[at(nodes[k])];
  return rows;
}

template <std::size_t N>
void add_block(Mat matrix, const std::array<PetscInt, N>& rows, const double* block) {
  constexpr auto n = static_cast<PetscInt>(N);
  require(MatSetValues(matrix, n, rows.data(), n, rows.data(), block, ADD_VALUES));
}

void finish(Mat matrix) {
  require(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// A matrix with room for the entries of all cells. Collective.
Matrix with_room(const par::Comm& comm, const Domain& domain) {
  const auto n_owned = static_cast<PetscInt>(domain.nodes.n_owned()), n = domain.nodes.n_equations();
  Matrix pattern, matrix;
  for (auto* made : {&pattern, &matrix}) {
    require(MatCreate(comm.handle(), made->address()));
    require(MatSetSizes(*made, n_owned, n_owned, n, n));
    require(MatSetType(*made, made == &pattern ? MATPREALLOCATOR : MATAIJ));
  }
  require(MatSetUp(pattern));
  const CellBlock nothing{};
  for (const auto& nodes : domain.quadratic->cell_to_node) add_block(pattern, rows_of(domain, nodes), nothing.data());
  finish(pattern);
  require(MatPreallocatorPreallocate(pattern, PETSC_TRUE, matrix));
  return matrix;
}

/// Calls `use(shape functions, weight in space, u, psi0)` for the points of a cell.
template <class Use>
void at_points(const Problem& problem, std::size_t cell, const std::vector<double>& u, const Use& use) {
  const auto& elements = *problem.domain.quadratic;
  const auto node = elements.points(problem.domain, cell);
  const auto value = elements.values(cell, u);
  for (const auto& point : cell_points()) {
    const auto placed = place(node, point);
    use(point.value, point.weight * placed.jacobian / 6, interpolated(point.value, value),
        problem.split_potential(placed.position.z));
  }
}

}  // namespace

Matrix assemble_quadratic_stiffness(const par::Comm& comm, const Problem& problem) {
  const auto& domain = problem.domain;
  auto matrix = with_room(comm, domain);
  const auto& cells = domain.quadratic->cell_to_node;
  for (std::size_t c = 0; c < cells.size(); ++c)
    add_block(matrix, rows_of(domain, cells[c]), stiffness_of(domain, c).data());
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& patch = domain.mesh->info.patches[at(domain.faces[f].patch)].name;
    if (problem.input.find_boundary(patch)->condition != Condition::far_field) continue;
    add_block(matrix, rows_of(domain, domain.quadratic->face_to_node[f]), far_field_of(problem, f).data());
  }
  finish(matrix);
  require(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

void add_quadratic_source(const Problem& problem, const std::vector<double>& u, std::vector<double>& to) {
  const auto& cells = problem.domain.quadratic->cell_to_node;
  for (std::size_t c = 0; c < cells.size(); ++c)
    at_points(problem, c, u, [&](const OfCellNodes<double>& shape, double weight, double value, double psi0) {
      const double amount = weight * problem.term.value(value, psi0);
      for (std::size_t k = 0; k < 10; ++k) to[at(cells[c][k])] += amount * shape[k];
    });
}

void add_quadratic_source_matrix(const Problem& problem, const std::vector<double>& u, Mat matrix) {
  const auto& domain = problem.domain;
  const auto& cells = domain.quadratic->cell_to_node;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    CellBlock block{};
    at_points(problem, c, u, [&](const OfCellNodes<double>& shape, double weight, double value, double psi0) {
      const double amount = weight * problem.term.slope(value, psi0);
      for (std::size_t i = 0; i < 10; ++i)
        for (std::size_t j = 0; j < 10; ++j) block[10 * i + j] += amount * shape[i] * shape[j];
    });
    auto rows = rows_of(domain, cells[c]);
    for (std::size_t k = 0; k < 10; ++k)
      if (problem.conditions.fixed[at(cells[c][k])] != 0) rows[k] = -1;  // PETSc leaves negative rows out
    add_block(matrix, rows, block.data());
  }
  finish(matrix);
}

void add_quadratic_source_product(const Problem& problem, const std::vector<double>& u, std::span<const double> w,
                                  std::vector<double>& to) {
  const auto& elements = *problem.domain.quadratic;
  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    const auto of_w = elements.values(c, w);
    at_points(problem, c, u, [&](const OfCellNodes<double>& shape, double weight, double value, double psi0) {
      const double amount = weight * problem.term.slope(value, psi0) * interpolated(shape, of_w);
      for (std::size_t k = 0; k < 10; ++k) to[at(elements.cell_to_node[c][k])] += amount * shape[k];
    });
  }
}

double given_flux(const Case& input, const PlateProfile& profile, const Boundary& b, const PlacedFacePoint& placed) {
  const double slope = placed.normal.z * profile.slope(placed.position.z);
  if (b.condition != Condition::far_field)
    return (b.condition == Condition::charge ? b.value : 0) - (input.split ? slope : 0);
  if (input.split) return 0;
  return far_field_coefficient(input.spheres, placed.position, placed.normal) * profile.potential(placed.position.z) +
         slope;
}

std::vector<double> quadratic_load(const Domain& domain, const Case& input) {
  const auto& elements = *domain.quadratic;
  const auto profile = input.profile();
  std::vector<double> load(domain.point.size(), 0);
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& b = *input.find_boundary(domain.mesh->info.patches[at(domain.faces[f].patch)].name);
    if (fixes_potential(b.condition)) continue;
    const auto node = elements.face_points(domain, f);
    for (const auto& point : face_points()) {
      const auto placed = place(node, point);
      const double flux = given_flux(input, profile, b, placed);
      for (std::size_t k = 0; k < 6; ++k) load[at(elements.face_to_node[f][k])] += flux * placed.area * point.value[k];
    }
  }
  if (!input.manufactured) return load;
  const auto term = input.term();
  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    const auto node = elements.points(domain, c);
    for (const auto& point : cell_points()) {
      const auto placed = place(node, point);
      const double psi = manufactured_potential(placed.position);
      const double source = point.weight * placed.jacobian / 6 * (psi + term.value(psi, 0));
      for (std::size_t k = 0; k < 10; ++k) load[at(elements.cell_to_node[c][k])] += source * point.value[k];
    }
  }
  return load;
}

}  // namespace pamr::poisson_boltzmann
