// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/associate_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/name_pattern.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::meshing {

namespace {

/// Names of the parts of the file of a surface that divide it.
std::vector<std::string> part_names(const geometry::Surface* surface) {
  const auto* triangulated = dynamic_cast<const geometry::Triangulated*>(surface);
  return triangulated == nullptr ? std::vector<std::string>() : triangulated->part_names();
}

/// The patches that a part of a file is called after, but for that of faces without a tag, whose name nobody has given.
std::vector<int> patches_of_part(const std::vector<mesh::Patch>& patches, const std::string& part) {
  auto found = mesh::find_patches(patches, part);
  std::erase_if(found, [&](int patch) { return mesh::is_untagged(patches[at(patch)]); });
  return found;
}

/// Puts patches without a surface on that of which a part has their name, among the first `n`.
void assign_by_parts(const std::vector<mesh::Patch>& patches, const geometry::SurfaceSet& surfaces, int n,
                     std::vector<int>& assigned) {
  std::vector<int> found(assigned.size(), -1);
  for (int i = 0; i < n; ++i)
    for (const auto& part : part_names(surfaces.get(i)))
      for (const int patch : patches_of_part(patches, part)) {
        auto& here = found[at(patch)];
        if (assigned[at(patch)] < 0 && here >= 0 && here != i)
          throw Error(
              fmt::format("patch '{}': expected one surface with a part of that name, found it in \"{}\" and \"{}\": "
                          "--tie says which",
                          patches[at(patch)].name, surfaces.name[at(here)], surfaces.name[at(i)]));
        here = i;
      }
  for (std::size_t p = 0; p < found.size(); ++p)
    if (assigned[p] < 0) assigned[p] = found[p];
}

/// The options that put faces without a tag, if they lie on no surface yet, on this one; empty without such faces.
std::string hint_at_untagged(const std::vector<mesh::Patch>& patches, const std::vector<int>& assigned,
                             const geometry::SurfaceSet& surfaces, int surface) {
  const auto untagged = mesh::find_untagged(patches);
  if (untagged == patches.size() || assigned[untagged] >= 0) return {};
  const auto& patch = patches[untagged].name;
  auto text = fmt::format("; for the faces without a tag, '{}': --tie {}={}", patch, patch, surfaces.name[at(surface)]);
  // only the parts that are called as patches are known here
  if (dynamic_cast<const geometry::Triangulated*>(surfaces.get(surface)) != nullptr)
    text += fmt::format(", or --kind {}=patch where a part of its file is called so", patch);
  return text;
}

/// The surfaces that the patches are to lie on: index of the surface by patch, -1 where nothing is asked for. Of the
/// first `n_described` the names of parts count, too.
std::vector<int> assigned_surfaces(const mesh::MeshInfo& info, const geometry::SurfaceSet& surfaces,
                                   const std::vector<std::string>& pairs, int n_described) {
  const auto& patches = info.patches;
  std::vector<int> result;
  for (const auto& patch : patches) result.push_back(surfaces.index_of(patch.name));
  for (const auto& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) throw Error(fmt::format("--tie: expected PATCH=SURFACE, found \"{}\"", pair));
    const auto name = pair.substr(equals + 1);
    const int surface = surfaces.index_of(name);
    if (surface < 0) throw Error(fmt::format("--tie {}: expected the name of a surface, found \"{}\"", pair, name));
    const auto patch_name = pair.substr(0, equals);
    for (const int patch : mesh::require_patches(patches, patch_name, "patch '" + patch_name + "'"))
      result[static_cast<std::size_t>(patch)] = surface;
  }
  assign_by_parts(patches, surfaces, n_described, result);
  for (int i = 0; i < surfaces.size(); ++i)
    if (std::find(result.begin(), result.end(), i) == result.end())
      throw Error(fmt::format(
          "{}: surface \"{}\": expected a patch that lies on it (of the same name, or by --tie), "
          "found none{}",
          surfaces.described_at[at(i)], surfaces.name[at(i)], hint_at_untagged(patches, result, surfaces, i)));
  return result;
}

/// What the command line says about the creases of its files.
std::string crease_keys(const AssociationRequest& request) {
  std::string text;
  if (request.feature_angle >= 0) text += fmt::format("feature_angle = {}\n", request.feature_angle);
  if (request.creases.empty()) return text;
  text += "creases = [";
  for (const auto& polyline : request.creases) {
    text += &polyline == &request.creases.front() ? "[" : ", [";
    for (const auto& p : polyline)
      text += fmt::format("{}[{}, {}, {}]", &p == &polyline.front() ? "" : ", ", p.x, p.y, p.z);
    text += "]";
  }
  return text + "]\n";
}

