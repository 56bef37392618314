// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pamr::poisson_boltzmann {

/// Options for PETSc as a case file may give them. A case is data that others have made: it chooses solvers and their
/// numbers, and nothing in it makes PETSc read, write or run a file, or print.
struct CasePetscOptions {
  std::string text;      ///< the options with one blank between words, as they were checked
  std::string refused;   ///< the first option, or option and value, that a case may not give; empty if there is none
  std::string expected;  ///< in its place, for messages
};
CasePetscOptions check_petsc_options(std::string_view text);

/// The first word that is neither an option nor the value of one, which PETSc passes over in silence; empty if there is
/// none.
std::string find_stray_word(std::string_view text);

/// The options that pass, and the words that one of them may have as values (empty where these are numbers).
std::vector<std::string> petsc_option_names();
std::vector<std::string> petsc_words(const std::string& option);

}  // namespace pamr::poisson_boltzmann
