// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "pamr/base/counted.hpp"
#include "pamr/base/csv_field.hpp"
#include "pamr/check/gate.hpp"

namespace pamr::check {

namespace {

const check::MetricReport& metric(const check::QualityReport& report, const std::string& name) {
  return *std::find_if(report.metrics.begin(), report.metrics.end(), [&](const auto& m) { return m.name == name; });
}

std::int64_t off_surface_nodes(const check::QualityReport& report) {
  std::int64_t count = 0;
  for (const auto& patch : report.patches) count += patch.off_surface_nodes;
  return count;
}

/// The patches on curved surfaces mesh by mesh, when there are any: what has no distance and no turned triangle in any
/// mesh lies on planes.
void append_patch_table(const std::vector<NamedReport>& reports, std::size_t width, std::vector<std::string>& lines) {
  std::vector<std::string> names;
  for (const auto& named : reports)
    for (const auto& patch : named.report.patches)
      if ((patch.worst_distance > 0 || patch.worst_normal_deviation > 0) &&
          std::find(names.begin(), names.end(), patch.name) == names.end())
        names.push_back(patch.name);
  if (names.empty()) return;
  std::size_t patch_width = 5;
  for (const auto& name : names) patch_width = std::max(patch_width, name.size());
  lines.push_back(fmt::format("{:<{}} {:<{}} {:>10} {:>14} {:>11} {:>11} {:>16} {:>17}", "patch", patch_width, "mesh",
                              width, "faces", "area", "worst dist.", "off surface", "mean normal dev.",
                              "worst normal dev."));
  for (const auto& name : names)
    for (const auto& [file, r] : reports)
      for (const auto& patch : r.patches)
        if (patch.name == name)
          lines.push_back(fmt::format("{:<{}} {:<{}} {:>10} {:>14.8g} {:>11.3e} {:>11} {:>16.3f} {:>17.3f}", name,
                                      patch_width, file, width, patch.faces, patch.area, patch.worst_distance,
                                      patch.off_surface_nodes, patch.mean_normal_deviation,
                                      patch.worst_normal_deviation));
}

nlohmann::json to_json(const check::MetricReport& m) {
  return {
      {"min", m.min}, {"mean", m.mean}, {"max", m.max}, {"histogram", {{"edges", m.edge}, {"counts", m.histogram}}}};
}

nlohmann::json to_json(const check::TriangleReport& report) {
  nlohmann::json json{{"mean_distance", report.mean_distance}, {"worst_distance", report.worst_distance}};
  for (const auto& m : report.metrics) json[m.name] = to_json(m);
  return json;
}

nlohmann::json to_json(const std::vector<RegionReport>& regions) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& region : regions)
    json[region.name] = {{"number", region.number},
                         {"cells", region.cells},
                         {"volume", region.volume},
                         {"min_mean_ratio", region.min_mean_ratio}};
  return json;
}

}  // namespace

nlohmann::json to_json(const check::QualityReport& report) {
  nlohmann::json json{{"cells", report.cells},
                      {"nodes", report.nodes},
                      {"volume", report.volume},
                      {"bounding_box_diagonal", report.bounding_box_diagonal},
                      {"inverted_cells", report.inverted_cells},
                      {"conforming", report.conforming},
                      {"neighbors_consistent", report.neighbors_consistent},
                      {"valid", report.is_valid()},
                      {"cells_of_level", report.cells_of_level},
                      {"closure_cells", report.closure_cells},
                      {"uniform_shape_bound", report.uniform_shape_bound},
                      {"ledger", {{"nodes", report.off_surface.nodes}, {"worst", report.off_surface.worst}}},
                      {"fingerprint", fmt::format("{:016x}", report.fingerprint)}};
  if (report.tears) {
    json["pieces"] = report.tears->n_pieces;
    json["coincident_nodes"] = report.tears->coincident_nodes.count;
    json["coincident_faces"] = report.tears->coincident_faces.count;
    json["overlaps"] = report.tears->overlaps.count;
  }
  json["patches"] = nlohmann::json::object();
  for (std::size_t p = 0; p < report.patches.size(); ++p) {
    const auto& patch = report.patches[p];
    auto& entry = json["patches"][patch.name] = {{"faces", patch.faces},
                                                 {"area", patch.area},
                                                 {"worst_distance", patch.worst_distance},
                                                 {"off_surface_nodes", patch.off_surface_nodes},
                                                 {"min_mean_ratio", patch.min_mean_ratio},
                                                 {"mean_normal_deviation", patch.mean_normal_deviation},
                                                 {"worst_normal_deviation", patch.worst_normal_deviation},
                                                 {"surface", patch.surface}};
    if (p < report.triangles.size()) entry["triangles"] = to_json(report.triangles[p]);
    if (!patch.surface.empty()) continue;
    entry["flat"] = patch.is_flat;
    entry["worst_plane_distance"] = patch.worst_plane_distance;
    entry["off_facets_nodes"] = patch.off_facets_nodes;
    entry["worst_off_facets"] = patch.worst_off_facets;
  }
  if (!report.regions.empty()) json["regions"] = to_json(report.regions);
  json["violations"] = nlohmann::json::array();
  for (const auto& violation : report.violations) {
    auto& entry = json["violations"].emplace_back();
    entry = {{"invariant", violation.invariant}, {"count", violation.count}};
    if (violation.where != invalid_global) entry["where"] = violation.where;
  }
  for (const auto& m : report.metrics) json[m.name] = to_json(m);
  return json;
}