/// What the surface of one of the files of triangles is called: as its patch, or as the file if several lie on it.
std::string surface_name(const std::string& patch, const std::string& file) {
  return is_name_pattern(patch) ? std::filesystem::path(file).stem().string() : patch;
}

/// Adds the surface of one of the files of triangles, divided by the parts that are chosen.
void add_file(const AssociationRequest& request, const std::string& name, const std::string& file,
              const geometry::PartChoice& is_part, geometry::SurfaceSet& set) {
  auto [triangles, parts, rest] = geometry::read_named_triangulation(file, false, is_part);
  triangles.name = name;
  const auto borders = border_edges_line(triangles, parts);
  auto data = std::make_shared<const geometry::Triangulation>(std::move(triangles));
  geometry::Triangulated::Options options;
  if (request.feature_angle >= 0) options.crease.angle = request.feature_angle;
  options.crease.given = request.creases;
  if (!parts.name.empty()) options.parts = std::make_shared<const geometry::NamedParts>(std::move(parts));
  std::shared_ptr<const geometry::Surface> surface;
  try {
    surface = std::make_shared<geometry::Triangulated>(data, options);
  } catch (const Error& error) {
    throw Error(fmt::format("--surface {}: {}", file, error.what()));
  }
  set.add(name, "--surface " + file, std::move(surface));  // whose errors name it themselves
  set.triangulations.push_back(std::move(data));
  if (!set.toml.empty() && set.toml.back() != '\n') set.toml += '\n';
  set.toml +=
      fmt::format("[[surface]]\nname = {}\nkind = \"triangulation\"\nfile = {}\n{}{}", geometry::toml_text(name),
                  geometry::toml_text(std::filesystem::path(file).filename().string()), crease_keys(request),
                  borders.empty() ? "" : borders + "\n");
}

geometry::SurfaceSet requested_surfaces(const AssociationRequest& request, const std::vector<mesh::Patch>& patches) {
  auto set = request.described;
  for (const auto& [patch, file] : request.files)
    add_file(request, surface_name(patch, file), file, parts_with_patch(patches), set);
  set.append(request.made);
  return set;
}

/// Gives the patches their new surfaces. Those that the mesh has are kept where a patch still lies on one.
void put_surfaces(const geometry::SurfaceSet& asked_for, const std::vector<int>& assigned, mesh::MeshInfo& info) {
  bool keeps_old = false;
  for (std::size_t p = 0; p < assigned.size(); ++p)
    keeps_old = keeps_old || (assigned[p] < 0 && info.patches[p].surface >= 0);
  auto set = keeps_old ? *info.surfaces : geometry::SurfaceSet{};
  const int first_new = set.size();
  set.append(asked_for);
  if (keeps_old)  // texts of CAD files may differ under one name
    (void)geometry::surfaces_from_toml(set.toml, "surfaces of the mesh with the new ones", set.triangulations);
  info.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(set));
  for (std::size_t p = 0; p < assigned.size(); ++p)
    if (assigned[p] >= 0) info.patches[p].surface = first_new + assigned[p];
}

/// Local nodes of a patch.
std::vector<LocalId> nodes_of(const mesh::DistMesh& mesh, int patch) {
  const mesh::InnerPatches patches(mesh);
  std::vector<LocalId> nodes;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (patches.of_any({c, static_cast<int>(slot)}) == patch)
        for (const auto corner : mesh::tet::face_to_corner[slot])
          nodes.push_back(mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)]);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Writes the distances as the field `off_surface`: of each node the largest that any rank knows, because a rank sees
/// only the patches around its own cells. Collective.
void write_off_surface(const par::Comm& comm, mesh::DistMesh& mesh, const std::vector<double>& off) {
  if (!comm.any(std::any_of(off.begin(), off.end(), [](double d) { return d > 0; }))) return;
  struct Entry {
    GlobalId row;
    double distance;
  };
  const auto n = mesh.info.n_global_nodes, first = mesh.info.first_id;
  par::Mailbox<Entry> box(comm);
  for (std::size_t i = 0; i < off.size(); ++i)
    if (const auto row = mesh.node_global[i] - first; off[i] > 0)
      box.add(par::block_of(row, n, comm.size()), {row, off[i]});
  const auto own = par::block_range(n, comm.rank(), comm.size());
  std::vector<double> rows(static_cast<std::size_t>(own.count()), 0.0);
  for (const auto& entry : box.send().item) {
    auto& here = rows[static_cast<std::size_t>(entry.row - own.begin)];
    here = std::max(here, entry.distance);
  }
  auto all = par::fetch_rows<double>(comm, mesh.info.node_ids(), rows, 1, mesh.node_global);
  std::erase_if(mesh.node_fields, [](const auto& field) { return field.name == mesh::off_surface_field; });
  mesh.node_fields.push_back(
      {mesh::off_surface_field, mesh.info.length_unit, 1, mesh::StorageType::float64, std::move(all)});
}

