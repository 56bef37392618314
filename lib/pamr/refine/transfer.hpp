// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::refine {

/// Carries fields to the children. Nodal fields: old values stay, a new node gets the mean of the ends of its edge
/// (P1); integers that of the end that comes first by coordinates. Cell fields: a child has its parent's value; the
/// children of a family that was taken back have the volume-weighted mean of its members (integers: the value of
/// `parent`). Adds the integer cell field `parent` if the options ask for it: the input cell that holds the new cell's
/// centroid while new nodes still lie on their edges, the smallest number among equals. Replaces the ledger field.
/// Drops the fields of marks and of origins. Local. Cost: O(children) for each field.
void transfer(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
              const Certificate& certificate, bool has_ledger, const Options& options, mesh::DistMesh& fine);

}  // namespace pamr::refine
