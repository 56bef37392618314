// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Cut faces: faces of members of whole families that are part of a face of the parent with one mark or two. Such a
/// face has to stay or to be taken back on both sides.
namespace pamr::refine {

/// First members, or any, of families that cannot be taken back because the cell behind one of their cut faces needs
/// it: that cell is of no whole family with this cut. So it is where families were split, under a policy that lets that
/// happen or because they were retained. Collective: one exchange of a byte a border face.
std::vector<LocalId> find_unpaired_families(const par::Comm& comm, const mesh::DistMesh& mesh,
                                            const mesh::Borders& borders);

/// Sets `retained` (n_cells, or empty: none yet) for the families of the given members and, one after another, for
/// those that share a cut face with a retained one. Collective: an exchange and a reduction a round.
void retain_families(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                     const std::vector<LocalId>& members, std::vector<std::uint8_t>& retained);

}  // namespace pamr::refine
