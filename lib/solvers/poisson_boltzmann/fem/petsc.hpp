// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <petscsnes.h>

#include <string>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::poisson_boltzmann {

/// PETSc from its start to its end; one object per process, inside the life of MPI. PETSc keeps its hands off signals
/// and prints no errors of its own.
class PetscRuntime {
 public:
  /// Starts PETSc on the processes of `comm` with options as on PETSc's command line; those of the environment
  /// variable PETSC_OPTIONS count too. Files of options (.petscrc, petscrc) are not read: a folder with data may have
  /// one. Collective. Throws `Error` when PETSc cannot read the options.
  PetscRuntime(const par::Comm& comm, const std::string& options);
  /// Collective.
  ~PetscRuntime();
  PetscRuntime(const PetscRuntime&) = delete;
  PetscRuntime& operator=(const PetscRuntime&) = delete;
  PetscRuntime(PetscRuntime&&) = delete;
  PetscRuntime& operator=(PetscRuntime&&) = delete;

  /// Options that nothing has asked for.
  std::vector<std::string> unused_options() const;
};

/// Throws `std::runtime_error` with PETSc's message unless `code` means success.
void require(PetscErrorCode code);
/// The same for calls that read the user's options: throws `Error`.
void require_options(PetscErrorCode code);
/// The same for solves: throws `Error` if the user has given options, which are what PETSc cannot do then.
void require_solve(PetscErrorCode code);
/// Throws `Error` if the user has given options, else `std::runtime_error`.
[[noreturn]] void refuse_solver_options(const std::string& found);

/// Owns one PETSc object.
template <class T, PetscErrorCode (*destroy)(T*)>
class Handle {
 public:
  Handle() = default;
  ~Handle() { static_cast<void>(destroy(&object_)); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : object_(other.object_) { other.object_ = nullptr; }
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }

  operator T() const { return object_; }
  T* address() { return &object_; }

 private:
  T object_ = nullptr;
};

using Vector = Handle<Vec, VecDestroy>;
using Matrix = Handle<Mat, MatDestroy>;
using NonlinearSolver = Handle<SNES, SNESDestroy>;
using LinearSolver = Handle<KSP, KSPDestroy>;

/// Entries of this rank, to be read or written while the object lives.
class Entries {
 public:
  explicit Entries(Vec vector);
  ~Entries();
  Entries(const Entries&) = delete;
  Entries& operator=(const Entries&) = delete;
  Entries(Entries&&) = delete;
  Entries& operator=(Entries&&) = delete;

  double& operator[](std::size_t i) { return value_[i]; }

 private:
  Vec vector_;
  PetscScalar* value_ = nullptr;
};

class ConstEntries {
 public:
  explicit ConstEntries(Vec vector);
  ~ConstEntries();
  ConstEntries(const ConstEntries&) = delete;
  ConstEntries& operator=(const ConstEntries&) = delete;
  ConstEntries(ConstEntries&&) = delete;
  ConstEntries& operator=(ConstEntries&&) = delete;

  double operator[](std::size_t i) const { return value_[i]; }

 private:
  Vec vector_;
  const PetscScalar* value_ = nullptr;
};

}  // namespace pamr::poisson_boltzmann
