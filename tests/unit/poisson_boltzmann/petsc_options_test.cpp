// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/petsc_options.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace pamr::poisson_boltzmann {
namespace petsc_options_test {

TEST(CasePetscOptions, ChooseSolversAndTheirNumbers) {
  for (const char* text : {"", "-ksp_rtol 1e-12 -snes_ksp_ew 0", "-snes_lag_preconditioner -2", "-pc_sor_symmetric",
                           "-pc_type hypre -pc_hypre_type boomeramg -pc_hypre_boomeramg_P_max 4",
                           "-pc_hypre_boomeramg_relax_type_all SOR/Jacobi", "-sub_pc_type icc",
                           "-pc_type gamg -mg_levels_ksp_type chebyshev -mg_levels_12_pc_type sor"}) {
    const auto options = check_petsc_options(text);
    EXPECT_EQ(options.refused, "") << text;
    EXPECT_EQ(options.text, text);
  }
  EXPECT_EQ(check_petsc_options("  -ksp_type\tcg\n-ksp_rtol  .5 ").text, "-ksp_type cg -ksp_rtol .5");
}

TEST(CasePetscOptions, DoNotReadWriteRunOrPrint) {
  for (const char* name : {"-ksp_view",
                           "--ksp_view",
                           "-KSP_TYPE",
                           "-options_file",
                           "-options_file_yaml",
                           "-log_view",
                           "-ksp_monitor",
                           "-snes_monitor",
                           "-mg_levels_ksp_view",
                           "-mg_levels_1_ksp_view",
                           "-sub_mg_coarse_ksp_monitor",
                           "-prefix_push",
                           "-ksp_python_type",
                           "-pc_hypre_boomeramg_print_statistics",
                           "-pc_hypre_boomeramg_smooth_type",
                           "-start_in_debugger",
                           "-malloc_dump",
                           "-on_error_attach_debugger",
                           "-",
                           "-mg_levels_",
                           "-ksp_type*",
                           "-pc_hypre_boomeramg_*",
                           "-ksp_type\\",
                           "-info"})
    EXPECT_EQ(check_petsc_options("-ksp_rtol 1 " + std::string(name) + " 1").refused, name);
}

TEST(CasePetscOptions, BeginWithAnOption) { EXPECT_EQ(check_petsc_options("cg -ksp_type cg").refused, "cg"); }

TEST(CasePetscOptions, HaveValuesThatNameNoFiles) {
  for (const char* value : {"ascii:file", "a/b", ":", "$HOME", "`x`", "\"a", "#", "a=b", "binary:x:append"})
    EXPECT_EQ(check_petsc_options("-ksp_rtol " + std::string(value)).refused, "-ksp_rtol " + std::string(value));
  EXPECT_EQ(check_petsc_options("-pc_hypre_type euclid").refused, "-pc_hypre_type euclid");
}

TEST(CasePetscOptions, HaveNoValuesThatStopOrCrashPetsc) {
  for (const char* text : {"-snes_type ksponly",
                           "-snes_type fas",
                           "-snes_type shell",
                           "-ksp_type minres",
                           "-ksp_type pipecr",
                           "-ksp_type fetidp",
                           "-pc_type shell",
                           "-pc_type mg",
                           "-pc_type ilu",
                           "-pc_type composite",
                           "-ksp_type preonly",
                           "-ksp_type cgs",
                           "-mg_levels_ksp_type preonly",
                           "-snes_linesearch_type shell",
                           "-pc_factor_mat_ordering_type external",
                           "-pc_sor_its 0",
                           "-pc_sor_its 1.5",
                           "-pc_sor_lits -1",
                           "-snes_ksp_ew_version 9",
                           "-ksp_norm_type none",
                           "-ksp_gmres_restart 99999999999",
                           "-ksp_rtol nan",
                           "-ksp_rtol -1",
                           "-ksp_rtol 1e-3x",
                           "-snes_lag_jacobian 0",
                           "-mg_levels_pc_type shell",
                           "-sub_ksp_type cg",
                           "-pc_hypre_boomeramg_relax_type_all CG",
                           "-ksp_cg_single_reduction maybe"}) {
    const auto options = check_petsc_options(text);
    EXPECT_EQ(options.refused, text);
    EXPECT_NE(options.expected.find(std::string(text).substr(0, std::string(text).find(' '))), std::string::npos)
        << text;
  }
  for (const char* name : {"-pc_mg_levels", "-mg_levels_snes_type", "-ksp_type", "-ksp_rtol"})
    EXPECT_EQ(check_petsc_options(name).refused, name);
  EXPECT_EQ(check_petsc_options("-ksp_type cg gmres").refused, "gmres");
}

TEST(CasePetscOptions, NameTheKeysOfTheCaseThatCount) {
  for (const auto& [option, key] : {std::pair{"-snes_rtol", "tolerance"}, std::pair{"-snes_atol", "tolerance"},
                                    std::pair{"-snes_stol", "tolerance"}, std::pair{"-snes_max_it", "max_newton"}}) {
    const auto options = check_petsc_options(option + std::string(" 1"));
    EXPECT_EQ(options.refused, option);
    EXPECT_EQ(options.expected, key + std::string(" of [solver] in its place"));
  }
}

}  // namespace petsc_options_test
}  // namespace pamr::poisson_boltzmann
