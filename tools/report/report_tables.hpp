// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/check/mesh_view.hpp"
#include "pamr/check/report_text.hpp"

namespace pamr::report {

/// A mesh of a report: its numbers, and on rank 0 what to look at.
struct ReportedMesh {
  check::NamedReport numbers;
  check::MeshView view;
};

/// Tables of the page, as HTML that needs no script. Local.
std::string mesh_table(const std::vector<ReportedMesh>& meshes);
/// What is wrong with the meshes, a list; empty when nothing is.
std::string fault_list(const std::vector<ReportedMesh>& meshes);
std::string shape_table(const std::vector<ReportedMesh>& meshes);
/// Counts of the histograms, a folded table for each metric.
std::string histogram_tables(const std::vector<ReportedMesh>& meshes);
std::string level_table(const std::vector<ReportedMesh>& meshes);
/// A table for each mesh that has regions.
std::string region_tables(const std::vector<ReportedMesh>& meshes);
/// A table for each mesh.
std::string patch_tables(const std::vector<ReportedMesh>& meshes);
std::string off_surface_tables(const std::vector<ReportedMesh>& meshes);
std::string worst_cell_tables(const std::vector<ReportedMesh>& meshes);

}  // namespace pamr::report
