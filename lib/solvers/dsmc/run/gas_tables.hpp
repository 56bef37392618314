// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/base/toml_table.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"

namespace pamr::dsmc {

/// The gas of [gas] and [species] in a case file; more species may come from a file beside the case, which `where`
/// names. Throws `Error` with file and line. Local.
Gas read_gas(const TomlTable& file, const std::string& where);

/// [stream], the free stream first. Throws `Error` when there is none. Local.
std::vector<Stream> read_streams(const TomlTable& streams, const Gas& gas);

/// [particles.species_weights], into `gas`. Local.
void read_species_weights(const TomlTable& weights, Gas& gas);

}  // namespace pamr::dsmc
