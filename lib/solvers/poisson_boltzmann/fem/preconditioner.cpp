// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace pamr::poisson_boltzmann {

namespace {

/// hypre's settings have no functions in PETSc, only options. PMIS coarsens alike on any ranks, which HMIS does not.
/// One sweep forward on the way down and one backward on the way up are half the work of symmetric ones, and a
/// symmetric preconditioner as well.
constexpr std::array<std::pair<const char*, const char*>, 9> multigrid_options{{
    {"-pc_hypre_boomeramg_coarsen_type", "PMIS"},
    {"-pc_hypre_boomeramg_strong_threshold", "0.5"},
    {"-pc_hypre_boomeramg_agg_nl", "1"},
    {"-pc_hypre_boomeramg_agg_num_paths", "2"},
    {"-pc_hypre_boomeramg_interp_type", "ext+i"},
    {"-pc_hypre_boomeramg_P_max", "6"},
    {"-pc_hypre_boomeramg_relax_type_down", "SOR/Jacobi"},
    {"-pc_hypre_boomeramg_relax_type_up", "backward-SOR/Jacobi"},
    {"-pc_hypre_boomeramg_no_CF", "true"},
}};
constexpr const char* sweeps_of_all = "-pc_hypre_boomeramg_relax_type_all";

/// A step that takes more iterations than this pays for a new hierarchy, which costs some 15 of them.
constexpr PetscInt slow_step = 40;

bool has_option(const char* name) {
  PetscBool found = PETSC_FALSE;
  require(PetscOptionsHasName(nullptr, nullptr, name, &found));
  return found == PETSC_TRUE;
}

/// The user has a wish for what this option sets.
bool is_set(const char* name) {
  const bool is_sweep = std::string_view(name).find("_relax_type_") != std::string_view::npos;
  return has_option(name) || (is_sweep && has_option(sweeps_of_all));
}

}  // namespace

Preconditioner choose_preconditioner(const SolverOptions& options, GlobalId n_nodes) {
  if (options.preconditioner == "jacobi") return Preconditioner::jacobi;
  if (options.preconditioner == "boomeramg") return Preconditioner::boomeramg;
  return options.order == 1 && n_nodes >= multigrid_from_nodes ? Preconditioner::boomeramg : Preconditioner::jacobi;
}

const char* name_of(Preconditioner preconditioner) {
  return preconditioner == Preconditioner::jacobi ? "jacobi" : "boomeramg";
}

void set_preconditioner(KSP solver, Preconditioner preconditioner) {
  PC pc = nullptr;
  require(KSPGetPC(solver, &pc));
  if (preconditioner == Preconditioner::jacobi) {
    require(PCSetType(pc, PCJACOBI));
    return;
  }
  require(PCSetType(pc, PCHYPRE));
  require(PCHYPRESetType(pc, "boomeramg"));
  std::array<bool, multigrid_options.size()> is_ours{};
  for (std::size_t i = 0; i < is_ours.size(); ++i) {
    const auto& [name, value] = multigrid_options[i];
    is_ours[i] = !is_set(name);
    if (is_ours[i]) require(PetscOptionsSetValue(nullptr, name, value));
  }
  require_options(PCSetFromOptions(pc));
  for (std::size_t i = 0; i < is_ours.size(); ++i)
    if (is_ours[i]) require(PetscOptionsClearValue(nullptr, multigrid_options[i].first));
}

void keep_symmetric(KSP solver) {
  PC pc = nullptr;
  PetscBool is_tfs = PETSC_FALSE;
  require(KSPGetPC(solver, &pc));
  require(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCTFS, &is_tfs));
  if (is_tfs == PETSC_TRUE) refuse_solver_options("PETSc says nothing of a matrix that tfs cannot take, and crashes");
  require(PCASMSetType(pc, PC_ASM_BASIC));  // of others PETSc takes no notice
}

void keep_hierarchy(SNES newton) {
  KSP solver = nullptr;
  PC pc = nullptr;
  PetscBool is_multigrid = PETSC_FALSE;
  require(SNESGetKSP(newton, &solver));
  require(KSPGetPC(solver, &pc));
  require(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCHYPRE, &is_multigrid));
  if (is_multigrid == PETSC_TRUE && !has_option("-snes_lag_preconditioner"))
    require(SNESSetLagPreconditioner(newton, -2));  // now, and then no more
}

void renew_hierarchy_if_slow(SNES newton) {
  PetscInt lag = 0, iterations = 0;
  KSP solver = nullptr;
  require(SNESGetLagPreconditioner(newton, &lag));
  require(SNESGetKSP(newton, &solver));
  require(KSPGetIterationNumber(solver, &iterations));
  if (lag == -1 && iterations > slow_step) require(SNESSetLagPreconditioner(newton, -2));
}

}  // namespace pamr::poisson_boltzmann
