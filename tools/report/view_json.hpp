// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "pamr/check/mesh_view.hpp"

namespace pamr::report {

/// A view for the scripts of the page: positions as 24-bit parts of the box, values to 4 digits, numbers of nodes and
/// cells exactly. The columns that would make it longer than `limit` bytes are left out and named in `left_out`.
nlohmann::json view_json(const check::MeshView& view, std::size_t limit);

}  // namespace pamr::report
