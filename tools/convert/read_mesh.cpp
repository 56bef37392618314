// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/read_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/scaled_surfaces.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/element_remarks.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::convert {

namespace {

constexpr std::array<std::string_view, 8> kinds{"wall",   "symmetry", "symmetryPlane", "farfield",
                                                "inflow", "outflow",  "patch",         mesh::untagged_kind};

geometry::SharedSurfaces scaled_surfaces(const geometry::SurfaceSet& surfaces, double factor) {
  try {
    return std::make_shared<const geometry::SurfaceSet>(geometry::scaled(surfaces, factor));
  } catch (const Error& error) {
    throw Error(std::string("--scale: ") + error.what());
  }
}

}  // namespace

ReadMesh read_mesh(cli::Session& session, const ReadRequest& request, nlohmann::json& report) {
  const std::function<void(const std::string&)> refuse = [](const auto& remark) { throw Error(remark); };
  const auto& format = io::format_to_read(request.file);
  auto read = format.read(session.comm(), request.file,
                          {.repair = !request.strict,
                           .split_prisms = request.split_prisms,
                           .build_surfaces = request.build_surfaces,
                           .remark = request.strict ? refuse : session.remarks(),
                           .solution = request.solution,
                           .field_names = request.field_names});
  if (request.strict) io::refuse_changes(read, io::source_of(request.file));
  report["untagged_faces"] = mesh::count_untagged_faces(session.comm(), read.mesh);
  if (format.is_native) {
    const auto remark = io::remark_on_untagged(read);
    return {std::move(read.mesh), remark.empty() ? std::vector<std::string>() : std::vector{remark}, {}};
  }
  if (format.has_elements) {
    auto& overlaps = report["group_overlaps"] = nlohmann::json::array();
    for (const auto& one : read.overlaps)
      overlaps.push_back(
          {{"dimension", one.dimension}, {"kept", one.kept}, {"other", one.other}, {"elements", one.n_elements}});
    auto& inner = report["inner_faces"] = nlohmann::json::object();
    for (const auto& [group, n] : read.inner_faces) inner[group] = n;
    auto& unused = report["unused_groups"] = nlohmann::json::array();
    for (const auto& group : read.unused_groups)
      unused.push_back({{"dimension", group.dimension}, {"name", group.name}, {"elements", group.n_elements}});
    report["periodic_links"] = read.n_periodic_links;
    auto& cut = report["cut_elements"] = nlohmann::json::object();
    for (const auto& [type, n] : read.cut) cut[io::name_of_type(type)] = n;
  }
  report["turned_cells"] = read.n_turned;
  report["dropped_nodes"] = read.n_dropped_nodes;
  auto warnings = io::remarks_of(read);
  read.mesh.info.provenance = fmt::format("pamr-convert from {}", format.name);
  return {std::move(read.mesh), std::move(warnings), std::move(read.notes)};
}

void scale_mesh(const par::Comm& comm, mesh::DistMesh& mesh, double factor, bool needs_surfaces) {
  if (needs_surfaces && mesh.info.surfaces->size() > 0) {  // else they only count among what is left out
    if (mesh::has_level0(mesh))
      throw Error(
          "--scale: expected a mesh without a map of level 0, found one (coarse curved walls): scale what the mesh was "
          "made of");
    mesh.info.surfaces = scaled_surfaces(*mesh.info.surfaces, factor);
  }
  bool is_in_range = true;
  for (auto& p : mesh.node_position) {
    p = {factor * p.x, factor * p.y, factor * p.z};
    is_in_range = is_in_range && geometry::is_in_range(p);
  }
  if (!comm.all(is_in_range))
    throw Error(
        fmt::format("--scale: expected coordinates that stay below {}, found others", geometry::max_coordinate_text));
}

void set_kinds(const std::vector<std::string>& pairs, mesh::DistMesh& mesh) {
  auto& patches = mesh.info.patches;
  std::vector<std::string> chosen(patches.size());  // the last pair counts, and only what it takes away is lost
  for (const auto& pair : pairs) {
    const auto equals = pair.rfind('=');
    const auto name = pair.substr(0, equals), kind = equals == std::string::npos ? "" : pair.substr(equals + 1);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      throw Error(fmt::format("--kind: expected PATCH=KIND with a kind of {}, found '{}'", listed(kinds), pair));
    for (const int p : mesh::require_patches(patches, name, "--kind")) chosen[at(p)] = kind;
  }
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (chosen[p].empty()) continue;
    auto& patch = patches[p];
    patch.kind = chosen[p] == "patch" ? "" : chosen[p];
    if (mesh::is_untagged(patch)) patch = {.name = patch.name, .kind = patch.kind, .surface = patch.surface};
  }
}

}  // namespace pamr::convert
