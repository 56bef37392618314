// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/state/hosts.hpp"

namespace pamr::dsmc {

/// A mesh that was adapted to the flow on it.
struct Adapted {
  mesh::DistMesh mesh;         ///< with the field `parent`
  std::vector<GoneCell> gone;  ///< cells of the old mesh that are nobody's parent
  std::int64_t cells_marked = 0;
  std::int64_t octets_gone = 0;
};

/// Marks cells by the criteria of the case, as pamr-mark does, and refines and coarsens them, as pamr-refine does.
/// `averages`: cell fields for the criteria, which count before fields of these names in the mesh. Other fields come
/// along. Cells stay on their ranks but for siblings that are gathered. Collective. Throws the same `Error` on every
/// rank for criteria that do not suit, with `where` before it.
Adapted adapt_mesh(const par::Comm& comm, mesh::DistMesh mesh, const Adaptation& how,
                   std::vector<mesh::CellField> averages, const std::string& where);

/// Throws the same `Error` on every rank unless the mesh and `averages` have the fields and patches that the criteria
/// need. The mesh is the same afterwards. Collective.
void require_criteria(const par::Comm& comm, mesh::DistMesh& mesh, const Adaptation& how,
                      std::vector<mesh::CellField> averages, const std::string& where);

}  // namespace pamr::dsmc
