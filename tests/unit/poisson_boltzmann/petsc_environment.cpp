// SPDX-License-Identifier: GPL-3.0-or-later
/// PETSc runs from before the first test to after the last.
#include <gtest/gtest.h>

#include <memory>

#include "solvers/poisson_boltzmann/fem/petsc.hpp"

namespace pamr::poisson_boltzmann {
namespace {

class PetscEnvironment : public testing::Environment {
 public:
  void SetUp() override {
    comm_ = std::make_unique<par::Comm>(MPI_COMM_WORLD);
    petsc_ = std::make_unique<PetscRuntime>(*comm_, "");
  }
  void TearDown() override {
    petsc_.reset();
    comm_.reset();
  }

 private:
  std::unique_ptr<par::Comm> comm_;
  std::unique_ptr<PetscRuntime> petsc_;
};

[[maybe_unused]] const auto* registered = testing::AddGlobalTestEnvironment(new PetscEnvironment);

}  // namespace
}  // namespace pamr::poisson_boltzmann
