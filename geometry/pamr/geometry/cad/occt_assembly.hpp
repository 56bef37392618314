// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "pamr/geometry/cad/occt_shape.hpp"
#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

/// `assemble_cad` of a shape that was read. The shape stays as it is.
CadAssembly assembly_of(const OcctShape& read, double scale, std::span<const std::string> chosen);

}  // namespace pamr::geometry
