// SPDX-License-Identifier: GPL-3.0-or-later
// In place of scotch_partition.cpp in builds without PT-Scotch.
#include "pamr/balance/scotch_partition.hpp"
#include "pamr/base/error.hpp"

namespace pamr::balance {

bool has_scotch() { return false; }

std::vector<Rank> scotch_partition(const par::Comm&, const DualGraph&, Rank, double) {
  throw Error("partition: expected a build with PT-Scotch, found one without");
}

}  // namespace pamr::balance
