// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/harmonic.hpp"
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"
#include "solvers/poisson_boltzmann/fem/source_integrals.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Share by which two evaluations of one residual may differ.
constexpr double repeat_rounding = 1e-9;
constexpr double rounding_of_residual = 4 * std::numeric_limits<double>::epsilon();
constexpr double known_to = 1e-8;  // of the largest potential, where rounding keeps the residual up
constexpr double settled = 1e-3;   // of the largest potential: a last step of Newton's method

/// What PETSc hands to the monitor of one solve.
struct MonitorContext {
  const std::function<void(const NewtonStep&)>* show;
  std::vector<NewtonStep>* steps;
  int linear_before = 0;
};

/// Adds a line to the convergence table. An error goes back to PETSc, whose solve then fails with it.
PetscErrorCode monitor(SNES snes, PetscInt step, PetscReal norm, void* pointer) {
  auto& context = *static_cast<MonitorContext*>(pointer);
  PetscInt linear = 0;
  if (const auto code = SNESGetLinearSolveIterations(snes, &linear); code != 0) return code;
  NewtonStep line{static_cast<int>(step), norm, 0, static_cast<int>(linear) - context.linear_before};
  context.linear_before = static_cast<int>(linear);
  Vec update = nullptr;
  if (step > 0)
    if (const auto code = SNESGetSolutionUpdate(snes, &update); code != 0) return code;
  if (update != nullptr)
    if (const auto code = VecNorm(update, NORM_INFINITY, &line.largest_change); code != 0) return code;
  context.steps->push_back(line);
  if (*context.show) (*context.show)(line);
  return 0;
}

}  // namespace

