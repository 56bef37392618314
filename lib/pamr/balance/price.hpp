// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/balance/partition.hpp"
#include "pamr/balance/quality.hpp"
#include "pamr/base/types.hpp"

/// When a distribution of cells is good enough, and what another one would cost and save.
namespace pamr::balance {

/// How many cells, in how many parts.
struct Size {
  GlobalId n_cells = 0;
  Rank n_parts = 1;
};

/// Within `keep_below` and `max_cut` of the options; runs of cells in global order are asked for the first alone. Local.
bool meets(const Quality& quality, const Options& options);

/// What one pass over the mesh, which is as much work as refining it, costs the rank that has most: its cells, and one
/// cell more for each of its faces between ranks (of which it has the mean). Local.
double work_of_pass(const Quality& quality, Size size);

/// What Scotch and then all passes on its parts are expected to cost, in cells: 200 for each vertex of a rank, and
/// parts as even as it is asked for and as compact as `faces_between_compact_parts` says. Local.
double work_with_scotch(Size size, const Options& options);

/// Whether cells shall move for the new distribution: it meets what the old one does not, or a pass costs it at least
/// a hundredth less. So no call moves cells for nothing where nothing better can be reached. Local.
bool is_gain(const Quality& before, const Quality& after, Size size, const Options& options);

}  // namespace pamr::balance
