// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/assemble/check_block.hpp"
#include "pamr/order/hilbert.hpp"
#include "pamr/order/order_along_curve.hpp"

namespace pamr::order {

/// Orders a mesh over all ranks. Collective.
Ordered order_over_ranks(const par::Comm& comm, mesh::BlockMesh block, const CurveGrid& grid,
                         const assemble::Contents& contents);

}  // namespace pamr::order
