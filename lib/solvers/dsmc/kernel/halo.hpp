// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

/// Layers of cells around a rank's own. A particle that leaves the rank flies on through them; with three almost all
/// come to rest there, so that it is delivered once, and not from border to border.
constexpr int halo_layers = 3;

/// Adds the halo to a domain with its time steps and periodic patches: of the cells of other ranks that are up to
/// `layers` faces away what particles need to fly through them, of those one face further their ranks only. Links to
/// faces of the rank border become links to cells of the halo.
///
/// Collective: an exchange between neighbors and two sparse ones for each layer; nothing on one rank. O(cells of the
/// halo log) time, 152 bytes for each.
void add_halo(const par::Comm& comm, GasDomain& domain, int layers = halo_layers);

}  // namespace pamr::dsmc
