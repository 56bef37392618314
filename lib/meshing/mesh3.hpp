// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// Meshes a domain with CGAL's Delaunay refinement: feature curves protected by balls, boundary faces labelled by the
/// piece they lie on, slivers perturbed and exuded. Boundary nodes lie on their pieces only to within 1e-6 of the
/// domain's radius. Local. Throws `Error` when the sizes are too coarse for the domain: a boundary face on no piece, a
/// border between pieces off the feature curves, a node that two pieces share off them. The same domain and seed give
/// the same bits. Source: C. Jamin, P. Alliez, M. Yvinec, J.-D. Boissonnat, "CGALmesh: a generic framework for
/// Delaunay mesh generation", ACM TOMS 41 (2015).
RawMesh run_mesh3(const Domain& domain, unsigned seed);

}  // namespace pamr::meshing
