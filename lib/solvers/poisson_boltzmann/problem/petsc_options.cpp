// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/petsc_options.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

namespace pamr::poisson_boltzmann {

namespace {

/// Solvers within solvers: what follows is an option of theirs.
constexpr std::array<std::string_view, 3> inner_solvers{"-mg_levels_", "-mg_coarse_", "-sub_"};

constexpr std::string_view number = "number", flag = "flag";

/// Values are words, "number" (not below 0), "flag" (or nothing), or "LOW..HIGH" for integers.
struct Allowed {
  std::string_view name, values;
  std::string_view inner = {};  ///< the same for an inner solver, where there are others; "-": none
};

constexpr std::string_view smoothers =
    "Jacobi SOR/Jacobi backward-SOR/Jacobi symmetric-SOR/Jacobi l1scaled-SOR/Jacobi l1-Gauss-Seidel "
    "backward-l1-Gauss-Seidel Chebyshev l1scaled-Jacobi";

/// None of these is a monitor or a viewer, whose values name files, pipes and sockets. Every word has been run on one
/// rank and on several; PETSc has others that stop or crash here. `System` sets tolerances of its own over -snes_*.
constexpr std::array allowed{
    Allowed{"-ksp_type", "cg groppcg pipecg fcg gmres fgmres lgmres gcr bcgs fbcgs ibcgs tfqmr",
            "richardson chebyshev"},
    Allowed{"-ksp_rtol", number},
    Allowed{"-ksp_atol", number},
    Allowed{"-ksp_divtol", number},
    Allowed{"-ksp_max_it", "1..1000000"},
    Allowed{"-ksp_norm_type", "preconditioned unpreconditioned natural", "none"},
    Allowed{"-ksp_pc_side", "left right"},
    Allowed{"-ksp_gmres_restart", "1..1000"},
    Allowed{"-ksp_cg_single_reduction", flag},
    Allowed{"-snes_type", "newtonls newtontr", "-"},
    Allowed{"-snes_lag_preconditioner", "-2 1 2 3 4 5 10", "-"},
    Allowed{"-snes_lag_jacobian", "1 2 3 4 5 10", "-"},
    Allowed{"-snes_ksp_ew", flag, "-"},
    Allowed{"-snes_ksp_ew_version", "1 2 3", "-"},
    Allowed{"-snes_ksp_ew_rtol0", number, "-"},
    Allowed{"-snes_ksp_ew_rtolmax", number, "-"},
    Allowed{"-snes_ksp_ew_gamma", number, "-"},
    Allowed{"-snes_ksp_ew_alpha", number, "-"},
    Allowed{"-snes_ksp_ew_alpha2", number, "-"},
    Allowed{"-snes_ksp_ew_threshold", number, "-"},
    Allowed{"-snes_linesearch_type", "bt basic l2 cp nleqerr", "-"},
    Allowed{"-snes_linesearch_order", "1 2 3", "-"},
    Allowed{"-pc_type", "none jacobi pbjacobi bjacobi sor asm lu cholesky hypre gamg",
            "none jacobi pbjacobi bjacobi sor asm ilu icc lu cholesky"},
    Allowed{"-pc_sor_omega", number},
    Allowed{"-pc_sor_its", "1..1000"},
    Allowed{"-pc_sor_lits", "1..1000"},
    Allowed{"-pc_sor_symmetric", flag},
    Allowed{"-pc_asm_overlap", "0..1000"},
    Allowed{"-pc_factor_levels", "0..1000"},
    Allowed{"-pc_factor_shift_type", "none nonzero positive_definite inblocks"},
    Allowed{"-pc_factor_mat_ordering_type", "natural nd 1wd rcm qmd"},
    Allowed{"-pc_hypre_type", "boomeramg"},
    Allowed{"-pc_hypre_boomeramg_cycle_type", "V W"},
    Allowed{"-pc_hypre_boomeramg_max_levels", "2..1000"},
    Allowed{"-pc_hypre_boomeramg_max_iter", "1..1000"},
    Allowed{"-pc_hypre_boomeramg_strong_threshold", number},
    Allowed{"-pc_hypre_boomeramg_max_row_sum", number},
    Allowed{"-pc_hypre_boomeramg_truncfactor", number},
    Allowed{"-pc_hypre_boomeramg_P_max", "0..1000"},
    Allowed{"-pc_hypre_boomeramg_agg_nl", "0..1000"},
    Allowed{"-pc_hypre_boomeramg_agg_num_paths", "1..1000"},
    Allowed{"-pc_hypre_boomeramg_coarsen_type", "CLJP Ruge-Stueben Falgout PMIS HMIS"},
    Allowed{"-pc_hypre_boomeramg_interp_type", "classical direct multipass ext+i ext+i-cc standard FF FF1 ext"},
    Allowed{"-pc_hypre_boomeramg_relax_type_all", smoothers},
    Allowed{"-pc_hypre_boomeramg_relax_type_down", smoothers},
    Allowed{"-pc_hypre_boomeramg_relax_type_up", smoothers},
    Allowed{"-pc_hypre_boomeramg_relax_type_coarse", "Gaussian-elimination SOR/Jacobi symmetric-SOR/Jacobi"},
    Allowed{"-pc_hypre_boomeramg_relax_weight_all", number},
    Allowed{"-pc_hypre_boomeramg_outer_relax_weight_all", number},
    Allowed{"-pc_hypre_boomeramg_grid_sweeps_all", "1..1000"},
    Allowed{"-pc_hypre_boomeramg_grid_sweeps_down", "1..1000"},
    Allowed{"-pc_hypre_boomeramg_grid_sweeps_up", "1..1000"},
    Allowed{"-pc_hypre_boomeramg_no_CF", flag},
    Allowed{"-pc_gamg_type", "agg"},
    Allowed{"-pc_gamg_threshold", number},
    Allowed{"-pc_gamg_agg_nsmooths", "0..1000"},
    Allowed{"-pc_mg_cycle_type", "v w"},
};

struct Key {
  std::string_view option, key;
};
/// Options for which [solver] has a key, which counts.
constexpr std::array keys{Key{"-snes_rtol", "tolerance"}, Key{"-snes_atol", "tolerance"},
                          Key{"-snes_stol", "tolerance"}, Key{"-snes_max_it", "max_newton"}};

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::vector<std::string> result;
  for (std::string word; words >> word;) result.push_back(word);
  return result;
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

/// Empty: the option may not be given.
std::string_view values_of(const std::string& word) {
  const auto name = innermost(word);
  const auto* found = std::find_if(allowed.begin(), allowed.end(), [&](const Allowed& a) { return a.name == name; });
  if (found == allowed.end()) return {};
  if (name == word || found->inner.empty()) return found->values;
  return found->inner == "-" ? std::string_view{} : found->inner;
}

template <class T>
bool parse(std::string_view text, T& value) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc{} && end == text.data() + text.size();
}

bool is_allowed_value(std::string_view values, const std::string& word) {
  if (values == number) {
    double value = -1;
    return parse(word, value) && std::isfinite(value) && value >= 0;
  }
  if (values == flag) return is_allowed_value("0 1 true false yes no on off", word);
  if (const auto dots = values.find(".."); dots != std::string_view::npos) {
    int low = 0, high = 0, value = 0;
    return parse(values.substr(0, dots), low) && parse(values.substr(dots + 2), high) && parse(word, value) &&
           value >= low && value <= high;
  }
  const auto words = words_of(values);
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string allowed_names() {
  std::string result = "options for numbers and kinds of solvers (";
  for (const auto& a : allowed) result.append(a.name).append(" ");
  result += "and these after";
  for (const auto& prefix : inner_solvers) result.append(" ").append(prefix);
  return result + ")";
}

std::string expected_for(const std::string& option) {
  for (const auto& [name, key] : keys)
    if (option == name) return std::string(key) + " of [solver] in its place";
  const auto values = values_of(option);
  return values.empty() ? allowed_names() : option + " with a value of these: " + std::string(values);
}

}  // namespace

CasePetscOptions check_petsc_options(std::string_view text) {
  CasePetscOptions result;
  const auto words = words_of(text);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& name = words[i];
    const bool has_value = i + 1 < words.size() && !is_option(words[i + 1]);
    const auto values = is_option(name) ? values_of(name) : std::string_view{};
    const bool is_good = has_value ? is_allowed_value(values, words[i + 1]) : values == flag;
    if (!is_good) {
      const bool is_value = has_value && !values.empty();
      result.refused = is_value ? name + " " + words[i + 1] : name;
      result.expected = expected_for(name);
      return result;
    }
    result.text += (result.text.empty() ? "" : " ") + name;
    if (has_value) result.text += " " + words[++i];
  }
  return result;
}

std::string find_stray_word(std::string_view text) {
  bool may_be_value = false;
  for (const auto& word : words_of(text)) {
    if (!is_option(word) && !may_be_value) return word;
    may_be_value = is_option(word);
  }
  return {};
}

std::vector<std::string> petsc_words(const std::string& option) {
  const auto values = values_of(option);
  const bool is_words = values != number && values != flag && values.find("..") == std::string_view::npos;
  return is_words ? words_of(values) : std::vector<std::string>{};
}

std::vector<std::string> petsc_option_names() {
  std::vector<std::string> result;
  for (const auto& a : allowed) result.emplace_back(a.name);
  return result;
}

}  // namespace pamr::poisson_boltzmann
