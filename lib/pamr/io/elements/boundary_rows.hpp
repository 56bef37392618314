// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/io/rows_in_order.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::io {

/// A triangle of the boundary, seen counter-clockwise from outside, or of an interface.
struct BoundaryRow {
  std::array<GlobalId, 3> node{};
  int patch = 0;  ///< or interface: `RowsInOrder::group`
};

/// Those at this rank's block of cells, by cell, the faces of a cell by slot. Local.
std::vector<BoundaryRow> boundary_rows(const RowsInOrder& rows);

/// Numbers of patches (and interfaces) for formats that know numbers: `own` of the user, from `first` on, where no patch
/// before has it; else N for a patch `prefixN` (N of at most nine digits, from `first` on), as the readers of these
/// formats call them; the lowest free numbers from `first_free` on for the others, in order. Below 2^31.
std::vector<std::int64_t> patch_numbers(const std::vector<std::string>& names, std::string_view prefix,
                                        std::int64_t first, const std::vector<std::int64_t>& own = {},
                                        std::int64_t first_free = 1);

}  // namespace pamr::io
