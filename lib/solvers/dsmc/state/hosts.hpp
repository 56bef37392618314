// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

/// A new cell from whose center the particles of an old cell set out for their places. `cell` -1: none is known yet.
struct Host {
  GlobalId cell = -1;  ///< counted from the mesh's first
  Rank rank = -1;
  double volume = 0;  ///< m3, of all new cells whose parent the old cell is
};

/// An old cell that is nobody's parent because it was coarsened, and an old cell that is the parent of the new cell
/// there; both counted from the mesh's first.
struct GoneCell {
  GlobalId number = 0, into = 0;
};

/// The host of each old cell of this rank's block (`par::block_range` of `n_old`): of the new cells whose parent it is
/// the one with the smallest number. `parent`: of each new cell of this rank. Collective: one sparse exchange.
std::vector<Host> find_hosts(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& parent,
                             GlobalId n_old, double unit);

/// Gives old cells that are gone the host of the cell that has their place; their volume stays 0. Any rank may name any
/// of them. Collective: four sparse exchanges.
void add_hosts_of_gone(const par::Comm& comm, std::span<const GoneCell> gone, GlobalId n_old, std::vector<Host>& hosts);

/// Gives every old cell that has none the host of the hosted cell before it, or of the first one; their volume stays 0.
/// The search from there is longer. Collective: four small gathers.
void fill_gaps(const par::Comm& comm, std::vector<Host>& hosts);

/// Throws `Error` on every rank when the new cells of the old ones have other volumes: in a mesh that was not refined
/// from the old one the same numbers belong to other cells. Collective: one reduction.
void require_old_volumes(const par::Comm& comm, const std::string& file, const Section& old_cells,
                         const std::vector<Host>& hosts);

}  // namespace pamr::dsmc
