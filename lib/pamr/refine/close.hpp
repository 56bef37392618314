// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::refine {

/// Marks every edge that has to be split so that each flagged cell becomes eight (a flagged closure cell under
/// `removable`: its parent) and no hanging node is left: the least fixed point of the rules "these marks, then that
/// mark", the same whatever the order, the partition and the number of ranks.
///
/// `flags`: n_cells, nonzero: split. Marks live on edges that exist: in a family that is taken back, the only marks
/// deeper than the parent's edges lie on halves and sides that its members already have, because they come from cells
/// that exist; so two generations of splits suffice and each is decided here before anything is split.
/// Families that cannot be taken back are kept, and those that share half a face with them: before anything is marked,
/// those of which a half face is a face of a cell of no whole family; then, marking again from the start, those that
/// are hit and whose parent would have an inverted child.
/// Collective: k rounds of one neighbor exchange and one reduction. Cost: one ring walk for each marked edge that is
/// not wholly inside flagged cells. Source: ALUGrid and Omega_h do the same with stored edges; least fixed point after
/// R. E. Bank, A. H. Sherman, A. Weiser, "Refinement algorithms and data structures for regular local mesh
/// refinement", 1983 (green closure taken back).
Closure close(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
              std::span<const std::uint8_t> flags, QualityControl policy);

}  // namespace pamr::refine
