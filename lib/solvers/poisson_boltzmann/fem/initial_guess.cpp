// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/initial_guess.hpp"

#include <fmt/format.h>

#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/mesh/require_field.hpp"
#include "solvers/poisson_boltzmann/problem/source_term.hpp"

namespace pamr::poisson_boltzmann {

std::vector<double> initial_guess(const par::Comm& comm, const mesh::DistMesh& mesh, const Conditions& conditions,
                                  const std::string& field, const std::string& where) {
  const auto& potential =
      mesh::require_node_field(mesh, {.name = field, .values = mesh::FieldValues::real, .used_for = where}).real();
  std::vector<double> u(potential.begin(), potential.end());
  bool is_bad = false;
  for (std::size_t i = 0; i < u.size(); ++i) {
    is_bad = is_bad || !std::isfinite(u[i]) || std::abs(u[i]) > largest_argument;
    u[i] -= conditions.psi0[i];
  }
  if (comm.any(is_bad))
    throw Error(fmt::format("{}: field \"{}\": expected potentials within {:g} kT/Ze, found others", where, field,
                            largest_argument));
  return u;
}

}  // namespace pamr::poisson_boltzmann
