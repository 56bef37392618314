// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/adapt/pass.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// Look-ahead splits: families that have to be split before the rest of the mesh is (docs/closure.md) are split,
/// pass by pass, until there are none. The closure then has its states, and its depth is checked. Without such families
/// nothing changes. The new mesh knows the input cells by `cell_origin`, see `origins_of_pass`.
///
/// The passes work on the cells near the families, a part of the mesh that grows where something would reach its end,
/// and which is put back once, after the last. The rare passes that may reach anywhere have the whole mesh: those that
/// meet nodes off their surfaces or families that have to be kept.
/// Collective. Cost: what the part costs in each pass, and one pass over the arrays of the mesh; of a mesh that is lent
/// a copy.
Closed split_early(const par::Comm& comm, Closed closed, const refine::Options& options, StepTimer& timer);

}  // namespace pamr::adapt
