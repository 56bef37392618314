// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/undescribed_patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/mesh/patch_list.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

namespace {

using geometry::Vec3;

bool is_described(const MeshInfo& info, int patch) { return info.patches[at(patch)].surface >= 0; }

/// Calls `visit(cell, face, patch)` for each boundary face of this rank.
template <class Visit>
void for_each_boundary_face(const DistMesh& mesh, Visit&& visit) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f)
      if (const auto next = mesh.cell_to_cell[at(c)][at(f)]; next < 0) visit(c, f, slot_to_patch(next));
}

/// What patches there are at a node, as bits.
enum Kind : std::uint8_t { without_surface = 1, on_plane = 2, on_curved_surface = 4, is_to_move = 8 };

Kind kind_of(const MeshInfo& info, int patch) {
  if (!is_described(info, patch)) return without_surface;
  const auto* surface = info.surface_of(patch);
  return surface == nullptr || surface->is_flat() ? on_plane : on_curved_surface;
}

/// Whether a patch has no surface and another one a surface that could take its nodes with it: one that is curved, or
/// off whose plane nodes are.
bool may_follow_others(const DistMesh& mesh) {
  bool is_one_without = false, is_one_on_plane = false, is_one_curved = false;
  for (std::size_t p = 0; p < mesh.info.patches.size(); ++p) {
    const auto kind = kind_of(mesh.info, static_cast<int>(p));
    is_one_without = is_one_without || kind == without_surface;
    is_one_on_plane = is_one_on_plane || kind == on_plane;
    is_one_curved = is_one_curved || kind == on_curved_surface;
  }
  const bool is_any_off = mesh.find_node_field(off_surface_field) != nullptr;
  return is_one_without && (is_one_curved || (is_one_on_plane && is_any_off));
}

/// This rank's nodes at patches without a surface that others may take with them, with all their patches: those at
/// curved patches too, and those that are off the plane of another patch. Collective.
std::map<LocalId, PatchList> find_common_nodes(const par::Comm& comm, const DistMesh& mesh, const Borders& borders) {
  std::vector<std::uint8_t> kinds(mesh.node_position.size(), 0);
  const auto add = [&](LocalId node, std::uint8_t kind) {
    kinds[at(node)] = static_cast<std::uint8_t>(kinds[at(node)] | kind);
  };
  for_each_boundary_face(mesh, [&](LocalId c, int f, int patch) {
    for (const auto corner : tet::face_to_corner[at(f)])
      add(mesh.cell_to_node[at(c)][at(corner)], kind_of(mesh.info, patch));
  });
  const auto* off = mesh.find_node_field(off_surface_field);
  if (off != nullptr && !off->holds_integers())
    for (LocalId node = 0; node < mesh.n_nodes(); ++node)
      if (off->real()[at(node)] > 0) add(node, is_to_move);
  par::fold_shared(
      par::Exchange(comm, borders.nodes), [&](LocalId node) { return kinds[at(node)]; }, add);
  const auto is_common = [](unsigned kind) {
    return (kind & without_surface) != 0 &&
           ((kind & on_curved_surface) != 0 || (kind & (on_plane | is_to_move)) == (on_plane | is_to_move));
  };
  std::map<LocalId, PatchList> common;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node)
    if (is_common(kinds[at(node)])) common.emplace(node, PatchList{-1, -1, -1, -1});
  if (comm.any(!common.empty())) add_patches_of_nodes(comm, mesh, borders, common);
  return common;
}

/// The first patch on a curved surface at both nodes; -1: none.
int common_curved_patch(const MeshInfo& info, const PatchList& a, const PatchList& b) {
  for (const auto patch : a) {
    if (patch < 0 || std::find(b.begin(), b.end(), patch) == b.end()) continue;
    const auto* surface = info.surface_of(patch);
    if (surface != nullptr && !surface->is_flat()) return patch;
  }
  return -1;
}

/// The patch on a curved surface that a boundary face continues smoothly across one of its edges; -1: none.
int patch_continued(const DistMesh& mesh, const std::map<LocalId, PatchList>& common, LocalId cell, int face) {
  const auto& corner = tet::face_to_corner[at(face)];
  std::array<LocalId, 3> node{};
  for (std::size_t k = 0; k < 3; ++k) node[k] = mesh.cell_to_node[at(cell)][at(corner[k])];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = node[k], b = node[(k + 1) % 3], c = node[(k + 2) % 3];
    const auto at_a = common.find(a), at_b = common.find(b);
    if (at_a == common.end() || at_b == common.end()) continue;
    const int patch = common_curved_patch(mesh.info, at_a->second, at_b->second);
    if (patch < 0) continue;
    if (!is_sharp_edge(mesh.point(a), mesh.point(b), mesh.point(c), *mesh.info.surface_of(patch))) return patch;
  }
  return -1;
}

