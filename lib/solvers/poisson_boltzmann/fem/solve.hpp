// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"
#include "solvers/poisson_boltzmann/fem/stiffness.hpp"

namespace pamr::poisson_boltzmann {

/// One line of the convergence table.
struct NewtonStep {
  int step = 0;
  double residual = 0;        ///< 2-norm over the free nodes
  double largest_change = 0;  ///< of u in this step
  int linear_iterations = 0;  ///< of this step
};

struct Solution {
  std::vector<double> u;         ///< n_nodes; psi = psi0 + u
  std::vector<double> reaction;  ///< n_nodes: residual without the given potentials; the charge that holds a fixed node
  bool converged = false;
  std::string reason;  ///< PETSc's, where it has not converged
  std::vector<NewtonStep> steps;
  int newton_iterations = 0;
  int linear_iterations = 0;
  double residual = 0;                   ///< at the end
  double tolerance = 0;                  ///< of the residual
  double first_residual = 0;             ///< of the potential that is 0 off the boundary
  GlobalId worst_node = invalid_global;  ///< where the residual is largest
  geometry::Vec3 worst_point;            ///< length unit of the mesh
  double worst_residual = 0;
};

/// Galerkin system of one problem, of first or second order. The stiffness matrix is assembled once; with nodal
/// quadrature a Newton step rewrites only the diagonal of its copy, with Gauss points all of it.
class System {
 public:
  /// Refers to `comm` and `problem` for life. `before_matrices` is called when PETSc has taken its options and nothing
  /// large is allocated yet. Collective. Throws `Error` when PETSc cannot use its options.
  System(const par::Comm& comm, const Problem& problem, const std::function<void()>& before_matrices = {});

  /// Newton's method with line search (SNES), linear systems by conjugate gradients. Collective.
  /// - Starts from `start` (u at the local nodes) or, when it is empty, from 0 off the boundary. Of the solution, which
  ///   is the only one, the start decides no more than what the tolerance leaves open.
  /// - `show` is called with each line of the convergence table.
  /// - Converged when the residual is below `tolerance` times that of the potential that is 0 off the boundary, with or
  ///   without the charge of the ions, whichever is less, or what rounding leaves of the latter; or, where rounding of
  ///   that charge does not allow it, when a further step would change 1e-8 of the largest potential.
  Solution solve(std::span<const double> start, const std::function<void(const NewtonStep&)>& show);

  /// Solution w of the linearized equation at the last solution, w = `value` where u is given (zeros when empty), with
  /// `load` at the free nodes. Collective.
  std::vector<double> solve_linearised(std::span<const double> load, std::span<const double> value);

  /// The discrete harmonic function that is 1 on the patches of `one`, 0 on those of `zero` (bit p for patch p; `one`
  /// decides where they meet) and free elsewhere, to 1e-3: a linear system with the stiffness matrix. Frees the
  /// preconditioner of Newton's method. Collective.
  std::vector<double> harmonic(std::uint64_t one, std::uint64_t zero);

  /// u . K u, the energy of the gradient. Collective.
  double gradient_energy(std::span<const double> local) const;

 private:
  static PetscErrorCode residual_callback(SNES snes, Vec u, Vec f, void* context);
  static PetscErrorCode jacobian_callback(SNES snes, Vec u, Mat j, Mat p, void* context);
  enum class Terms { all, without_ions };
  void residual(Vec u, Vec f, bool with_fixed, Terms terms = Terms::all) const;
  /// That of the residual, by the unknowns at hand, which are 0 off the boundary. Returns the least that rounding
  /// allows. Collective.
  double set_tolerance(Solution& solution);
  void linearize(Vec u);
  /// The largest change in a further step of Newton's method, which is not taken; infinite where its linear system is
  /// not solved to `tolerance`. Collective.
  double step_to_go(double tolerance);
  void eliminate_fixed();
  void solve_linear(KSP solver, Vec right, Vec result, double tolerance);
  /// Made when the first system is solved. Not that of Newton's method, which sets its own tolerance before every
  /// solve; the memory of its preconditioner goes.
  KSP dual_solver();
  void release_newton();
  /// The source term is lumped at the nodes.
  bool is_nodal() const {
    return problem_.input.solver.order == 1 && problem_.input.solver.quadrature == Quadrature::nodal;
  }
  void configure(SNES snes);
  void configure(KSP ksp) const;
  void set_owned(Vec vector, std::span<const double> local) const;
  std::vector<double> local_values(Vec vector) const;
  void find_worst(Vec f, Solution& solution) const;

  const par::Comm& comm_;
  const Problem& problem_;
  const Domain& domain_;          ///< of the problem
  const Conditions& conditions_;  ///< of the problem
  SymmetricRows rows_;            ///< of the stiffness
  Matrix stiffness_, jacobian_;
  Vector diagonal_;  ///< of the stiffness, 1 at fixed nodes
  Vector unknown_, work_, updated_;
  NonlinearSolver snes_;
  LinearSolver dual_;  ///< made when the first such function is asked for
};

}  // namespace pamr::poisson_boltzmann