/// Measures one patch and notes its nodes that are off. Collective.
Association measure(const par::Comm& comm, const mesh::DistMesh& mesh, int patch, double tolerance, double size,
                    std::vector<double>& off) {
  const auto& info = mesh.info.patches[static_cast<std::size_t>(patch)];
  const auto& surface = *mesh.info.surface_of(patch);
  Association result{info.name, mesh.info.surface_name(info), 0, -1, 0, {}};
  for (const auto node : nodes_of(mesh, patch)) {
    const auto p = mesh.point(node);
    const double distance = surface.distance(p);
    const double limit = tolerance >= 0 ? tolerance : 1e-6 * size + 1.5 * surface.facet_deviation(p);
    result.worst_distance = std::max(result.worst_distance, distance);
    result.worst_excess = std::max(result.worst_excess, distance - limit);
    if (!(distance > 1e-12 * size)) continue;
    ++result.n_off;
    auto& here = off[static_cast<std::size_t>(node)];
    here = std::max(here, distance);
  }
  if (surface.creases() != nullptr) {
    std::vector<double> off_crease(off.size(), 0.0);
    result.creases = fit_creases(comm, mesh, patch, surface, off_crease);
    for (std::size_t n = 0; n < off.size(); ++n)
      if (off_crease[n] > 1e-12 * size) off[n] = std::max(off[n], off_crease[n]);
  }
  result.worst_distance = comm.max(result.worst_distance);
  result.worst_excess = comm.max(result.worst_excess);
  result.n_off = comm.sum(result.n_off);
  return result;
}

/// Lengths of the diagonals of the boxes about the nodes of a patch and about a surface of triangles that differ by
/// more than a factor of ten are a matter of units, most often; empty otherwise. Collective.
std::string hint_at_units(const par::Comm& comm, const mesh::DistMesh& mesh, const Association& found) {
  const auto& triangulations = mesh.info.surfaces->triangulations;
  const auto surface = std::find_if(triangulations.begin(), triangulations.end(),
                                    [&](const auto& data) { return data->name == found.surface; });
  if (surface == triangulations.end()) return {};
  geometry::Box of_patch;
  for (const auto node : nodes_of(mesh, mesh::find_patches(mesh.info.patches, found.patch).front()))
    of_patch.extend(mesh.point(node));
  const double ratio =
      geometry::box_of((*surface)->points).diagonal() / mesh::box_over_ranks(comm, of_patch).diagonal();
  if (ratio > 0.1 && ratio < 10) return {};
  return fmt::format("; the surface is about {:.3g} times {} than the patch: other units?",
                     ratio < 1 ? 1 / ratio : ratio, ratio < 1 ? "smaller" : "larger");
}

}  // namespace

geometry::PartChoice parts_with_patch(const std::vector<mesh::Patch>& patches) {
  return [patches](const std::string& name) { return !patches_of_part(patches, name).empty(); };
}

std::vector<std::string> names_of_patches_on(const geometry::SurfaceSet& surfaces) {
  auto names = surfaces.name;
  for (const auto& surface : surfaces.surface)
    for (auto& part : part_names(surface.get())) names.push_back(std::move(part));
  return names;
}

std::vector<Association> associate_surfaces(const par::Comm& comm, mesh::DistMesh& mesh,
                                            const AssociationRequest& request) {
  std::vector<int> assigned;
  par::agree(comm, [&] {
    const auto asked_for = requested_surfaces(request, mesh.info.patches);
    auto pairs = request.pairs;
    for (const auto& [patch, file] : request.files) pairs.push_back(patch + "=" + surface_name(patch, file));
    assigned = assigned_surfaces(mesh.info, asked_for, pairs, request.described.size());
    put_surfaces(asked_for, assigned, mesh.info);
    mesh::drop_level0(mesh);  // it belongs to the surfaces that it was made for
  });
  const double size = mesh::box_of_nodes(comm, mesh).diagonal();
  std::vector<double> off(mesh.node_position.size(), 0.0);
  std::vector<Association> result;
  for (std::size_t p = 0; p < assigned.size(); ++p)
    if (assigned[p] >= 0) result.push_back(measure(comm, mesh, static_cast<int>(p), request.tolerance, size, off));
  for (const auto& one : result)
    if (one.worst_excess > 0)
      throw Error(
          fmt::format("patch '{}': expected nodes within {:.6g} of surface \"{}\", found some as far as {:.6g} "
                      "from it{} (--tolerance sets the bound)",
                      one.patch, one.worst_distance - one.worst_excess, one.surface, one.worst_distance,
                      hint_at_units(comm, mesh, one)));
  write_off_surface(comm, mesh, off);
  return result;
}

}  // namespace pamr::meshing
