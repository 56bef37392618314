// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/whole_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/text.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io {

namespace whole {

namespace {

/// Refuses what would make no mesh whatever the format.
void check(WholeMesh& mesh) {
  const auto n = std::ssize(mesh.point);
  for (std::size_t i = 0; i < mesh.point.size(); ++i)
    if (const auto p = mesh.point[i]; !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(fmt::format("expected finite coordinates, found NaN or infinity at node {}", i));
  const auto require_rows = [&](const auto& elements, std::string_view what) {
    for (std::size_t i = 0; i < elements.size(); ++i)
      for (const auto node : elements[i])
        if (node < 0 || node >= n)
          throw Error(fmt::format("{} {}: expected nodes from 0 to {}, found {}", what, i, n - 1, node));
  };
  require_rows(mesh.cell, "cell");
  require_rows(mesh.triangle, "triangle");
  if (mesh.tag.empty()) mesh.patch_of_tag.clear();
  for (const auto tag : mesh.tag)
    if (!mesh.patch_of_tag.contains(tag))
      mesh.patch_of_tag[tag] = {
          .name = fmt::format("patch_{}", tag), .kind = "", .number = std::max<std::int64_t>(tag, -1)};
  std::set<std::string> seen;
  for (const auto& [tag, patch] : mesh.patch_of_tag) {
    require_clean_name(fmt::format("patch {}", tag), patch.name);
    for (const auto& group : patch.groups) require_clean_name(fmt::format("group of patch {}", tag), group.name);
    if (patch.name.empty()) throw Error(fmt::format("expected a name of patch {}, found an empty one", tag));
    if (!seen.insert(patch.name).second)
      throw Error(fmt::format("expected different names of patches, found '{}' twice", patch.name));
  }
  for (const auto& [region, name] : mesh.name_of_region) require_clean_name(fmt::format("region {}", region), name);
  for (const auto& [region, groups] : mesh.groups_of_region)
    for (const auto& group : groups) require_clean_name(fmt::format("group of region {}", region), group.name);
}

WholeMesh read_named(const std::filesystem::path& file, const std::function<WholeMesh()>& read) {
  try {
    auto mesh = read();
    if (!mesh.left_out.empty()) mesh.remarks.push_back(text_of_left_out(mesh.left_out));
    check(mesh);
    return mesh;
  } catch (const Error& error) {
    if (std::string_view(error.what()).starts_with("file '")) throw;  // perhaps one in the folder of that name
    throw Error(source_of(file) + ": " + error.what());
  }
}

/// Lines of the first rank on all. Collective.
std::vector<std::string> share_lines(const par::Comm& comm, const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  text = comm.broadcast(text);
  std::vector<std::string> shared;
  for (std::size_t begin = 0; begin < text.size(); begin += shared.back().size() + 1)
    shared.push_back(text.substr(begin, text.find('\n', begin) - begin));
  return shared;
}

/// The fields of the first rank with their names and types on the others, which have no values. Collective.
std::vector<mesh::Field> share_outline(const par::Comm& comm, std::vector<mesh::Field> fields) {
  std::vector<std::string> names;
  std::vector<int> numbers;
  for (const auto& field : fields) {
    names.push_back(field.name);
    numbers.insert(numbers.end(), {field.n_components, static_cast<int>(field.storage)});
  }
  names = share_lines(comm, names);
  numbers = comm.broadcast(numbers);
  if (comm.is_first()) return fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    mesh::Field field{names[i], "", numbers[2 * i], static_cast<mesh::StorageType>(numbers[2 * i + 1]), {}};
    if (mesh::is_integer(field.storage)) field.value = std::vector<std::int64_t>();
    fields.push_back(std::move(field));
  }
  return fields;
}

/// Names by number, each with its kind and groups, of the first rank on all. Collective.
std::map<std::int64_t, mesh::Patch> share_names(const par::Comm& comm,
                                                const std::map<std::int64_t, mesh::Patch>& names) {
  std::vector<std::string> lines;
  std::vector<std::int64_t> numbers;
  for (const auto& [number, patch] : names) {
    lines.insert(lines.end(), {patch.name, patch.kind});
    numbers.insert(numbers.end(), {number, patch.number, std::ssize(patch.groups)});
    for (const auto& group : patch.groups) {
      lines.push_back(group.name);
      numbers.push_back(group.number);
    }
  }
  lines = share_lines(comm, lines);
  numbers = comm.broadcast(numbers);
  std::map<std::int64_t, mesh::Patch> shared;
  auto line = lines.begin();
  for (auto number = numbers.begin(); number != numbers.end();) {
    auto& patch = shared[*number++];
    patch.name = *line++;
    patch.kind = *line++;
    patch.number = *number++;
    for (auto n_groups = *number++; n_groups > 0; --n_groups) patch.groups.push_back({*number++, *line++});
  }
  return shared;
}

/// Likewise. Collective.
std::vector<GroupOverlap> share_overlaps(const par::Comm& comm, const std::vector<GroupOverlap>& overlaps) {
  std::vector<std::string> lines;
  std::vector<std::int64_t> numbers;
  for (const auto& one : overlaps) {
    lines.insert(lines.end(), {one.kept, one.other, one.why_kept});
    numbers.insert(numbers.end(), {one.dimension, one.n_elements});
  }
  lines = share_lines(comm, lines);
  numbers = comm.broadcast(numbers);
  std::vector<GroupOverlap> shared;
  for (std::size_t i = 0; 2 * i < numbers.size(); ++i)
    shared.push_back(
        {static_cast<int>(numbers[2 * i]), lines[3 * i], lines[3 * i + 1], numbers[2 * i + 1], lines[3 * i + 2]});
  return shared;
}

/// Nodes and cells go to their canonical blocks; the first rank keeps the triangles. Collective.
ElementParts to_parts(const par::Comm& comm, WholeMesh whole) {
  ElementParts parts;
  parts.n_nodes = comm.sum(std::ssize(whole.point));
  parts.n_elements = comm.sum(std::ssize(whole.cell));
  parts.has_regions = comm.any(!whole.region.empty());
  parts.has_signed_regions = true;
  parts.refused = std::move(whole.refused);
  parts.cut = std::move(whole.cut);
  const auto scatter = [&](auto& rows, std::int64_t n, std::size_t width) {
    using T = typename std::remove_cvref_t<decltype(rows)>::value_type;
    std::vector<GlobalId> ids;
    assign_array(ids, rows.size() / width, GlobalId{0});
    std::iota(ids.begin(), ids.end(), 0);
    rows = par::scatter_rows<T>(comm, n, rows, width, ids);
  };
  parts.position = std::move(whole.point);
  scatter(parts.position, parts.n_nodes, 1);
  parts.node_tag.resize(parts.position.size());
  std::iota(parts.node_tag.begin(), parts.node_tag.end(),
            par::block_range(parts.n_nodes, comm.rank(), comm.size()).begin);
  reserve_array(parts.tetrahedron, whole.cell.size());
  for (std::size_t c = 0; c < whole.cell.size(); ++c)
    parts.tetrahedron.push_back({whole.cell[c], whole.region.empty() ? 0 : whole.region[c]});
  free_array(whole.cell);
  free_array(whole.region);
  scatter(parts.tetrahedron, parts.n_elements, 1);
  if (whole.tag.empty())
    parts.n_untagged_triangles = std::ssize(whole.triangle);
  else
    for (std::size_t t = 0; t < whole.triangle.size(); ++t) parts.triangle.push_back({whole.triangle[t], whole.tag[t]});
  parts.cell_fields = share_outline(comm, std::move(whole.cell_fields));
  parts.node_fields = share_outline(comm, std::move(whole.node_fields));
  for (auto& field : parts.cell_fields)
    std::visit([&](auto& values) { scatter(values, parts.n_elements, at(field.n_components)); }, field.value);
  for (auto& field : parts.node_fields)
    std::visit([&](auto& values) { scatter(values, parts.n_nodes, at(field.n_components)); }, field.value);
  return parts;
}

}  // namespace

}  // namespace whole

