// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "pamr/geometry/cad/occt_shape.hpp"

namespace pamr::geometry {

/// True for a text whose first line is one of IGES (letter S in column 73).
bool is_iges(std::string_view text);

/// Reads an IGES text. Faces that belong to no solid are sewn along their borders, within ten times the resolution that
/// the file states (1e-6 to 1e-4 of the size), and what closes becomes a solid. Throws `Error`.
OcctShape read_iges(std::string_view text);

}  // namespace pamr::geometry
