// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/toml_table.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/gas/stream.hpp"

namespace pamr::dsmc {

/// What physical values a case may have: everything that is computed from them stays finite.
inline constexpr NumberRange temperatures{1e-3, 1e6};  ///< K
inline constexpr NumberRange speeds{1e-3, 1e6};        ///< m/s, of what is not at rest
inline constexpr double max_place = 1e12;              ///< m, of a coordinate

/// A number that is 0 or in the range. Throws `Error` with file and line. Local.
double number_or_none(const TomlTable& table, std::string_view key, NumberRange range);
/// A velocity that is 0 or in the range of `speeds`. Throws `Error` with file and line. Local.
Vec3 read_velocity(const TomlTable& table, std::string_view key);
/// A point of space. Throws `Error` with file and line. Local.
Vec3 read_place(const TomlTable& table, std::string_view key);

/// The gas of [gas] and [species] in a case file. Species that it does not describe come from a file beside the case, which
/// `where` names, and else from `known_gases`. Without fractions it is the air of [stream.free], if that has an altitude.
/// Throws `Error` with file and line. Local.
Gas read_gas(const TomlTable& file, const std::string& where);

/// [stream], the free stream first. Throws `Error` when there is none. Local.
std::vector<Stream> read_streams(const TomlTable& streams, const Gas& gas);

/// [particles.species_weights], into `gas`. Local.
void read_species_weights(const TomlTable& weights, Gas& gas);

}  // namespace pamr::dsmc
