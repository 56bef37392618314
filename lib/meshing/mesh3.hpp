// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {

/// CGAL's mesher fails, or finds no end; it often does not with sizes that are a little different.
class MesherFailure : public Error {
 public:
  using Error::Error;
};

/// How long a mesher may go on, and who hears of it.
struct Mesh3Watch {
  /// So many nodes may come, and 100 times those that the sizes explain, before the mesher is taken to find no end; a
  /// million only where these explain less than half of it.
  std::int64_t spare_nodes = 100'000;
  /// Gets the nodes so far and about how many the sizes ask for, from 1000 nodes on, at each quarter more.
  std::function<void(std::int64_t nodes, std::int64_t expected)> progress = [](std::int64_t, std::int64_t) {};
  /// Gets a sentence once this process has been busy for so many seconds in one `run_mesh3`: what takes the time.
  double slow_after = 15;
  std::function<void(const std::string& why)> slow = [](const std::string&) {};
};

/// Meshes a domain with CGAL's Delaunay refinement: feature curves protected by balls, boundary faces and those between
/// regions labelled by the piece they lie on, slivers perturbed and exuded. Boundary nodes lie on their pieces only to
/// within 1e-6 of the domain's radius. Local. Throws `Error` when the sizes are too coarse for the domain: a boundary
/// face on no piece, a border between pieces off the feature curves, a node that two pieces share off them;
/// `MesherFailure` where CGAL fails or finds no end: more nodes than the sizes can explain, or no new one for a million
/// questions about the domain and 5000 for each node. The same domain and seed give the same bits. Source: C. Jamin, P.
/// Alliez, M. Yvinec, J.-D. Boissonnat, "CGALmesh: a generic framework for Delaunay mesh generation", ACM TOMS 41
/// (2015).
RawMesh run_mesh3(const Domain& domain, unsigned seed, const Mesh3Watch& watch = {});

}  // namespace pamr::meshing
