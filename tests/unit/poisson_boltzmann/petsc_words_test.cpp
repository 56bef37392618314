// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solved.hpp"
#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/problem/petsc_options.hpp"

namespace pamr::poisson_boltzmann {
namespace petsc_words_test {

const std::string plate = cube_boundary("kind = \"symmetry\"", "zmin", "kind = \"potential\"\nvalue = 2");

/// Options of PETSc for the life of the object.
class Options {
 public:
  explicit Options(std::string text) : text_(std::move(text)) {
    require(PetscOptionsInsertString(nullptr, text_.c_str()));
  }
  ~Options() {
    std::istringstream words(text_);
    for (std::string word; words >> word;)
      if (word[0] == '-' && word != "-2") static_cast<void>(PetscOptionsClearValue(nullptr, word.c_str()));
  }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

 private:
  std::string text_;
};

double energy_with(const par::Comm& comm, const std::string& text) {
  const Options options(text);
  try {
    Solved solved(comm, test::kuhn_cube(comm, 3), plate);
    EXPECT_TRUE(solved.solution.converged) << text << ": " << solved.solution.reason;
    const auto w = solved.system.solve_linearised(std::vector<double>(solved.domain.point.size(), 1), {});
    for (const auto value : w) EXPECT_TRUE(std::isfinite(value)) << text;
    return solved.system.gradient_energy(solved.solution.u);
  } catch (const std::exception& e) {
    ADD_FAILURE() << text << ": " << e.what();
  }
  return 0;
}

/// What an option needs to have an effect, or to work.
std::string before(const std::string& name, const std::string& word) {
  if (name == "-ksp_norm_type" && word == "natural") return "-ksp_type cg ";
  if (name == "-ksp_pc_side")
    return word == "left" ? "-ksp_type gmres -ksp_norm_type preconditioned " : "-ksp_type gmres ";
  if (name.rfind("-pc_factor", 0) == 0) return "-pc_type bjacobi -sub_pc_type cholesky ";
  if (name.rfind("-pc_hypre", 0) == 0) return "-pc_type hypre ";
  if (name.rfind("-pc_gamg", 0) == 0 || name.rfind("-pc_mg", 0) == 0) return "-pc_type gamg ";
  return "";
}

TEST(PetscWords, AllSolveOneProblemAlike) {
  par::Comm comm(MPI_COMM_WORLD);
  const double expected = energy_with(comm, "");
  for (const auto& name : petsc_option_names()) {
    const bool is_again =
        name.find("relax_type_down") != std::string::npos || name.find("relax_type_up") != std::string::npos;
    if (is_again && comm.size() > 1) continue;  // the words of relax_type_all, to save time
    for (const auto& word : petsc_words(name)) {
      const auto option = name.rfind("-pc_factor", 0) == 0 ? "-sub_" + name.substr(1) : name;
      const auto text = before(name, word) + option + " " + word;
      EXPECT_EQ(check_petsc_options(text).refused, "") << text;
      EXPECT_NEAR(energy_with(comm, text), expected, 1e-7 * expected) << text;
    }
  }
}

TEST(PetscWords, OfInnerSolversSolveTheProblemToo) {
  par::Comm comm(MPI_COMM_WORLD);
  const double expected = energy_with(comm, "");
  for (const std::string prefix : {"-sub_", "-mg_levels_", "-mg_coarse_"})
    for (const std::string option : {"ksp_type", "pc_type"})
      for (const auto& word : petsc_words(prefix + option)) {
        const bool is_serial = word == "ilu" || word == "icc";  // Error on several ranks
        if (is_serial && prefix != "-sub_" && comm.size() > 1) continue;
        if (prefix + word == "-mg_coarse_chebyshev") continue;  // does not converge
        const auto text = std::string("-ksp_type fgmres -pc_type ") + (prefix == "-sub_" ? "bjacobi " : "gamg ") +
                          prefix + option + " " + word;
        EXPECT_NEAR(energy_with(comm, text), expected, 1e-7 * expected) << text;
      }
}

TEST(PetscWords, WithOtherGroundsToStopDoNotPassAsConverged) {
  par::Comm comm(MPI_COMM_WORLD);
  const Options options("-snes_type ksponly");
  const Solved solved(comm, test::kuhn_cube(comm, 3), plate);

  EXPECT_FALSE(solved.solution.converged);
  EXPECT_NE(solved.solution.reason.find("above the tolerance"), std::string::npos) << solved.solution.reason;
}

TEST(PetscWords, ThatDoNotSolveALinearSystemGiveNoSolution) {
  par::Comm comm(MPI_COMM_WORLD);
  const Options options("-ksp_type cgs");  // good for Newton's method, but this one diverges
  Solved solved(comm, test::kuhn_cube(comm, 3), plate);
  ASSERT_TRUE(solved.solution.converged);
  const std::vector<double> load(solved.domain.point.size(), 1);
  EXPECT_THROW(solved.system.solve_linearised(load, {}), std::runtime_error);
}

}  // namespace petsc_words_test
}  // namespace pamr::poisson_boltzmann
