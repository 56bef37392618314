// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/petsc_options.hpp"

#include <algorithm>
#include <array>
#include <sstream>

namespace pamr::poisson_boltzmann {

namespace {

/// Solvers within solvers: what follows is an option of theirs.
constexpr std::array<std::string_view, 3> inner_solvers{"-mg_levels_", "-mg_coarse_", "-sub_"};

/// None of these is a monitor or a viewer, whose values name files, pipes and sockets. A star stands for letters,
/// digits and underscores, without what prints and the smoothers that are preconditioners (`is_allowed_value`).
constexpr const char* allowed =
    "-ksp_type -ksp_rtol -ksp_atol -ksp_divtol -ksp_max_it -ksp_norm_type -ksp_pc_side -ksp_gmres_restart "
    "-ksp_cg_single_reduction -snes_type -snes_rtol -snes_atol -snes_stol -snes_max_it -snes_lag_preconditioner "
    "-snes_lag_jacobian -snes_ksp_ew* -snes_linesearch_type -snes_linesearch_order -pc_type -pc_sor_omega "
    "-pc_sor_its -pc_sor_lits -pc_sor_symmetric -pc_asm_overlap -pc_factor_levels -pc_factor_shift_type "
    "-pc_factor_mat_ordering_type -pc_factor_mat_solver_type -pc_hypre_type -pc_hypre_boomeramg_* -pc_gamg_type "
    "-pc_gamg_threshold -pc_gamg_agg_nsmooths -pc_mg_levels -pc_mg_cycle_type";

bool consists_of(std::string_view word, std::string_view more) {
  return std::all_of(word.begin(), word.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           more.find(c) != std::string_view::npos;
  });
}

/// PETSc takes "-2" as a value.
bool is_option(const std::string& word) {
  return word[0] == '-' && (word.size() == 1 || !(word[1] == '.' || (word[1] >= '0' && word[1] <= '9')));
}

/// The option without the solvers that it lies in: "-ksp_type" for "-mg_levels_2_ksp_type".
std::string innermost(std::string name) {
  for (bool is_inner = true; is_inner;) {
    is_inner = false;
    for (const auto& prefix : inner_solvers) {
      if (name.rfind(prefix, 0) != 0) continue;
      auto rest = name.substr(prefix.size());
      const auto level = rest.find_first_not_of("0123456789");
      if (level != 0 && level != std::string::npos && rest[level] == '_') rest.erase(0, level + 1);
      name = "-" + rest;
      is_inner = true;
    }
  }
  return name;
}

bool is_allowed_name(const std::string& name) {
  std::istringstream names(allowed);
  for (std::string known; names >> known;) {
    if (known.back() != '*') {
      if (name == known) return true;
      continue;
    }
    known.pop_back();
    if (name.rfind(known, 0) == 0 && consists_of(name.substr(known.size()), "_") &&
        name.find("print") == std::string::npos && name.find("smooth") == std::string::npos)
      return true;
  }
  return false;
}

/// Numbers and words. Names of smoothers have a slash; hypre's other preconditioners read a file of settings where they
/// find one.
bool is_allowed_value(const std::string& name, const std::string& value) {
  if (name == "-pc_hypre_type") return value == "boomeramg";
  return consists_of(value, name.find("_relax_type_") == std::string::npos ? "_.,+-" : "_.,+-/");
}

}  // namespace

CasePetscOptions check_petsc_options(std::string_view text) {
  CasePetscOptions result;
  std::istringstream words{std::string(text)};
  std::string name;
  for (std::string word; result.refused.empty() && words >> word;) {
    if (is_option(word)) {
      name = innermost(word);
      if (!is_allowed_name(name)) result.refused = word;
    } else if (name.empty() || !is_allowed_value(name, word)) {
      result.refused = name.empty() ? word : name + " " + word;
    }
    result.text += (result.text.empty() ? "" : " ") + word;
  }
  return result;
}

std::string allowed_petsc_options() {
  std::string result = allowed;
  result += " and these after";
  for (const auto& prefix : inner_solvers) result.append(" ").append(prefix);
  return result;
}

}  // namespace pamr::poisson_boltzmann
