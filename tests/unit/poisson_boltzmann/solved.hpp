// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "solvers/poisson_boltzmann/goals/analysis.hpp"
#include "support/meshes.hpp"

namespace pamr::poisson_boltzmann {

/// A case solved on a mesh, with all that its parts refer to.
class Solved {
 public:
  Solved(const par::Comm& comm, mesh::BlockMesh block, const std::string& case_text)
      : input(read_case(case_text, "case")),
        mesh(assemble::assemble(comm, std::move(block))),
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

  Case input;
  mesh::DistMesh mesh;
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
