// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html_report.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "pamr/base/contract.hpp"
#include "pamr/base/version.hpp"
#include "pamr/mesh/tet.hpp"
#include "report/first_view.hpp"
#include "report/html_table.hpp"
#include "report/pack.hpp"
#include "report/page_parts.hpp"
#include "report/still.hpp"
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

std::array<double, 3> vector(geometry::Vec3 v) { return {v.x, v.y, v.z}; }

/// Constants that the scripts share with the program.
nlohmann::json constants(const std::vector<ReportedMesh>& meshes, const FirstView& first) {
  return {{"TET_EDGES", mesh::tet::edge_to_corner},
          {"TET_FACES", mesh::tet::face_to_corner},
          {"PATCH_COLORS", patch_colors},
          {"LEVEL_COLORS", level_colors},
          {"FIRST",
           {{"show", first.show},
            {"color", first.color},
            {"hidden", first.hidden},
            {"meshes", first_meshes(meshes)},
            {"from", vector(first.direction.from)},
            {"up", vector(first.direction.up)}}}};
}

std::string script_elements(const nlohmann::json& constants) {
  using namespace parts;
  std::string text = data_element("constants", constants);
  for (const auto part :
       {three_js, uplot_js, unpack_js, colors_js, sections_js, details_js, view_js, charts_js, page_js})
    text += "<script>\n" + std::string(part) + "\n</script>\n";
  return text;
}

/// The classes of the still picture and their colors, as drawLegend() of page/colors.js writes them.
std::string legend(const std::vector<ReportedMesh>& meshes, const FirstView& first) {
  const bool is_of_patches = first.color == "patch";
  auto names = is_of_patches ? patch_names(meshes) : std::vector<std::string>{};
  if (!is_of_patches)
    for (int level = 0; level <= deepest_level(meshes); ++level) names.push_back(std::to_string(level));
  const auto& colors = is_of_patches ? patch_colors : level_colors;
  auto text = "<strong>" + first.color + "</strong><div class=\"classes\">";
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("<div><span class=\"swatch\" style=\"background: {}\"></span>{}</div>",
                        colors[i % colors.size()], escaped(names[i]));
  return text + "</div>";
}

/// Description of the still picture.
std::string words_of(const std::vector<ReportedMesh>& meshes, const FirstView& first) {
  std::string text = first.show == "y" ? "Section through the middle of " : "Boundary of ";
  for (const auto mesh : first_meshes(meshes)) text += (mesh == 0 ? "" : " and of ") + meshes[mesh].numbers.file;
  for (std::size_t i = 0; i < first.hidden.size(); ++i) text += (i == 0 ? ", without " : ", ") + first.hidden[i];
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
  const auto first_seen = first_view(meshes);
  const auto still = still_picture(meshes, first_seen);
  const std::vector<unsigned char> bytes(still.begin(), still.end());
  const auto title = meshes.size() == 1 ? first : fmt::format("{} and {} more", first, meshes.size() - 1);
  return filled(parts::page_html, {{"title", escaped("Mesh report: " + title)},
                                   {"style", std::string(parts::uplot_css) + std::string(parts::report_css)},
                                   {"meshes", mesh_table(meshes)},
                                   {"faults", fault_list(meshes)},
                                   {"worst_cells", worst_cell_tables(meshes)},
                                   {"shapes", shape_table(meshes)},
                                   {"histograms", histogram_tables(meshes)},
                                   {"patches", region_tables(meshes) + patch_tables(meshes)},
                                   {"off_surface", off_surface_tables(meshes)},
                                   {"levels", level_table(meshes)},
                                   {"still", base64(bytes)},
                                   {"still_words", escaped(words_of(meshes, first_seen))},
                                   {"legend", legend(meshes, first_seen)},
                                   {"data", data_elements(meshes)},
                                   {"scripts", script_elements(constants(meshes, first_seen))},
                                   {"version", std::string(version())}});
}

}  // namespace pamr::report
