// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/coarse_edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>

#include "pamr/base/counted.hpp"
#include "pamr/base/index.hpp"
#include "pamr/curved/level0_edges.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::curved {

namespace {

/// Whether an edge of a face with a patch bulges by more than this part of it. Looks at every `stride`-th cell.
bool has_bulging_face(const mesh::DistMesh& mesh, double least, GlobalId stride) {
  const mesh::InnerPatches patches(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.cell_global[at(c)] % stride != 0) continue;
    for (std::size_t f = 0; f < 4; ++f) {
      const int patch = patches.of_any({c, static_cast<int>(f)});
      const auto* surface = patch < 0 ? nullptr : mesh.info.surface_of(patch);
      if (surface == nullptr || surface->is_flat()) continue;
      const auto& corner = mesh::tet::face_to_corner[f];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = mesh.point(mesh.cell_to_node[at(c)][at(corner[k])]);
        const auto b = mesh.point(mesh.cell_to_node[at(c)][at(corner[(k + 1) % 3])]);
        if (surface->distance(geometry::midpoint(a, b)) > least * norm(b - a)) return true;
      }
    }
  }
  return false;
}

bool has_coarse_face(const mesh::DistMesh& mesh) {
  // twice as careful: where patches meet the bulge is longer than the way to one of them
  return has_bulging_face(mesh, 0.5 * coarse_bulge, 1);
}

bool is_level0(const mesh::DistMesh& mesh) {
  return std::all_of(mesh.lineage.begin(), mesh.lineage.end(),
                     [](mesh::Lineage l) { return l.level() == 0 && !l.is_closure(); });
}

/// Length over radius of the circle through the ends and the bulge.
double in_radii(const Level0Edges& edges, std::size_t edge) {
  const auto [a, b] = edges.ends(edge);
  const double bulge = norm(edges.bulge[edge]) / norm(edges.mesh.point(b) - edges.mesh.point(a));
  return 8 * bulge / (1 + 4 * bulge * bulge);
}

}  // namespace

CoarseEdges find_coarse_edges(const par::Comm& comm, const mesh::DistMesh& mesh) {
  CoarseEdges coarse;
  if (!comm.all(is_level0(mesh)) || !comm.any(has_coarse_face(mesh))) return coarse;
  const auto borders = mesh::find_borders(comm, mesh);
  const auto edges = look_at_edges(comm, mesh, borders);
  auto longest = own_coarse_edges(edges);
  coarse.count = comm.sum(std::ssize(longest));
  coarse.is_at_cell.assign(at(mesh.n_cells()), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t e = 0; e < 6; ++e)
      if (edges.is_coarse[at(edges.edge(c, e))] != 0) coarse.is_at_cell[at(c)] = 1;
  double here = 0;
  for (const auto edge : longest) here = std::max(here, in_radii(edges, edge));
  coarse.longest = comm.max(here);
  if (coarse.count == 0) return coarse;
  std::erase_if(longest, [&](std::size_t edge) { return in_radii(edges, edge) < coarse.longest; });
  const auto middle = [&](std::size_t edge) {
    const auto [a, b] = edges.ends(edge);
    return geometry::midpoint(mesh.point(a), mesh.point(b));
  };
  for (std::size_t k = 0; k < 3; ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto edge : longest) least = std::min(least, middle(edge)[k]);
    coarse.where[k] = comm.min(least);
    std::erase_if(longest, [&](std::size_t edge) { return middle(edge)[k] != coarse.where[k]; });
  }
  return coarse;
}

std::string text_of(const CoarseEdges& coarse) {
  if (coarse.count == 0) return {};
  const auto p = coarse.where;
  return fmt::format(
      "{} longer than 0.2 of the radius of curvature, the longest {:.2f} of it near ({:.6g}, "
      "{:.6g}, {:.6g}): a map of level 0 will place new nodes there{}",
      counted(coarse.count, "edge in curved walls is", "edges in curved walls are"), coarse.longest, p.x, p.y, p.z,
      coarse.longest > longest_kept
          ? fmt::format("; beyond {} of the radius shapes may be poor: shorter edges help, or pamr-convert --repair, "
                        "which splits the cells there into eight where the map is poor",
                        longest_kept)
          : "");
}

bool needs_level0_map(const par::Comm& comm, const mesh::DistMesh& mesh, refine::Bend bend) {
  if (bend == refine::Bend::none || !comm.all(is_level0(mesh))) return false;
  return bend == refine::Bend::all || comm.any(has_coarse_face(mesh));
}

std::string trouble_without_map(const par::Comm& comm, const mesh::DistMesh& mesh) {
  constexpr GlobalId cells_to_look_at = 50000;
  const auto stride = 1 + mesh.info.n_global_cells / cells_to_look_at;
  if (comm.all(is_level0(mesh)) || !comm.any(has_bulging_face(mesh, coarse_bulge, stride))) return {};
  return "edges in curved walls are longer than 0.2 of the radius of curvature, and cells were refined without a map "
         "of "
         "level 0, as by older versions (level 0 gets a map when all is coarsened to it, or a mesh refined all over "
         "when "
         "pamr-convert IN OUT --as-level-0 makes level 0 of it)";
}

}  // namespace pamr::curved