std::string to_csv(const std::vector<NamedReport>& reports) {
  std::vector<std::string> columns;
  std::vector<std::vector<std::pair<std::string, double>>> rows;
  for (const auto& named : reports) {
    rows.push_back(numbers_of(to_json(named.report)));
    for (const auto& [name, value] : rows.back())
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  }
  std::string text = "file";
  for (const auto& column : columns) text += "," + csv_field(column);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    text += "\n" + csv_field(reports[i].file);
    for (const auto& column : columns) {
      const auto at = std::find_if(rows[i].begin(), rows[i].end(), [&](const auto& n) { return n.first == column; });
      text += at == rows[i].end() ? "," : fmt::format(",{:.17g}", at->second);
    }
  }
  return text + "\n";
}

std::string summary_of(const NamedReport& named) {
  const auto& r = named.report;
  std::int64_t off_facets = 0;
  for (const auto& patch : r.patches) off_facets += patch.off_facets_nodes;
  const auto bent = off_facets == 0 ? "" : fmt::format(", {} off the faces of a patch without a surface", off_facets);
  return fmt::format(
      "{}: {} cells, {} nodes, volume {:.10g}, mean ratio min {:.4f} mean {:.4f} (of all later 1:8 levels{}: {:.4f}), "
      "dihedral angles {:.2f} to {:.2f} degrees, {} inverted, {} nodes off their surface{}, {}, fingerprint {:016x}",
      named.file, r.cells, r.nodes, r.volume, metric(r, "mean_ratio").min, metric(r, "mean_ratio").mean,
      r.has_curved_walls ? " away from curved walls" : "", r.uniform_shape_bound, metric(r, "min_dihedral").min,
      metric(r, "max_dihedral").max, r.inverted_cells, off_surface_nodes(r), bent, r.is_valid() ? "valid" : "NOT VALID",
      r.fingerprint);
}

std::vector<std::string> patch_lines(const QualityReport& report) {
  std::vector<std::string> lines;
  for (const auto& patch : report.patches)
    lines.push_back(fmt::format(
        "patch {}: {}, area {:.8g}, {} off its surface, {}", patch.name, counted(patch.faces, "face", "faces"),
        patch.area, counted(patch.off_surface_nodes, "node", "nodes"),
        patch.faces == 0 ? "no cells at it" : fmt::format("mean ratio of its cells min {:.4f}", patch.min_mean_ratio)));
  return lines;
}

std::vector<std::string> region_lines(const QualityReport& report) {
  std::vector<std::string> lines;
  for (const auto& region : report.regions)
    lines.push_back(fmt::format("region {} {}: {}, volume {:.10g}, mean ratio min {:.4f}", region.number, region.name,
                                counted(region.cells, "cell", "cells"), region.volume, region.min_mean_ratio));
  return lines;
}

std::vector<std::string> table_of(const std::vector<NamedReport>& reports) {
  std::size_t width = 4;
  for (const auto& named : reports) width = std::max(width, named.file.size());
  std::vector<std::string> lines{
      fmt::format("{:<{}} {:>12} {:>11} {:>14} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>11} {:>5}  {}", "mesh", width,
                  "cells", "nodes", "volume", "mean min", "mean avg", "rad. min", "dih. min", "dih. max", "inverted",
                  "off surface", "valid", "fingerprint")};
  for (const auto& [file, r] : reports)
    lines.push_back(fmt::format(
        "{:<{}} {:>12} {:>11} {:>14.8g} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.2f} {:>9.2f} {:>8} {:>11} {:>5}  {:016x}", file,
        width, r.cells, r.nodes, r.volume, metric(r, "mean_ratio").min, metric(r, "mean_ratio").mean,
        metric(r, "radius_ratio").min, metric(r, "min_dihedral").min, metric(r, "max_dihedral").max, r.inverted_cells,
        off_surface_nodes(r), r.is_valid() ? "yes" : "NO", r.fingerprint));
  append_patch_table(reports, width, lines);
  return lines;
}

std::vector<std::string> faults_of(const NamedReport& named) {
  std::vector<std::string> lines;
  for (const auto& violation : named.report.violations)
    lines.push_back(fmt::format("{}: invariant {} is broken {}{}", named.file, violation.invariant,
                                counted(violation.count, "time", "times"), validate::text_of_place(violation)));
  if (named.report.inverted_cells > 0)
    lines.push_back(named.file + ": " + counted(named.report.inverted_cells, "cell", "cells") +
                    " without positive volume");
  return lines;
}

}  // namespace pamr::check
