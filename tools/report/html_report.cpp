// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html_report.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "pamr/base/contract.hpp"
#include "pamr/base/version.hpp"
#include "pamr/mesh/tet.hpp"
#include "report/html_table.hpp"
#include "report/page_parts.hpp"
#include "report/view_json.hpp"

namespace pamr::report {

namespace {

constexpr std::size_t bytes_of_views = 22'000'000;  // with the scripts and the tables, a page stays below 25 MB

/// JSON inside of a script element, which a "<" could end.
std::string data_element(const std::string& kind, const nlohmann::json& data) {
  const auto plain = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text = "<script type=\"application/json\" class=\"" + kind + "\">";
  text.reserve(plain.size() + 100);
  for (const char c : plain) c == '<' ? text += "\\u003c" : text += c;
  return text + "</script>\n";
}

std::string data_elements(const std::vector<ReportedMesh>& meshes) {
  std::string text;
  for (const auto& mesh : meshes) {
    auto numbers = check::to_json(mesh.numbers.report);
    numbers["file"] = mesh.numbers.file;
    text += data_element("numbers", numbers);
    text += data_element("view", view_json(mesh.view, bytes_of_views / meshes.size()));
  }
  return text;
}

std::string script_elements() {
  using namespace parts;
  auto text =
      fmt::format("<script>\nconst TET_EDGES = {}, TET_FACES = {};\n</script>\n",
                  nlohmann::json(mesh::tet::edge_to_corner).dump(), nlohmann::json(mesh::tet::face_to_corner).dump());
  for (const auto part :
       {three_js, uplot_js, unpack_js, colors_js, sections_js, details_js, view_js, charts_js, page_js})
    text += "<script>\n" + std::string(part) + "\n</script>\n";
  return text;
}

/// The text with each {{NAME}} replaced.
std::string filled(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
  std::string result;
  while (true) {
    const auto begin = text.find("{{");
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) return result;
    const auto end = text.find("}}", begin);
    const auto value = values.find(text.substr(begin + 2, end - begin - 2));
    PAMR_EXPECTS(value != values.end());
    result += value->second;
    text.remove_prefix(end + 2);
  }
}

}  // namespace

check::ViewLimits limits_of_one(std::size_t n_meshes) {
  check::ViewLimits limits;
  limits.faces /= static_cast<std::int64_t>(n_meshes);
  limits.cut_cells /= static_cast<std::int64_t>(n_meshes);
  return limits;
}

std::string html_report(const std::vector<ReportedMesh>& meshes) {
  PAMR_EXPECTS(!meshes.empty());
  const auto& first = meshes.front().numbers.file;
  const auto title = meshes.size() == 1 ? first : fmt::format("{} and {} more", first, meshes.size() - 1);
  return filled(parts::page_html, {{"title", escaped("Mesh report: " + title)},
                                   {"style", std::string(parts::uplot_css) + std::string(parts::report_css)},
                                   {"meshes", mesh_table(meshes)},
                                   {"faults", fault_list(meshes)},
                                   {"worst_cells", worst_cell_tables(meshes)},
                                   {"shapes", shape_table(meshes)},
                                   {"histograms", histogram_tables(meshes)},
                                   {"patches", patch_tables(meshes)},
                                   {"off_surface", off_surface_tables(meshes)},
                                   {"levels", level_table(meshes)},
                                   {"data", data_elements(meshes)},
                                   {"scripts", script_elements()},
                                   {"version", std::string(version())}});
}

}  // namespace pamr::report
