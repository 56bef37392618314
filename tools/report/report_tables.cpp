// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pamr/base/index.hpp"
#include "report/html_table.hpp"

namespace pamr::report {

namespace {

const check::MetricReport& metric(const ReportedMesh& mesh, const std::string& name) {
  const auto& all = mesh.numbers.report.metrics;
  return *std::find_if(all.begin(), all.end(), [&](const auto& m) { return m.name == name; });
}

std::vector<std::string> names_of_meshes(const std::vector<ReportedMesh>& meshes, std::vector<std::string> heads) {
  for (const auto& mesh : meshes) heads.push_back(mesh.numbers.file);
  return heads;
}

std::string of_mesh(const char* what, const ReportedMesh& mesh) { return what + (", " + mesh.numbers.file); }

std::string row_of(std::size_t mesh, const char* element, GlobalId number) {
  return fmt::format(" data-mesh=\"{}\" data-{}=\"{}\"", mesh, element, number);
}

/// Name of a metric in words.
std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  const bool is_angle = name.find("dihedral") != std::string::npos;
  return name + (is_angle ? " angle, degrees" : "");
}

/// The head of a column of lengths, areas or volumes.
std::string with_unit(const std::string& head, const ReportedMesh& mesh, const char* power = "") {
  const auto& unit = mesh.view.length_unit;
  return unit.empty() || unit == "1" ? head : head + ", " + unit + power;
}

std::vector<std::string> coordinate_texts(geometry::Vec3 p) {
  return {short_number(p.x), short_number(p.y), short_number(p.z)};
}

geometry::Vec3 centroid(const check::MeshView& view, std::size_t cell) {
  geometry::Vec3 sum{};
  for (const auto node : view.cells.node[cell]) sum = sum + view.nodes.position[at(node)];
  return 0.25 * sum;
}

}  // namespace

std::string mesh_table(const std::vector<ReportedMesh>& meshes) {
  const bool has_one_unit = std::all_of(meshes.begin(), meshes.end(), [&](const auto& mesh) {
    return mesh.view.length_unit == meshes.front().view.length_unit;
  });
  const auto volume = has_one_unit ? with_unit("volume", meshes.front(), "³") : "volume, in units of its mesh";
  HtmlTable table("Meshes", {"mesh", "cells", "nodes", volume, "mean ratio, worst", "mean ratio, mean",
                             "dihedral angles, degrees", "inverted", "off surface", "valid", "fingerprint"});
  for (const auto& mesh : meshes) {
    const auto& r = mesh.numbers.report;
    std::int64_t off = 0;
    for (const auto& patch : r.patches) off += patch.off_surface_nodes;
    table.add(
        {mesh.numbers.file, grouped(r.cells), grouped(r.nodes), short_number(r.volume),
         fmt::format("{:.4f}", metric(mesh, "mean_ratio").min), fmt::format("{:.4f}", metric(mesh, "mean_ratio").mean),
         fmt::format("{:.2f} to {:.2f}", metric(mesh, "min_dihedral").min, metric(mesh, "max_dihedral").max),
         grouped(r.inverted_cells), grouped(off), r.is_valid() ? "yes" : "NO", fmt::format("{:016x}", r.fingerprint)});
  }
  return table.text();
}

std::string fault_list(const std::vector<ReportedMesh>& meshes) {
  std::string items;
  for (const auto& mesh : meshes)
    for (const auto& fault : check::faults_of(mesh.numbers)) items += "<li>" + escaped(fault) + "</li>\n";
  return items.empty() ? "" : "<ul class=\"faults\">\n" + items + "</ul>\n";
}

std::string shape_table(const std::vector<ReportedMesh>& meshes) {
  HtmlTable table("Shapes of the cells", {"metric", "mesh", "min", "mean", "max"}, 2);
  for (std::size_t m = 0; m < meshes.front().numbers.report.metrics.size(); ++m)
    for (const auto& mesh : meshes) {
      const auto& values = mesh.numbers.report.metrics[m];
      table.add({in_words(values.name), mesh.numbers.file, short_number(values.min), short_number(values.mean),
                 short_number(values.max)});
    }
  return table.text();
}

std::string histogram_tables(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (std::size_t m = 0; m < meshes.front().numbers.report.metrics.size(); ++m) {
    const auto& first = meshes.front().numbers.report.metrics[m];
    HtmlTable table("Cells by " + in_words(first.name), names_of_meshes(meshes, {"from", "to"}), 2);
    for (std::size_t bin = 0; bin < first.histogram.size(); ++bin) {
      std::vector<std::string> row{short_number(first.edge[bin]), short_number(first.edge[bin + 1])};
      for (const auto& mesh : meshes) row.push_back(grouped(mesh.numbers.report.metrics[m].histogram[bin]));
      table.add(row);
    }
    text +=
        "<details><summary>Counts: " + escaped(in_words(first.name)) + "</summary>\n" + table.text() + "</details>\n";
  }
  return text;
}