ElementMesh mesh_of_whole(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options,
                          const std::function<WholeMesh()>& read) {
  WholeMesh mesh;
  par::agree(comm, [&] {
    if (comm.is_first()) mesh = whole::read_named(file, read);
  });
  const auto patches = whole::share_names(comm, mesh.patch_of_tag);
  std::map<std::int64_t, mesh::Patch> regions;
  for (const auto& [number, name] : mesh.name_of_region) {
    regions[number] = {.name = name, .kind = ""};
    if (const auto groups = mesh.groups_of_region.find(number); groups != mesh.groups_of_region.end())
      regions[number].groups = groups->second;
  }
  regions = whole::share_names(comm, regions);
  auto overlaps = whole::share_overlaps(comm, mesh.overlaps);
  auto remarks = whole::share_lines(comm, mesh.remarks), notes = whole::share_lines(comm, mesh.notes);
  auto parts = whole::to_parts(comm, std::move(mesh));
  for (const auto& [number, patch] : patches) parts.group_name[{2, number}] = patch.name;
  for (const auto& [number, region] : regions) parts.group_name[{3, number}] = region.name;
  auto result = mesh_of_elements(comm, std::move(parts), source_of(file), options,
                                 [&](std::int64_t tag) { return patches.at(tag); });
  for (auto& region : result.mesh.info.regions)
    if (const auto known = regions.find(region.number); known != regions.end()) region.groups = known->second.groups;
  result.overlaps.insert(result.overlaps.begin(), overlaps.begin(), overlaps.end());
  result.remarks.insert(result.remarks.end(), remarks.begin(), remarks.end());
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  return result;
}

}  // namespace pamr::io
