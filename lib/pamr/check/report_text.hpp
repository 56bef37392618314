// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pamr/check/quality_report.hpp"

namespace pamr::check {

/// The report as JSON, with the keys that docs/tools/pamr-quality.md lists. Infinite numbers are kept: they become null
/// when written.
nlohmann::json to_json(const check::QualityReport& report);

/// A report and the file that it is about.
struct NamedReport {
  std::string file;
  check::QualityReport report;
};

/// One row a mesh: the file, then every number of its report under its dotted path (without the histograms); columns
/// in the order in which they first occur, empty where a mesh has no such number. Comma-separated, RFC 4180.
std::string to_csv(const std::vector<NamedReport>& reports);

/// One line that says what the mesh is like.
std::string summary_of(const NamedReport& report);

/// A line for each patch: its faces, area, nodes off its surface, and the smallest mean ratio of the cells at it.
std::vector<std::string> patch_lines(const QualityReport& report);

/// A line for each region: its number and name, cells, volume, and the smallest mean ratio of the cells.
std::vector<std::string> region_lines(const QualityReport& report);

/// Several meshes, such as the levels of a run, as lines of a table, heads first; then the patches on curved surfaces,
/// each mesh by mesh.
std::vector<std::string> table_of(const std::vector<NamedReport>& reports);

/// What is wrong with the mesh, a line each; empty when it is valid.
std::vector<std::string> faults_of(const NamedReport& report);

}  // namespace pamr::check
