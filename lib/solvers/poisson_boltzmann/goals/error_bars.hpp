// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/goals/electrodes.hpp"
#include "solvers/poisson_boltzmann/goals/layer.hpp"

namespace pamr::poisson_boltzmann {

/// Heights of cells over the thickness of the layer up to which bars of first order hold where a charge is computed or
/// given: docs/tools/pamr-pb.md has the measurement.
inline constexpr double largest_ratio_of_charge_bar = 0.2;

/// Patches of a given potential or charge, or mirrors, that have no surface and are not flat (one entry for each
/// patch): their facets may stand for a curved wall, and nothing says how far that is. All false of first order.
/// Collective.
std::vector<bool> find_facets(const par::Comm& comm, const Problem& problem);

/// Why a goal has no error bar, for the user (empty if it has one), and whether its correction is nevertheless the best
/// that is known.
struct NoErrorBar {
  std::string reason;
  bool is_corrected = true;
};

/// Why the error bar of a goal means nothing. Local.
/// - The potential jumps where patches meet, and the goal has no limit.
/// - Second order: a patch is one of `has_facets`.
/// - First order: the cells are too high for a layer, or a force of the volume form is computed with Gauss points.
/// - A sheet inside ends in the liquid, or its shape, or with first order the force on it, is not in the bar.
/// The correction does not hold where there is no limit, nor, of first order, where a sheet ends, where it is pushed or
/// where it meets the mid-plane: it rests on recovered gradients that are better than those of the cells, and next to a
/// sheet they are means of one side only, which a net force takes the difference of. The value itself converges there
/// with second order.
NoErrorBar why_no_error_bar(const Problem& problem, const std::vector<Electrode>& electrodes, const Layers& layers,
                            const std::vector<bool>& has_facets, const Goal& goal);

/// A sentence for the user on an error that no bar of the case contains: walls with the profile of the plate while there
/// are other bodies; else empty. Local.
std::string beyond_error_bars(const Case& input);

}  // namespace pamr::poisson_boltzmann
