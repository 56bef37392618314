// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/io/gmsh/gmsh_parts.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io::gmsh {

/// Version 2.2 of the format writes an element once for each physical group of its entity: makes one element of these,
/// in a group that stands for all of them (`parts.joint`), as `read_parts_4` does. Only groups that share an entity are
/// looked at. Collective: one gathering; where groups share entities, two sparse exchanges of their elements.
void join_copies(const par::Comm& comm, Parts& parts);

/// The groups for which one of `parts.joint` stands, in ascending order; none for others. Local.
std::vector<mesh::Group> members_of(const Parts& parts, int dimension, std::int64_t group);

/// Names those that stand for several groups after them: `A+B`, with more `+` where a group has that name. Local.
void name_joint_groups(Parts& parts);

}  // namespace pamr::io::gmsh
