// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pamr::poisson_boltzmann {

/// Options for PETSc as a case file may give them. A case is data that others have made: it chooses solvers and their
/// numbers, and nothing in it makes PETSc read, write or run a file, or print.
struct CasePetscOptions {
  std::string text;     ///< the options with one blank between words, as they were checked
  std::string refused;  ///< the first option, or option and value, that a case may not give; empty if there is none
};
CasePetscOptions check_petsc_options(std::string_view text);

/// The options that pass, for messages.
std::string allowed_petsc_options();

}  // namespace pamr::poisson_boltzmann