System::System(const par::Comm& comm, const Problem& problem, const std::function<void()>& before_matrices)
    : comm_(comm), problem_(problem), domain_(problem.domain), conditions_(problem.conditions) {
  require(SNESCreate(comm.handle(), snes_.address()));
  configure(snes_);
  if (before_matrices) before_matrices();
  rows_ = stiffness_rows(domain_, !is_nodal());
  add_far_field(problem, rows_);
  stiffness_ = assemble_stiffness(comm, domain_, rows_);
  require(MatCreateVecs(stiffness_, unknown_.address(), work_.address()));
  require(VecDuplicate(unknown_, diagonal_.address()));
  require(VecDuplicate(unknown_, updated_.address()));
  require(MatDuplicate(stiffness_, MAT_COPY_VALUES, jacobian_.address()));
  require(MatSetOption(jacobian_, MAT_SPD, PETSC_TRUE));
  require(MatSetOption(jacobian_, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  eliminate_fixed();
  require(MatGetDiagonal(jacobian_, diagonal_));
  require(SNESSetFunction(snes_, nullptr, residual_callback, this));
  require(SNESSetJacobian(snes_, jacobian_, jacobian_, jacobian_callback, this));
}

/// Rows and columns of the fixed nodes of the Jacobian become those of the unit matrix.
void System::eliminate_fixed() {
  std::vector<PetscInt> fixed;
  for (const auto node : domain_.nodes.owned())
    if (conditions_.fixed[at(node)] != 0) fixed.push_back(domain_.nodes.equation()[at(node)]);
  require(MatZeroRowsColumns(jacobian_, static_cast<PetscInt>(fixed.size()), fixed.data(), 1.0, nullptr, nullptr));
}

void System::configure(KSP ksp) const {
  require(KSPSetType(ksp, KSPCG));
  set_preconditioner(ksp, choose_preconditioner(problem_.input.solver, domain_.mesh->info.n_global_nodes));
  require(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
}

void System::configure(SNES snes) {
  KSP ksp = nullptr;
  require(SNESGetKSP(snes, &ksp));
  configure(ksp);
  // Solving early Newton steps roughly halves the linear work (S. C. Eisenstat, H. F. Walker, SIAM J. Sci. Comput. 17
  // (1996), choice 2).
  if (!problem_.input.linear) {
    require(SNESKSPSetUseEW(snes, PETSC_TRUE));
    require(SNESKSPSetParametersEW(snes, 2, 1e-2, 1e-2, 0.9, 1.618033988749895, 1.618033988749895, 0.1));
  } else {
    require(KSPSetTolerances(ksp, 1e-2 * problem_.input.solver.tolerance, 0, PETSC_DEFAULT, 100000));
  }
  SNESLineSearch search = nullptr;
  require(SNESGetLineSearch(snes, &search));
  require(SNESLineSearchSetType(search, SNESLINESEARCHBT));
  // The step of a linear equation is the solution, of any size; PETSc shortens steps beyond 1e8.
  if (problem_.input.linear)
    require(SNESLineSearchSetTolerances(search, PETSC_DEFAULT, PETSC_MAX_REAL, PETSC_DEFAULT, PETSC_DEFAULT,
                                        PETSC_DEFAULT, PETSC_DEFAULT));
  require_options(SNESSetFromOptions(snes));
  keep_symmetric(ksp);
  keep_hierarchy(snes);
}

void System::set_owned(Vec vector, std::span<const double> local) const {
  Entries entries(vector);
  const auto& owned = domain_.nodes.owned();
  for (std::size_t k = 0; k < owned.size(); ++k) entries[k] = local[at(owned[k])];
}

std::vector<double> System::local_values(Vec vector) const {
  std::vector<double> owned(domain_.nodes.n_owned());
  {
    const ConstEntries entries(vector);
    for (std::size_t k = 0; k < owned.size(); ++k) owned[k] = entries[k];
  }
  return domain_.nodes.spread(comm_, owned);
}

void System::residual(Vec u, Vec f, bool with_fixed, Terms terms) const {
  require(MatMult(stiffness_, u, f));
  const bool has_ions = terms == Terms::all, nodal = is_nodal();
  const bool has_integrals = !nodal || problem_.input.has_regulated();
  std::vector<double> integral;
  if (has_integrals) {
    integral.assign(domain_.point.size(), 0);
    const auto local = local_values(u);
    if (!nodal && has_ions) add_source(problem_, local, integral);
    add_site_charge(problem_, local, -1, integral);
    domain_.nodes.sum_copies(comm_, integral);
  }
  const ConstEntries value(u);
  Entries result(f);
  const auto& owned = domain_.nodes.owned();
  for (std::size_t k = 0; k < owned.size(); ++k) {
    const auto i = at(owned[k]);
    if (conditions_.fixed[i] != 0 && !with_fixed) {
      result[k] = value[k] - conditions_.value[i];
      continue;
    }
    double source = nodal && has_ions ? domain_.node_volume[i] * problem_.term.value(value[k], conditions_.psi0[i]) : 0;
    if (has_integrals) source += integral[i];
    result[k] += source + conditions_.robin[i] * value[k] - conditions_.load[i];
  }
}

void System::linearize(Vec u) {
  const bool nodal = is_nodal();
  if (!nodal) {
    require(MatCopy(stiffness_, jacobian_, SAME_NONZERO_PATTERN));
    eliminate_fixed();
    const auto local = local_values(u);
    add_source_matrix(problem_, local, jacobian_);
    add_site_matrix(problem_, local, jacobian_);
  }
  require(nodal ? VecCopy(diagonal_, updated_) : MatGetDiagonal(jacobian_, updated_));
  std::vector<double> of_sites;
  if (nodal && problem_.input.has_regulated()) {
    of_sites.assign(domain_.point.size(), 0);
    add_site_slope(problem_, local_values(u), std::vector<double>(of_sites.size(), 1), of_sites);
    domain_.nodes.sum_copies(comm_, of_sites);
  }
  {
    const ConstEntries value(u);
    Entries diagonal(updated_);
    const auto& owned = domain_.nodes.owned();
    for (std::size_t k = 0; k < owned.size(); ++k) {
      const auto i = at(owned[k]);
      if (conditions_.fixed[i] != 0) continue;
      diagonal[k] += conditions_.robin[i] + (of_sites.empty() ? 0 : of_sites[i]);
      if (nodal) diagonal[k] += domain_.node_volume[i] * problem_.term.slope(value[k], conditions_.psi0[i]);
    }
  }
  require(MatDiagonalSet(jacobian_, updated_, INSERT_VALUES));
}

PetscErrorCode System::residual_callback(SNES, Vec u, Vec f, void* context) {
  static_cast<const System*>(context)->residual(u, f, false);
  return 0;
}

PetscErrorCode System::jacobian_callback(SNES snes, Vec u, Mat, Mat, void* context) {
  renew_hierarchy_if_slow(snes);
  static_cast<System*>(context)->linearize(u);
  return 0;
}

void System::find_worst(Vec f, Solution& solution) const {
  PetscInt worst = 0;
  Vector magnitude;
  require(VecDuplicate(f, magnitude.address()));
  require(VecCopy(f, magnitude));
  require(VecAbs(magnitude));
  require(VecMax(magnitude, &worst, &solution.worst_residual));
  GlobalId node = -1;
  geometry::Vec3 point{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  const auto here = static_cast<std::int64_t>(worst) - domain_.nodes.first_equation();
  if (here >= 0 && here < static_cast<std::int64_t>(domain_.nodes.n_owned())) {
    const auto i = at(domain_.nodes.owned()[static_cast<std::size_t>(here)]);
    node = domain_.node_global()[i];
    point = (1 / domain_.scale) * domain_.point[i];
  }
  solution.worst_node = comm_.max(node);
  solution.worst_point = {comm_.max(point.x), comm_.max(point.y), comm_.max(point.z)};
}

double System::step_to_go(double tolerance) {
  linearize(unknown_);
  residual(unknown_, work_, false);
  Vector step;
  require(VecDuplicate(unknown_, step.address()));
  KSP solver = nullptr;
  require(SNESGetKSP(snes_, &solver));
  require(KSPSetOperators(solver, jacobian_, jacobian_));
  require(KSPSetTolerances(solver, 0, tolerance, PETSC_DEFAULT, 100000));
  require_solve(KSPSolve(solver, work_, step));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  require(KSPGetConvergedReason(solver, &reason));
  double largest = HUGE_VAL;
  if (reason > 0) require(VecNorm(step, NORM_INFINITY, &largest));
  return largest;
}

double System::set_tolerance(Solution& solution) {
  // Beside a wall of high potential sinh may make the first residual as large as it likes: without it, the rest is the
  // measure. Where potentials cancel, as between two cells of opposite ones, what is left at the free nodes may be
  // rounding alone.
  double at_free = 0, at_all = 0;
  residual(unknown_, work_, false, Terms::without_ions);
  require(VecNorm(work_, NORM_2, &at_free));
  residual(unknown_, work_, true, Terms::without_ions);
  require(VecNorm(work_, NORM_2, &at_all));
  const double scale = at_free > 0 ? std::min(solution.first_residual, at_free) : solution.first_residual;
  const double least = std::max(rounding_of_residual * at_all, 1e-300);
  solution.tolerance = std::max(problem_.input.solver.tolerance * scale, least);
  return least;
}

Solution System::solve(std::span<const double> start, const std::function<void(const NewtonStep&)>& show) {
  Solution solution;
  std::vector<double> first(domain_.point.size(), 0);
  for (std::size_t i = 0; i < first.size(); ++i)
    if (conditions_.fixed[i] != 0) first[i] = conditions_.value[i];
  set_owned(unknown_, first);
  residual(unknown_, work_, false);
  require(VecNorm(work_, NORM_2, &solution.first_residual));
  if (!std::isfinite(solution.first_residual)) {
    solution.reason = "the residual of the potential that is 0 off the boundary is no number";
    return solution;
  }
  const double least = set_tolerance(solution);
  if (!start.empty() && solution.first_residual > 0) {  // else u = 0 is the solution
    for (std::size_t i = 0; i < first.size(); ++i)
      if (conditions_.fixed[i] == 0) first[i] = start[i];
    set_owned(unknown_, first);
  }

  MonitorContext context{&show, &solution.steps, 0};
  const auto& options = problem_.input.solver;
  const double tolerance = solution.tolerance;
  require(SNESMonitorSet(snes_, monitor, &context, nullptr));
  PetscErrorCode code = 0;
  // A wall of large charge may make the tolerance so large that another wall's potential still changes.
  for (double wanted = tolerance;; wanted = std::max(1e-3 * wanted, least)) {
    require(SNESSetTolerances(snes_, wanted, 0, 0, options.max_newton, 1000000));
    context.linear_before = 0;
    code = SNESSolve(snes_, nullptr, unknown_);
    if (code != PETSC_ERR_FP) require_solve(code);  // that one says that a number was beyond floating point
    SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
    require(SNESGetConvergedReason(snes_, &reason));
    PetscInt newton = 0, linear = 0;
    require(SNESGetIterationNumber(snes_, &newton));
    require(SNESGetLinearSolveIterations(snes_, &linear));
    solution.newton_iterations += static_cast<int>(newton);
    solution.linear_iterations += static_cast<int>(linear);
    if (code != 0 || reason <= 0) break;
    solution.converged = true;
    double largest = 0;
    require(VecNorm(unknown_, NORM_INFINITY, &largest));
    const bool is_settled =
        problem_.input.linear || solution.steps.empty() || !(solution.steps.back().largest_change > settled * largest);
    if (is_settled || wanted == least) break;
  }
  require(SNESMonitorCancel(snes_));

  const char* text = nullptr;
  require(SNESGetConvergedReasonString(snes_, &text));
  solution.reason = code != 0 ? "a number beyond floating point" : text == nullptr ? "" : text;
  residual(unknown_, work_, false);
  require(VecNorm(work_, NORM_2, &solution.residual));
  find_worst(work_, solution);
  residual(unknown_, work_, true);
  solution.reaction = local_values(work_);
  solution.u = local_values(unknown_);
  if (!std::isfinite(solution.residual)) {
    solution.converged = false;
    solution.reason = "the residual is no number";
  } else if (solution.converged && solution.residual > (1 + repeat_rounding) * tolerance) {
    // Solvers that the user's options choose have grounds of their own to stop.
    solution.converged = false;
    solution.reason += ", but the residual is above the tolerance";
  } else if (!solution.converged && code == 0 && solution.residual <= rounding_of_residual * solution.first_residual) {
    // Integrals of sinh at a wall of high potential cancel in the solution, and their rounding may be above the
    // tolerance: what counts is how little another step would change.
    double largest = 0;
    require(VecNorm(unknown_, NORM_INFINITY, &largest));
    solution.converged = step_to_go(tolerance) <= known_to * largest;
  }
  return solution;
}

std::vector<double> System::solve_linearised(std::span<const double> load, std::span<const double> value) {
  linearize(unknown_);
  std::vector<double> given(domain_.point.size(), 0), right(load.begin(), load.end());
  if (!value.empty())
    for (std::size_t i = 0; i < given.size(); ++i)
      if (conditions_.fixed[i] != 0) given[i] = value[i];
  // Moves the given values to the right-hand side: their columns are gone from the matrix.
  Vector w, f;
  require(VecDuplicate(unknown_, w.address()));
  require(VecDuplicate(unknown_, f.address()));
  set_owned(w, given);
  require(MatMult(stiffness_, w, f));
  std::vector<double> source(domain_.point.size(), 0);
  if (!is_nodal() && !value.empty()) {
    const auto u = local_values(unknown_);
    add_source_product(problem_, u, given, source);
    add_site_slope(problem_, u, given, source);
    domain_.nodes.sum_copies(comm_, source);
  }
  {
    Entries entries(f);
    const auto& owned = domain_.nodes.owned();
    for (std::size_t k = 0; k < owned.size(); ++k) {
      const auto i = at(owned[k]);
      entries[k] = conditions_.fixed[i] != 0 ? 0 : right[i] - entries[k] - source[i];
    }
  }
  // given values are no part of the system, whose tolerance they would decide where cells are small
  solve_linear(dual_solver(), f, w, 1e-6);
  auto solved = local_values(w);
  for (std::size_t i = 0; i < solved.size(); ++i)
    if (conditions_.fixed[i] != 0) solved[i] = given[i];
  return solved;
}

void System::solve_linear(KSP solver, Vec right, Vec result, double tolerance) {
  require(KSPSetInitialGuessNonzero(solver, PETSC_FALSE));
  require(KSPSetTolerances(solver, tolerance, 0, PETSC_DEFAULT, 100000));
  require(KSPSetOperators(solver, jacobian_, jacobian_));
  require_solve(KSPSolve(solver, right, result));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  require(KSPGetConvergedReason(solver, &reason));
  double given = 0, left = 0;
  Vector residual;
  require(VecDuplicate(right, residual.address()));
  require(MatMult(jacobian_, result, residual));
  require(VecAYPX(residual, -1, right));
  require(VecNorm(right, NORM_2, &given));
  require(VecNorm(residual, NORM_2, &left));
  if (reason < 0 || !(left <= 100 * tolerance * given))  // other norms that options choose may be weaker
    refuse_solver_options(
        fmt::format("a linear system is solved to {:.1e} in place of {:.1e}", left / given, tolerance));
}

KSP System::dual_solver() {
  if (dual_ == nullptr) {
    release_newton();
    require(KSPCreate(comm_.handle(), dual_.address()));
    configure(dual_);
    require_options(KSPSetFromOptions(dual_));
    keep_symmetric(dual_);
  }
  return dual_;
}

void System::release_newton() {
  KSP solver = nullptr;
  require(SNESGetKSP(snes_, &solver));
  require(KSPReset(solver));
}

std::vector<double> System::harmonic(std::uint64_t one, std::uint64_t zero) {
  release_newton();
  return harmonic_function(comm_, domain_, rows_, one, zero);
}

double System::gradient_energy(std::span<const double> local) const {
  Vector u, f;
  require(VecDuplicate(unknown_, u.address()));
  require(VecDuplicate(unknown_, f.address()));
  set_owned(u, local);
  require(MatMult(stiffness_, u, f));
  double product = 0;
  require(VecDot(u, f, &product));
  return product;
}

}  // namespace pamr::poisson_boltzmann
