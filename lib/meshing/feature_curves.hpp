// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "meshing/meshing_domain.hpp"
#include "meshing/pieces.hpp"
#include "meshing/solid.hpp"

namespace pamr::meshing {

/// The edges of a solid, traced numerically: of the curves in which its surfaces meet two by two, the parts at which
/// both bound the solid or its regions, cut where a third surface crosses, at one corner for all that end there, and
/// where they pass from one smooth piece to another. A closed edge without corners ends where it begins. Points turn by
/// at most 0.01 radian from one to the next and lie on both surfaces to rounding. Found are curves that are larger than
/// a twelfth of the solid's radius or a sixth of one of their surfaces. `samples` are those of `sample_surfaces`.
/// Local, deterministic. Throws `Error` for surfaces that meet at under 5 degrees in an edge, regions that touch along
/// an edge alone, and an edge that leaves the box of the solid. Cost: for each pair of surfaces 14,000 nearest points,
/// and for each edge a few hundred to a few thousand.
std::vector<FeatureCurve> trace_feature_curves(const std::shared_ptr<const Solid>& solid,
                                               const std::shared_ptr<const Pieces>& pieces,
                                               const SurfaceSamples& samples);

}  // namespace pamr::meshing
