// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/read_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "convert/formats.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/elements/element_remarks.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/medit/read_medit.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/su2/read_su2.hpp"
#include "pamr/io/ugrid/read_ugrid.hpp"
#include "pamr/io/vtk/read_vtu.hpp"
#include "pamr/mesh/find_patches.hpp"

namespace pamr::convert {

namespace {

constexpr std::array<std::string_view, 7> kinds{"wall",   "symmetry", "symmetryPlane", "farfield",
                                                "inflow", "outflow",  "patch"};

/// Collective.
mesh::DistMesh read_vtu(cli::Session& session, const ReadRequest& request, nlohmann::json& report) {
  auto read = io::read_vtu(session.comm(), request.file);
  report["turned_cells"] = read.n_turned;
  report["dropped_nodes"] = read.n_dropped_nodes;
  if (request.strict && read.n_turned + read.n_dropped_nodes > 0)
    throw Error(fmt::format("file '{}': expected no inverted cells and no nodes of no cell, found {} and {}",
                            request.file, read.n_turned, read.n_dropped_nodes));
  if (read.n_turned > 0) session.warn(fmt::format("{} inverted cells were turned over", read.n_turned));
  if (read.n_dropped_nodes > 0) session.warn(fmt::format("{} nodes of no cell were left out", read.n_dropped_nodes));
  read.mesh.info.provenance = "pamr-convert from VTK";
  return std::move(read.mesh);
}

/// Collective.
io::ElementMesh read_elements(const par::Comm& comm, const ReadRequest& request, const std::string& ending) {
  const io::ElementOptions options{.repair = request.repair && !request.strict};
  if (ending == ".su2") return io::read_su2(comm, request.file, options);
  if (ending == ".ugrid") return io::read_ugrid(comm, request.file, options);
  if (is_medit_file(request.file))
    return io::read_medit(comm, request.file, {options, request.solution, request.field_names});
  return io::read_gmsh(comm, request.file, options);
}

std::string program_of(const std::string& ending) {
  return ending == ".su2" ? "SU2" : ending == ".ugrid" ? "UGRID" : ending == ".msh" ? "Gmsh" : "Medit";
}

/// What `--strict` does not accept.
void refuse_changes(const io::ElementMesh& read, const std::string& file) {
  const auto refuse = [&](std::int64_t n, const char* text) {
    if (n > 0) throw Error(fmt::format("file '{}': expected ", file) + fmt::format(fmt::runtime(text), n));
  };
  for (const auto& [dimension, kept, other, n] : read.overlaps)
    throw Error(fmt::format("file '{}': expected elements in one group each, found {} {} in '{}' and in '{}'", file, n,
                            dimension == 2 ? "triangles" : "tetrahedra", kept, other));
  for (const auto& [group, n] : read.inner_faces)
    throw Error(
        fmt::format("file '{}': expected surfaces on the boundary, found {} triangles of '{}' between two regions",
                    file, n, group));
  refuse(read.n_periodic_links, "no periodic links, found {}");
  refuse(read.n_dropped_nodes, "nodes that belong to cells, found {} others");
  refuse(read.n_untagged_faces, "a triangle on every boundary face, found {} faces without");
  refuse(read.n_turned, "cells of positive volume, found {} inverted ones");
}

}  // namespace

mesh::DistMesh read_mesh(cli::Session& session, const ReadRequest& request, nlohmann::json& report) {
  const auto& comm = session.comm();
  const auto ending = ending_of_input(request.file);
  if (ending == ".vtu") return read_vtu(session, request, report);
  if (is_native_file(request.file)) {
    const std::function<void(const std::string&)> refuse = [](const auto& remark) { throw Error(remark); };
    return assemble::assemble(comm, io::read_native(comm, request.file,
                                                    {.build_surfaces = request.build_surfaces,
                                                     .remark = request.strict ? refuse : session.remarks()}));
  }
  auto read = read_elements(comm, request, ending);
  if (request.strict) refuse_changes(read, request.file);
  auto& overlaps = report["group_overlaps"] = nlohmann::json::array();
  for (const auto& [dimension, kept, other, n] : read.overlaps)
    overlaps.push_back({{"dimension", dimension}, {"kept", kept}, {"other", other}, {"elements", n}});
  auto& inner = report["inner_faces"] = nlohmann::json::object();
  for (const auto& [group, n] : read.inner_faces) inner[group] = n;
  report["turned_cells"] = read.n_turned;
  report["dropped_nodes"] = read.n_dropped_nodes;
  report["untagged_faces"] = read.n_untagged_faces;
  report["periodic_links"] = read.n_periodic_links;
  for (const auto& remark : io::remarks_of(read)) session.warn(remark);
  read.mesh.info.provenance = "pamr-convert from " + program_of(ending);
  return std::move(read.mesh);
}

void scale_mesh(const par::Comm& comm, mesh::DistMesh& mesh, double factor, bool needs_surfaces) {
  if (mesh.info.surfaces->size() > 0) {
    if (needs_surfaces)
      throw Error(
          "--scale: expected a mesh without surfaces, which would stay as they are, found some: scale what the mesh "
          "was made of, or convert to a format without surfaces");
    mesh.info.surfaces = geometry::no_surfaces();
    for (auto& patch : mesh.info.patches) patch.surface = -1;
  }
  bool is_finite = true;
  for (auto& p : mesh.node_position) {
    p = {factor * p.x, factor * p.y, factor * p.z};
    is_finite = is_finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  if (!comm.all(is_finite)) throw Error("--scale: expected coordinates that stay finite, found others");
}

void set_kinds(const std::vector<std::string>& pairs, mesh::DistMesh& mesh) {
  for (const auto& pair : pairs) {
    const auto equals = pair.rfind('=');
    const auto name = pair.substr(0, equals), kind = equals == std::string::npos ? "" : pair.substr(equals + 1);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      std::string list;
      for (const auto known : kinds) list += (list.empty() ? "" : ", ") + std::string(known);
      throw Error(fmt::format("--kind: expected PATCH=KIND with a kind of {}, found '{}'", list, pair));
    }
    auto& patches = mesh.info.patches;
    for (const int patch : mesh::require_patches(patches, name, "--kind"))
      patches[at(patch)].kind = kind == "patch" ? "" : kind;
  }
}

}  // namespace pamr::convert
