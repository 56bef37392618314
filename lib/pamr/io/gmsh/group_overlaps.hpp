// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/io/gmsh/gmsh_parts.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io::gmsh {

/// Version 2.2 of the format writes an element once for each physical group of its entity: leaves the one in the group
/// with the smallest number, as `read_parts_4` does, and notes the others in `parts.in_two_groups`. Only groups that
/// share an entity are looked at. Collective: one gathering; where groups share entities, two sparse exchanges of their
/// elements.
void leave_one_of_each(const par::Comm& comm, Parts& parts);

/// `parts.in_two_groups` of all ranks with the names of the groups, in ascending order of dimension and numbers.
/// Collective.
std::vector<GroupOverlap> overlaps_of(const par::Comm& comm, const Parts& parts);

}  // namespace pamr::io::gmsh
