// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/par/comm.hpp"
#include "pamr/validate/findings.hpp"

namespace pamr::validate {

/// Every global cell number once. Collective: one sparse exchange of the runs of numbers.
void check_unique_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Nodes, and faces all of whose nodes other ranks hold too; after `check_border`, on whose findings it relies.
/// Collective: three sparse exchanges, two more where something is wrong.
void check_shared(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Edges of the boundary. Collective: one sparse exchange.
void check_boundary(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

}  // namespace pamr::validate