/// Counts the faces of patches that are not flat and continue a curved surface. Collective: two reductions.
void count_smooth_faces(const par::Comm& comm, const DistMesh& mesh, const std::map<LocalId, PatchList>& common,
                        std::vector<UndescribedPatch>& undescribed) {
  std::vector<int> row(mesh.info.patches.size(), -1);
  for (std::size_t i = 0; i < undescribed.size(); ++i)
    if (!undescribed[i].plane.is_flat) row[at(undescribed[i].patch)] = static_cast<int>(i);
  std::vector<std::int64_t> count(undescribed.size(), 0), last(undescribed.size(), -1);
  for_each_boundary_face(mesh, [&](LocalId c, int f, int patch) {
    if (row[at(patch)] < 0) return;
    const int continued = patch_continued(mesh, common, c, f);
    if (continued < 0) return;
    ++count[at(row[at(patch)])];
    last[at(row[at(patch)])] = std::max<std::int64_t>(last[at(row[at(patch)])], continued);
  });
  comm.sum_in_place(count);
  comm.max_in_place(last);
  for (std::size_t i = 0; i < undescribed.size(); ++i) {
    undescribed[i].n_smooth_faces = count[i];
    undescribed[i].continues = static_cast<int>(last[i]);
  }
}

/// A name that no surface has.
std::string new_name(const geometry::SurfaceSet& set, const std::string& patch) {
  const auto wanted = "plane of " + patch;
  auto name = wanted;
  for (int i = 2; set.index_of(name) >= 0; ++i) name = fmt::format("{} ({})", wanted, i);
  return name;
}

}  // namespace

bool is_sharp_edge(Vec3 a, Vec3 b, Vec3 c, const geometry::Surface& surface) {
  const Vec3 of_face = cross(b - a, c - a), of_surface = surface.normal(midpoint(a, b));
  const double sine = std::sin(sharp_edge_angle * std::numbers::pi / 180);
  return norm(cross(of_face, of_surface)) >= sine * norm(of_face);
}

std::vector<UndescribedPatch> find_undescribed_patches(const par::Comm& comm, const DistMesh& mesh,
                                                       const Borders& borders) {
  if (!may_follow_others(mesh)) return {};
  const auto common = find_common_nodes(comm, mesh, borders);
  std::vector<std::int64_t> meets(mesh.info.patches.size(), 0);
  for (const auto& [node, patches] : common)
    for (const auto patch : patches)
      if (patch >= 0 && !is_described(mesh.info, patch)) meets[at(patch)] = 1;
  comm.max_in_place(meets);
  std::vector<bool> is_wanted;
  for (const auto value : meets) is_wanted.push_back(value != 0);
  const auto planes = fit_planes(comm, mesh, is_wanted);
  std::vector<UndescribedPatch> undescribed;
  for (std::size_t p = 0; p < planes.size(); ++p)
    if (is_wanted[p]) undescribed.push_back({static_cast<int>(p), planes[p], 0, -1});
  if (!undescribed.empty()) count_smooth_faces(comm, mesh, common, undescribed);
  return undescribed;
}

std::vector<UndescribedPatch> find_undescribed_patches(const par::Comm& comm, const DistMesh& mesh) {
  if (!may_follow_others(mesh)) return {};
  return find_undescribed_patches(comm, mesh, find_borders(comm, mesh));
}

MeshInfo with_planes(MeshInfo info, const std::vector<UndescribedPatch>& undescribed) {
  if (std::none_of(undescribed.begin(), undescribed.end(), [](const auto& u) { return u.plane.is_flat; })) return info;
  auto set = *info.surfaces;
  for (const auto& [patch, plane, n_smooth, continues] : undescribed) {
    if (!plane.is_flat) continue;
    auto& of_patch = info.patches[at(patch)];
    of_patch.surface = set.size();
    const std::array described{geometry::described_plane(new_name(set, of_patch.name), geometry::shortest(plane.point),
                                                         geometry::shortest(plane.normal))};
    set.append(geometry::set_of(described, described[0].name));
  }
  info.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(set));
  return info;
}

std::vector<std::string> warnings_of(const MeshInfo& info, const std::vector<UndescribedPatch>& undescribed) {
  constexpr double nearly_flat = 1e-3;  // of its size: a plane that was written with few digits
  std::vector<std::string> lines;
  for (const auto& [patch, plane, n_smooth, continues] : undescribed) {
    const auto& name = info.patches[at(patch)].name;
    if (plane.is_flat) continue;
    if (plane.distance <= nearly_flat * plane.size)
      lines.push_back(fmt::format(
          "patch '{}' has no surface and lies within {:.2g} of a plane, but not in it; to put it there write "
          "[[surface]] with {}, and --tolerance {:.2g}",
          name, plane.distance, geometry::plane_keys(name, plane.point, plane.normal, ", "), 2 * plane.distance));
    else if (n_smooth > 0)
      lines.push_back(fmt::format(
          "patch '{0}' has no surface: {1} faces of it continue patch '{2}' smoothly and are bent where new "
          "nodes go onto surface \"{3}\"; to give it its shape write [[surface]] with name = \"{0}\" and "
          "its kind, or --surface FILE.stl --patch {0}",
          name, n_smooth, info.patches[at(continues)].name, info.surface_name(info.patches[at(continues)])));
  }
  return lines;
}

}  // namespace pamr::mesh
