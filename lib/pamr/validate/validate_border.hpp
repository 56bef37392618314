// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/par/comm.hpp"
#include "pamr/validate/findings.hpp"

namespace pamr::validate {

/// Rank-border faces. Collective: one sparse exchange of 8 bytes a face, one more where something is wrong.
void check_border(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

}  // namespace pamr::validate
