// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/associate_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::meshing {

namespace {

constexpr const char* ledger_field = "off_surface";

double size_of(const par::Comm& comm, const mesh::DistMesh& mesh) {
  geometry::Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto p : mesh.node_position) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return geometry::norm(geometry::Vec3{comm.max(high.x), comm.max(high.y), comm.max(high.z)} -
                        geometry::Vec3{comm.min(low.x), comm.min(low.y), comm.min(low.z)});
}

mesh::Patch& patch_named(mesh::DistMesh& mesh, const std::string& name) {
  auto& patches = mesh.info.patches;
  const auto found = std::find_if(patches.begin(), patches.end(), [&](const auto& p) { return p.name == name; });
  if (found != patches.end()) return *found;
  std::string names;
  for (const auto& patch : patches) names += (names.empty() ? "" : ", ") + patch.name;
  throw Error("patch '" + name + "': expected one of the mesh's patches " + names + ", found none of that name");
}

/// Puts the names of the surfaces into the patches.
void name_surfaces(mesh::DistMesh& mesh, const geometry::SurfaceSet& surfaces, const std::vector<std::string>& pairs) {
  for (auto& patch : mesh.info.patches)
    if (surfaces.find(patch.name) != nullptr) patch.surface = patch.name;
  for (const auto& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) throw Error("--tie: expected PATCH=SURFACE, found \"" + pair + "\"");
    const auto surface = pair.substr(equals + 1);
    if (surfaces.find(surface) == nullptr)
      throw Error("--tie " + pair + ": expected the name of a surface, found \"" + surface + "\"");
    patch_named(mesh, pair.substr(0, equals)).surface = surface;
  }
  for (std::size_t i = 0; i < surfaces.name.size(); ++i)
    if (std::none_of(mesh.info.patches.begin(), mesh.info.patches.end(),
                     [&](const auto& patch) { return patch.surface == surfaces.name[i]; }))
      throw Error(surfaces.described_at[i] + ": surface \"" + surfaces.name[i] +
                  "\": expected a patch that lies on it (of the same name, or by --tie), found none");
}

std::string toml_text(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return result + "\"";
}

/// What the command line says about the creases of its files.
std::string crease_keys(const TieRequest& request) {
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

/// The surfaces asked for as text and data.
struct Described {
  std::string toml;
  std::vector<geometry::Triangulation> triangulations;
};

Described describe(const TieRequest& request) {
  Described result{request.toml, geometry::triangulations_of_toml(request.toml, request.file)};
  for (const auto& [patch, file] : request.files) {
    auto surface = geometry::read_triangulation(file);
    surface.name = patch;
    result.triangulations.push_back(std::move(surface));
    if (!result.toml.empty() && result.toml.back() != '\n') result.toml += '\n';
    result.toml += "[[surface]]\nname = " + toml_text(patch) +
                   "\nkind = \"triangulation\"\nfile = " + toml_text(std::filesystem::path(file).filename().string()) +
                   "\n" + crease_keys(request);
  }
  return result;
}

/// Local nodes of a patch.
std::vector<LocalId> nodes_of(const mesh::DistMesh& mesh, int patch) {
  std::vector<LocalId> nodes;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (mesh.cell_to_cell[static_cast<std::size_t>(c)][slot] == mesh::patch_to_slot(patch))
        for (const auto corner : mesh::tet::face_to_corner[slot])
          nodes.push_back(mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)]);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Adds distances to the ledger: of each node the largest that any rank knows, because a rank sees only the patches
/// round its own cells. Collective.
void put_into_ledger(const par::Comm& comm, mesh::DistMesh& mesh, const std::vector<double>& off) {
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
  std::erase_if(mesh.node_fields, [](const auto& field) { return field.name == ledger_field; });
  mesh.node_fields.push_back({ledger_field, mesh.info.length_unit, 1, mesh::StorageType::float64, std::move(all)});
}

