// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// Throws `Error` on every rank unless all these are cell fields of reals. Collective.
void require_integrals(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<std::string>& names);

/// Scales the values of the named fields of the refined mesh so that each old cell, or family that was taken back, has
/// the sum of value times volume that it had: nodes that were moved onto a curved wall, or because of those, have
/// changed volumes. `fine`: with its positions and cells; `of_cells`: its fields as `transfer` gives them. Values where
/// no volume has changed by more than rounding stay as they are. Local. Cost: O(children) if there are names.
void keep_integrals(const NumberedMesh& old, const mesh::DistMesh& fine, const std::vector<std::string>& names,
                    std::vector<mesh::CellField>& of_cells);

}  // namespace pamr::refine
