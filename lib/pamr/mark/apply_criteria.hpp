// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pamr/mark/criteria.hpp"
#include "pamr/mark/recovered_error.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mark {

struct Applied {
  Indicator indicator;  ///< of the cells that meet a criterion and all limits
  /// Of each cell: 1 if it may be coarsened; all 0 where the request does not ask for it. By criteria only: limits take
  /// marks, but a cell without its mark stays.
  std::vector<std::uint8_t> may_go;
  std::vector<std::int64_t> cells_of_criterion;  ///< cells of all ranks that meet each criterion, before the limits
};

/// What criteria are compared with, kept for more trials on the same mesh: recovered errors by field. Eight bytes a
/// cell and field.
using KnownErrors = std::map<std::string, RecoveredError>;

/// Evaluates all criteria and limits of a request but the budget. Collective. Throws `Error` on every rank for patches
/// and fields that the mesh does not have or that do not suit. `known`: errors that are known are not recovered again,
/// and those that are recovered are added; the same fields on all ranks.
Applied apply(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request, KnownErrors& known);
Applied apply(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request);

}  // namespace pamr::mark
