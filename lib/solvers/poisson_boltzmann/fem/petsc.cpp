// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/petsc.hpp"

#include <array>
#include <cstdlib>
#include <stdexcept>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// What PETSc said of the last error; PETSc is one per process, and so is this.
std::string& last_message() {
  static std::string message;
  return message;
}

/// The user's, for messages: of the case, the command line and the environment.
std::string& options_of_user() {
  static std::string options;
  return options;
}

std::string with_environment(const std::string& options) {
  const char* more = std::getenv("PETSC_OPTIONS");
  const auto all = (more == nullptr ? "" : std::string(more) + " ") + options;
  const auto begin = all.find_first_not_of(' ');
  return begin == std::string::npos ? "" : all.substr(begin, all.find_last_not_of(' ') + 1 - begin);
}

PetscErrorCode remember(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                        const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL && message != nullptr) last_message() = message;
  return code;
}

std::string message_of(PetscErrorCode code) {
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  std::string message = text == nullptr ? "error " + std::to_string(code) : text;
  if (!last_message().empty()) message += ": " + last_message();
  return message;
}

}  // namespace

void require(PetscErrorCode code) {
  if (code != 0) throw std::runtime_error("PETSc: " + message_of(code));
}

void require_options(PetscErrorCode code) {
  if (code != 0) throw Error("expected options that PETSc can use, found: " + message_of(code));
}

void require_solve(PetscErrorCode code) {
  if (code != 0) refuse_solver_options("PETSc says " + message_of(code));
}

void refuse_solver_options(const std::string& found) {
  if (options_of_user().empty()) throw std::runtime_error(found);
  throw Error("expected options for PETSc that work here, found \"" + options_of_user() + "\": " + found);
}

PetscRuntime::PetscRuntime(const par::Comm& comm, const std::string& options) {
  PETSC_COMM_WORLD = comm.handle();
  options_of_user() = with_environment(options);
  PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");  // may be called before PETSc starts
  // PETSc looks for this one among arguments only, and keeps them.
  static std::array<char, 8> program{"pamr-pb"};
  static std::array<char, 14> no_files{"-skip_petscrc"};
  static std::array<char*, 3> arguments{program.data(), no_files.data(), nullptr};
  static int n_arguments = 2;
  static char** first_argument = arguments.data();
  if (const auto code = PetscInitialize(&n_arguments, &first_argument, nullptr, nullptr); code != 0)
    throw std::runtime_error("PETSc cannot start, error " + std::to_string(code));
  require(PetscPushErrorHandler(remember, nullptr));
  const auto code = PetscOptionsInsertString(nullptr, options.c_str());
  if (code != 0) {
    const auto message = message_of(code);
    PetscFinalize();
    throw Error("expected options for PETSc, found \"" + options + "\": " + message);
  }
}

PetscRuntime::~PetscRuntime() {
  PetscOptionsSetValue(nullptr, "-options_left", "no");
  PetscFinalize();
}

std::vector<std::string> PetscRuntime::unused_options() const {
  PetscInt n = 0;
  char **names = nullptr, **values = nullptr;
  require(PetscOptionsLeftGet(nullptr, &n, &names, &values));
  std::vector<std::string> result;
  for (PetscInt i = 0; i < n; ++i) result.push_back(std::string("-") + names[i]);
  require(PetscOptionsLeftRestore(nullptr, &n, &names, &values));
  return result;
}

Entries::Entries(Vec vector) : vector_(vector) { require(VecGetArray(vector_, &value_)); }
Entries::~Entries() { VecRestoreArray(vector_, &value_); }
ConstEntries::ConstEntries(Vec vector) : vector_(vector) { require(VecGetArrayRead(vector_, &value_)); }
ConstEntries::~ConstEntries() { VecRestoreArrayRead(vector_, &value_); }

}  // namespace pamr::poisson_boltzmann
