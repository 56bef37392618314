// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/check/mesh_view.hpp"
#include "report/report_tables.hpp"

namespace pamr::report {

/// What of each mesh is shown, so that the page of so many stays within 25 MB.
check::ViewLimits limits_of_one(std::size_t n_meshes);

/// One page that shows the meshes: complete in itself, it opens from a disk without network. Tables are readable
/// without scripts. The same bytes for the same meshes on any number of ranks. Call on rank 0, with at least one mesh.
/// Local.
std::string html_report(const std::vector<ReportedMesh>& meshes);

}  // namespace pamr::report
