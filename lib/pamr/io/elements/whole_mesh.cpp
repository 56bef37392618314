// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/whole_mesh.hpp"

#include <fmt/format.h>

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
  for (const auto tag : mesh.tag) mesh.patch_of_tag.emplace(tag, mesh::Patch{fmt::format("patch_{}", tag), ""});
  std::set<std::string> seen;
  for (const auto& [tag, patch] : mesh.patch_of_tag) {
    if (patch.name.empty() || !is_clean_text(patch.name, ""))
      throw Error(fmt::format("expected a name of patch {} in UTF-8 without control characters, found another", tag));
    if (!seen.insert(patch.name).second)
      throw Error(fmt::format("expected different names of patches, found '{}' twice", patch.name));
  }
  for (const auto& [region, name] : mesh.name_of_region)
    if (!is_clean_text(name, ""))
      throw Error(fmt::format("expected a name of region {} in UTF-8 without control characters", region));
}

WholeMesh read_named(const std::filesystem::path& file, const std::function<WholeMesh()>& read) {
  try {
    auto mesh = read();
    check(mesh);
    return mesh;
  } catch (const Error& error) {
    if (std::string_view(error.what()).starts_with("file '")) throw;  // perhaps one in the folder of that name
    throw Error(source_of(file) + ": " + error.what());
  }
}

/// The fields of the first rank with their names and types on the others, which have no values. Collective.
std::vector<mesh::Field> share_outline(const par::Comm& comm, std::vector<mesh::Field> fields) {
  std::string names;
  std::vector<int> numbers;
  for (const auto& field : fields) {
    names += field.name + '\n';
    numbers.insert(numbers.end(), {field.n_components, static_cast<int>(field.storage)});
  }
  names = comm.broadcast(names);
  numbers = comm.broadcast(numbers);
  if (comm.is_first()) return fields;
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    const auto end = names.find('\n');
    mesh::Field field{names.substr(0, end), "", numbers[i], static_cast<mesh::StorageType>(numbers[i + 1]), {}};
    names.erase(0, end + 1);
    if (mesh::is_integer(field.storage)) field.value = std::vector<std::int64_t>();
    fields.push_back(std::move(field));
  }
  return fields;
}

/// Names by number, each with a second text, of the first rank on all. Collective.
std::map<std::int64_t, mesh::Patch> share_names(const par::Comm& comm,
                                                const std::map<std::int64_t, mesh::Patch>& names) {
  std::string text;
  std::vector<std::int64_t> numbers;
  for (const auto& [number, patch] : names) {
    text += patch.name + '\n' + patch.kind + '\n';
    numbers.push_back(number);
  }
  text = comm.broadcast(text);
  numbers = comm.broadcast(numbers);
  std::map<std::int64_t, mesh::Patch> shared;
  std::string_view rest = text;
  const auto next = [&] {
    const auto line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(line.size() + 1);
    return std::string(line);
  };
  for (const auto number : numbers) {
    auto name = next();
    shared[number] = {std::move(name), next()};
  }
  return shared;
}

/// Nodes and cells go to their canonical blocks; the first rank keeps the triangles. Collective.
ElementParts to_parts(const par::Comm& comm, WholeMesh whole) {
  ElementParts parts;
  parts.n_nodes = comm.sum(std::ssize(whole.point));
  parts.n_elements = comm.sum(std::ssize(whole.cell));
  parts.has_regions = comm.any(!whole.region.empty());
  parts.refused = std::move(whole.refused);
  const auto scatter = [&](auto& rows, std::int64_t n, std::size_t width) {
    using T = typename std::remove_cvref_t<decltype(rows)>::value_type;
    std::vector<GlobalId> ids(rows.size() / width);
    std::iota(ids.begin(), ids.end(), 0);
    rows = par::scatter_rows<T>(comm, n, rows, width, ids);
  };
  parts.position = std::move(whole.point);
  scatter(parts.position, parts.n_nodes, 1);
  parts.node_tag.resize(parts.position.size());
  std::iota(parts.node_tag.begin(), parts.node_tag.end(),
            par::block_range(parts.n_nodes, comm.rank(), comm.size()).begin);
  for (std::size_t c = 0; c < whole.cell.size(); ++c)
    parts.tetrahedron.push_back({whole.cell[c], whole.region.empty() ? 0 : whole.region[c]});
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
  for (const auto& [number, name] : mesh.name_of_region) regions[number] = {name, ""};
  regions = whole::share_names(comm, regions);
  auto parts = whole::to_parts(comm, std::move(mesh));
  for (const auto& [number, patch] : patches) parts.group_name[{2, number}] = patch.name;
  for (const auto& [number, region] : regions) parts.group_name[{3, number}] = region.name;
  return mesh_of_elements(comm, std::move(parts), source_of(file), options,
                          [&](std::int64_t tag) { return patches.at(tag); });
}

}  // namespace pamr::io
