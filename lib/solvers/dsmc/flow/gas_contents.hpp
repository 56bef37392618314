// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/sampling/gas_balance.hpp"

namespace pamr::dsmc {

/// All that is in the gas now, in fixed point, so that it does not depend on the ranks. Collective: one reduction.
GasContents contents_of(const Flow& flow);

/// Fluxes through patches and planes since the end of the last interval, over all ranks: the words of `FluxTally`,
/// exact. Collective: one reduction.
std::vector<std::int64_t> total_fluxes(const par::Comm& comm, const FluxTally& flux);

/// Temperatures of all particles together, about their mean velocity, K.
struct Temperatures {
  double translational = 0, rotational = 0;
  std::optional<double> vibrational;  ///< none: nothing vibrates
};
/// Local.
Temperatures temperatures_of(const GasContents& contents, const Flow& flow);

}  // namespace pamr::dsmc