std::string level_table(const std::vector<ReportedMesh>& meshes) {
  HtmlTable table("Cells by the level of their base cell", names_of_meshes(meshes, {"level"}));
  std::size_t n_levels = 0;
  for (const auto& mesh : meshes) n_levels = std::max(n_levels, mesh.numbers.report.cells_of_level.size());
  for (std::size_t level = 0; level < n_levels; ++level) {
    std::vector<std::string> row{std::to_string(level)};
    for (const auto& mesh : meshes) {
      const auto& count = mesh.numbers.report.cells_of_level;
      row.push_back(grouped(level < count.size() ? count[level] : 0));
    }
    table.add(row);
  }
  std::vector<std::string> closure{"closure cells among them"}, all{"all cells"};
  for (const auto& mesh : meshes) {
    closure.push_back(grouped(mesh.numbers.report.closure_cells));
    all.push_back(grouped(mesh.numbers.report.cells));
  }
  table.add(closure);
  table.add(all);
  return table.text();
}

std::string region_tables(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (const auto& mesh : meshes) {
    HtmlTable table(of_mesh("Regions", mesh),
                    {"region", "number", "cells", with_unit("volume", mesh, "³"), "mean ratio, worst"});
    for (const auto& region : mesh.numbers.report.regions)
      table.add({region.name, std::to_string(region.number), grouped(region.cells), short_number(region.volume),
                 fmt::format("{:.4f}", region.min_mean_ratio)});
    if (!table.is_empty()) text += table.text();
  }
  return text;
}

std::string patch_tables(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (const auto& mesh : meshes) {
    HtmlTable table(of_mesh("Patches", mesh),
                    {"patch", "kind", "surface", "faces", with_unit("area", mesh, "²"), "nodes off surface",
                     with_unit("worst distance of a node", mesh), with_unit("worst distance of a middle", mesh),
                     "normal deviation, mean, degrees", "normal deviation, worst, degrees",
                     "triangles: worst mean ratio", "triangles: smallest angle, degrees"},
                    3);
    const auto& report = mesh.numbers.report;
    for (std::size_t p = 0; p < report.patches.size(); ++p) {
      const auto& patch = report.patches[p];
      const auto& triangles = report.triangles[p];
      const auto worst = [&](const char* name) {
        const auto found = std::find_if(triangles.metrics.begin(), triangles.metrics.end(),
                                        [&](const auto& m) { return m.name == name; });
        return short_number(found->min);
      };
      table.add({patch.name, mesh.view.patches[p].kind, patch.surface.empty() ? "none" : patch.surface,
                 grouped(patch.faces), short_number(patch.area), grouped(patch.off_surface_nodes),
                 short_number(patch.worst_distance), short_number(triangles.worst_distance),
                 short_number(patch.mean_normal_deviation), short_number(patch.worst_normal_deviation),
                 worst("mean_ratio"), worst("min_angle")});
    }
    text += table.text();
  }
  return text;
}

std::string off_surface_tables(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    HtmlTable table(of_mesh("Nodes off their surface, farthest first", meshes[m]),
                    {"node", "patch", with_unit("distance", meshes[m]), with_unit("x", meshes[m]),
                     with_unit("y", meshes[m]), with_unit("z", meshes[m])},
                    2);
    for (const auto& node : meshes[m].view.off_surface) {
      std::vector<std::string> row{std::to_string(node.node), meshes[m].view.patches[at(node.patch)].name,
                                   short_number(node.distance)};
      for (auto& x : coordinate_texts(node.position)) row.push_back(std::move(x));
      table.add(row, row_of(m, "node", node.node) + fmt::format(" data-position=\"{:.9g} {:.9g} {:.9g}\"",
                                                                node.position.x, node.position.y, node.position.z));
    }
    text += table.is_empty() ? "<p>" + escaped(meshes[m].numbers.file) + ": all nodes are on their surfaces.</p>\n"
                             : table.text();
  }
  return text;
}

std::string worst_cell_tables(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto& view = meshes[m].view;
    std::vector<std::string> heads{"cell", with_unit("x", meshes[m]), with_unit("y", meshes[m]),
                                   with_unit("z", meshes[m]), "level"};
    for (const auto& values : meshes[m].numbers.report.metrics) heads.push_back(in_words(values.name));
    HtmlTable table(of_mesh("Cells of lowest mean ratio", meshes[m]), heads);
    for (const auto& worst : view.worst) {
      const auto found = std::lower_bound(view.cells.number.begin(), view.cells.number.end(), worst.cell);
      if (found == view.cells.number.end() || *found != worst.cell) continue;  // its corners are not finite
      const auto cell = static_cast<std::size_t>(found - view.cells.number.begin());
      std::vector<std::string> row{std::to_string(worst.cell)};
      for (auto& x : coordinate_texts(centroid(view, cell))) row.push_back(std::move(x));
      const auto value = [&](const std::string& name) {
        const auto column = std::find_if(view.cells.columns.begin(), view.cells.columns.end(),
                                         [&](const auto& c) { return c.name == name; });
        return short_number(column->value[cell]);
      };
      row.push_back(value("level"));
      for (const auto& values : meshes[m].numbers.report.metrics) row.push_back(value(values.name));
      table.add(row, row_of(m, "cell", worst.cell));
    }
    text += table.text();
  }
  return text;
}

}  // namespace pamr::report
