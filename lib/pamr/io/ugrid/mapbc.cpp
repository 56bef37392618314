// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/ugrid/mapbc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::ugrid {

namespace {

/// On the first rank: the text, empty where there is no file.
std::string text_of(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::exists(file, none)) return {};
  auto text = read_file(file);
  if (!text) throw Error(fmt::format("file '{}': expected a file that can be read, found another", file.string()));
  return text->empty() ? " " : std::move(*text);
}

std::string name_in(std::string_view rest, std::int64_t number) {
  const auto begin = rest.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return fmt::format("surface_{}", number);
  return std::string(rest.substr(begin, rest.find_last_not_of(" \t") - begin + 1));
}

}  // namespace

std::string kind_of_condition(std::int64_t condition) {
  switch (condition) {
    case 4:
    case 4000:
    case 4010:
    case 4020:
    case 4030:
      return "wall";
    case 3000:
    case 6661:
    case 6662:
    case 6663:
      return "symmetry";
    case 3:
    case 5000:
    case 5005:
    case 5025:
    case 5050:
      return "farfield";
    case 5026:
    case 5051:
    case 5052:
    case 7012:
    case 7031:
      return "outflow";
    case 7011:
    case 7036:
      return "inflow";
    default:
      return {};
  }
}

std::int64_t condition_of_kind(const std::string& kind, int axis) {
  if (kind == "wall") return 4000;
  if (kind == "symmetry" || kind == "symmetryPlane") return axis >= 0 ? 6661 + axis : 3000;
  if (kind == "farfield") return 5000;
  if (kind == "inflow") return 7011;
  if (kind == "outflow") return 7012;
  return 0;
}

Conditions read_mapbc(const par::Comm& comm, const std::filesystem::path& file) {
  std::string text;
  par::agree(comm, [&] {
    if (comm.is_first()) text = text_of(file);
  });
  text = comm.broadcast(text);
  Conditions conditions;
  if (text.empty()) return conditions;
  conditions.is_there = true;
  par::agree(comm, [&] {
    TextCursor in(text, file.string());
    in.skip_byte_order_mark();
    const auto n = in.checked_count(in.integer("the number of surfaces"), 4, "surfaces");
    (void)in.line();
    for (std::int64_t i = 0; i < n; ++i) {
      const auto number = in.integer("the number of a surface");
      const auto condition = in.integer_in_line("a boundary condition");
      const auto name = name_in(in.line(), number);
      if (!is_clean_text(name, "")) in.fail("the name of a surface in UTF-8 without control characters", "another");
      if (!conditions.patches
               .emplace(number, mesh::Patch{.name = name, .kind = kind_of_condition(condition), .condition = condition})
               .second)
        in.fail("each surface once", fmt::format("{} again", number));
    }
    for (in.skip_empty_lines('#'); !in.at_end(); in.skip_empty_lines('#')) {
      (void)in.line();
      ++conditions.n_more_lines;
    }
  });
  return conditions;
}

std::vector<std::string> remarks_of(const Conditions& conditions, const std::filesystem::path& file,
                                    const mesh::MeshInfo& info) {
  std::vector<std::string> remarks;
  if (!conditions.is_there) return remarks;
  const auto name = shown_text(file.filename().string());
  std::set<std::int64_t> surfaces;
  std::vector<std::int64_t> missing, idle;
  for (const auto& patch : info.patches) {
    surfaces.insert(patch.number);
    if (patch.number > 0 && !conditions.patches.contains(patch.number)) missing.push_back(patch.number);
  }
  for (const auto& [number, patch] : conditions.patches)
    if (!surfaces.contains(number)) idle.push_back(number);
  const auto add_lines = [&](std::int64_t n, const std::string& why) {
    remarks.push_back(
        fmt::format("{} of {} {} left out: {}", counted(n, "line", "lines"), name, n == 1 ? "is" : "are", why));
  };
  if (!idle.empty())
    add_lines(std::ssize(idle), fmt::format("the mesh has no such surface, the first is {} '{}'", idle.front(),
                                            conditions.patches.at(idle.front()).name));
  if (conditions.n_more_lines > 0)
    add_lines(conditions.n_more_lines, fmt::format("behind the {} that it announces", conditions.patches.size()));
  if (!missing.empty())
    remarks.push_back(fmt::format("{} no line in {}, the first is {}: no condition is known there",
                                  counted(std::ssize(missing), "surface has", "surfaces have"), name, missing.front()));
  return remarks;
}

std::string mapbc_text(const mesh::MeshInfo& info, const std::vector<std::int64_t>& number,
                       const std::vector<int>& axis, const std::vector<std::int64_t>& n_faces, const Remark& remark) {
  std::vector<std::string> names;
  for (std::size_t p = 0; p < info.patches.size(); ++p)
    if (n_faces[p] > 0) names.push_back(info.patches[p].name);
  names = written_names(
      {.format = "UGRID", .what = "patch", .is_allowed = [](char) { return true; }, .has_outer_blanks = false}, names,
      remark);
  auto name = names.begin();
  auto text = fmt::format("{}\n", std::ssize(n_faces) - std::count(n_faces.begin(), n_faces.end(), 0));
  for (std::size_t p = 0; p < info.patches.size(); ++p) {
    if (n_faces[p] == 0) continue;
    const auto& patch = info.patches[p];
    const bool is_kept = patch.condition != 0 && kind_of_condition(patch.condition) == patch.kind;
    text += fmt::format("{} {} {}\n", number[p], is_kept ? patch.condition : condition_of_kind(patch.kind, axis[p]),
                        *name++);
  }
  return text;
}

}  // namespace pamr::io::ugrid