/// Measures one patch and notes its nodes that are off. Collective.
Tie measure(const par::Comm& comm, const mesh::DistMesh& mesh, int patch, const geometry::Surface& surface,
            double tolerance, double size, std::vector<double>& off) {
  const auto& info = mesh.info.patches[static_cast<std::size_t>(patch)];
  Tie tie{info.name, info.surface, 0, -1, 0, {}};
  for (const auto node : nodes_of(mesh, patch)) {
    const auto p = mesh.point(node);
    const double distance = surface.distance(p);
    const double limit = tolerance >= 0 ? tolerance : 1e-6 * size + 1.5 * surface.facet_deviation(p);
    tie.worst_distance = std::max(tie.worst_distance, distance);
    tie.worst_excess = std::max(tie.worst_excess, distance - limit);
    if (!(distance > 1e-12 * size)) continue;
    ++tie.n_off;
    auto& here = off[static_cast<std::size_t>(node)];
    here = std::max(here, distance);
  }
  if (surface.has_creases()) {
    std::vector<double> off_crease(off.size(), 0.0);
    tie.creases = fit_creases(comm, mesh, patch, surface, off_crease);
    for (std::size_t n = 0; n < off.size(); ++n)
      if (off_crease[n] > 1e-12 * size) off[n] = std::max(off[n], off_crease[n]);
  }
  tie.worst_distance = comm.max(tie.worst_distance);
  tie.worst_excess = comm.max(tie.worst_excess);
  tie.n_off = comm.sum(tie.n_off);
  return tie;
}

}  // namespace

std::vector<Tie> tie_patches(const par::Comm& comm, mesh::DistMesh& mesh, const TieRequest& request) {
  geometry::SurfaceSet surfaces;
  std::vector<std::string> asked_for;
  const auto old_toml = mesh.info.surfaces_toml;
  par::agree(comm, [&] {
    auto described = describe(request);
    surfaces = geometry::surfaces_from_toml(described.toml, request.file, described.triangulations);
    auto pairs = request.pairs;
    for (const auto& [patch, file] : request.files) pairs.push_back(patch + "=" + patch);
    name_surfaces(mesh, surfaces, pairs);
    asked_for = surfaces.name;
    const bool keeps_old = std::any_of(mesh.info.patches.begin(), mesh.info.patches.end(), [&](const auto& patch) {
      return !patch.surface.empty() && surfaces.find(patch.surface) == nullptr;
    });
    if (keeps_old) {
      described.toml = old_toml + (old_toml.empty() || old_toml.back() == '\n' ? "" : "\n") + described.toml;
      for (auto& data : mesh.info.triangulations) described.triangulations.push_back(std::move(data));
      surfaces = geometry::surfaces_from_toml(described.toml, "surfaces of the mesh and " + request.file,
                                              described.triangulations);
    }
    mesh.info.surfaces_toml = std::move(described.toml);
    mesh.info.triangulations = std::move(described.triangulations);
  });
  const double size = size_of(comm, mesh);
  std::vector<double> off(mesh.node_position.size(), 0.0);
  std::vector<Tie> ties;
  for (std::size_t p = 0; p < mesh.info.patches.size(); ++p) {
    const auto& name = mesh.info.patches[p].surface;
    if (std::find(asked_for.begin(), asked_for.end(), name) != asked_for.end())
      ties.push_back(measure(comm, mesh, static_cast<int>(p), *surfaces.find(name), request.tolerance, size, off));
  }
  for (const auto& tie : ties)
    if (tie.worst_excess > 0)
      throw Error(
          fmt::format("patch '{}': expected nodes within {:.6g} of surface \"{}\", found some as far as {:.6g} "
                      "from it (--tolerance sets the bound)",
                      tie.patch, tie.worst_distance - tie.worst_excess, tie.surface, tie.worst_distance));
  put_into_ledger(comm, mesh, off);
  return ties;
}

}  // namespace pamr::meshing
