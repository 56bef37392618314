// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/sampling/loads.hpp"

namespace pamr::dsmc {

/// Coefficients of the reference body if it were convex and alone in the free stream, integrated over its faces.
struct BodyLaws {
  std::optional<Coefficients> free_molecular;  ///< with the walls of the case; none beside `moving_wall`
  Coefficients newtonian;
  std::string moving_wall;  ///< why there is no `free_molecular`: the patch that moves out of its plane
};

/// The last of these patches whose velocity leads out of a face by more than `allowed` of it; -1: none. Collective.
std::int64_t patch_that_leaves_its_plane(const par::Comm& comm, const std::vector<BoundaryFace>& faces,
                                         const std::vector<BoundaryCondition>& conditions,
                                         const std::vector<bool>& among, double allowed);

/// Whether there is a body, a stream and its speed. Local.
bool has_body(const Case& the_case, const Setup& setup, const std::vector<mesh::Patch>& patches);

/// Of these faces, which are those of the boundary or lie on its surfaces. Collective.
BodyLaws body_laws(const par::Comm& comm, const Case& the_case, const Setup& setup,
                   const std::vector<mesh::Patch>& patches, const std::vector<BoundaryFace>& faces);

/// How much flat faces of the body may change its coefficients: the difference of both laws between them and the
/// surfaces that the patches lie on, the larger of both; 0 for patches without a surface, and for heat by
/// free-molecular flow alone. `boundary`: the faces of the mesh.
/// Throws `Error` where the surfaces were not made (`io::ReadOptions::build_surfaces`). Collective.
Coefficients error_of_facets(const par::Comm& comm, const Case& the_case, const Setup& setup,
                             const mesh::DistMesh& mesh, const std::vector<BoundaryFace>& boundary);

}  // namespace pamr::dsmc
