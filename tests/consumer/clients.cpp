// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <meshing/mesh_case.hpp>
#include <solvers/dsmc/gas/kinetic_theory.hpp>

int main() {
  const auto mesh_case = pamr::meshing::case_of_shape("sphere-in-box", 0.5);
  std::printf("%s: flux factor at speed ratio 5: %.3f\n", pamr::meshing::describe(mesh_case).c_str(),
              pamr::dsmc::flux_factor(5));
}
