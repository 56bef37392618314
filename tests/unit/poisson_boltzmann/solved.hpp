// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "solvers/poisson_boltzmann/fem/sheets.hpp"
#include "solvers/poisson_boltzmann/goals/analysis.hpp"
#include "solvers/poisson_boltzmann/problem/case_names.hpp"
#include "support/meshes.hpp"

namespace pamr::poisson_boltzmann {

/// A case solved on a mesh, with all that its parts refer to.
class Solved {
 public:
  Solved(const par::Comm& comm, mesh::BlockMesh block, const std::string& case_text)
      : Solved(comm, assemble::assemble(comm, std::move(block)), case_text) {}
  Solved(const par::Comm& comm, mesh::DistMesh given, const std::string& case_text)
      : mesh(std::move(given)),
        input(with_sheets(comm, resolve_names(read_case(case_text, "case"), mesh.info.patches, "case"), mesh, "case")),
        domain(make_domain(comm, mesh, input, "case")),
        conditions(make_conditions(comm, domain, input)),
        problem(domain, input, conditions),
        system(comm, problem) {
    solution = system.solve({}, [](const NewtonStep&) {});
  }
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;
  Solved(Solved&&) = delete;
  Solved& operator=(Solved&&) = delete;
  ~Solved() = default;

  Analysis analysis(const par::Comm& comm) { return analyze(comm, problem, system, solution, 1e8); }

  mesh::DistMesh mesh;
  Case input;
  Domain domain;
  Conditions conditions;
  Problem problem;
  System system;
  Solution solution;
};

/// Tables [boundary.X] for the six sides of the unit cube: the same text for all, but for `special`.
inline std::string cube_boundary(const std::string& all, const std::string& special_patch = "",
                                 const std::string& special = "") {
  std::string text;
  for (const std::string patch : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    text += "[boundary." + patch + "]\n" + (patch == special_patch ? special : all) + "\n";
  return text;
}

}  // namespace pamr::poisson_boltzmann
