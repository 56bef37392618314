// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/cad/occt_shape.hpp"
#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

/// The solids of a shape, the faces that belong to none, and, where that is asked for, which solids are not clear of
/// one another. Coordinates times `scale`. Cost: of the distance of each pair of solids whose boxes meet, up to the
/// first few that are not clear.
CadSolids solids_of(const OcctShape& read, double scale, bool with_contacts);

/// Middle of the box of a shape, coordinates times `scale`.
Vec3 middle_of_shape(const TopoDS_Shape& shape, double scale);

}  // namespace pamr::geometry
