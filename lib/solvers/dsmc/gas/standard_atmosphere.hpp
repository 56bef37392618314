// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>

#include "pamr/base/toml_table.hpp"

namespace pamr::dsmc {

/// Geometric altitudes for which `standard_air` is defined, m.
inline constexpr NumberRange altitudes{80e3, 200e3};
/// The gases that it has, each of which is one of `known_gases`.
inline constexpr std::array<std::string_view, 5> air_species{"N2", "O2", "O", "Ar", "He"};

/// Air at rest.
struct Air {
  double temperature = 0;           ///< K
  std::array<double, 5> density{};  ///< molecules per m3, in the order of `air_species`
  double total() const;             ///< of them all
};

/// Air at a geometric altitude (m) within `altitudes`, from the equations of U.S. Standard Atmosphere, 1976
/// (NOAA-S/T 76-1562): temperature by equations 23 to 31; above 86 km number densities by integrating equations 36 to
/// 38 from table 9, below from the pressure of equation 33a. Between 80 and 86 km the composition goes over from that of
/// the ground to table 9 as the mean molecular weight does (table 8, a straight line between its whole kilometers).
/// Carbon dioxide, neon and others of less than 0.04 % and hydrogen (above 150 km, 0.002 % at 200 km) are left out.
/// Agrees with tables I and VIII to 0.1 %. Local; milliseconds.
Air standard_air(double altitude);

}  // namespace pamr::dsmc
