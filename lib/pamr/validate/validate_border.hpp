// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/par/comm.hpp"
#include "pamr/validate/findings.hpp"

namespace pamr::validate {

/// Rank-border faces. Collective: one sparse exchange of 8 bytes a face, one more where something is wrong.
void check_border(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Faces inside with a patch: both of their cells name it, and it is none of boundary faces without a tag. Collective:
/// where there are some, one exchange as above.
void check_inner_patches(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

}  // namespace pamr::validate
