// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/coarse_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/level0.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/curved/coarse_edges.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::convert {

namespace {

/// Smallest mean ratio of the map's Jacobian from which on shapes kept 0.33 at four levels in all runs, edges of two radii too.
constexpr double good_map = 0.4;
/// Share of the smallest mean ratio that splitting must keep to be of use.
constexpr double kept_shape = 0.7;

/// Collective.
double smallest_mean_ratio(const par::Comm& comm, const mesh::DistMesh& mesh) {
  double smallest = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) smallest = std::min(smallest, geometry::mean_ratio(mesh.points(c)));
  return comm.min(smallest);
}

/// Splits the cells at coarse walls, if shapes need it. Collective.
void split_at_coarse_walls(cli::Session& session, const curved::CoarseEdges& coarse, mesh::DistMesh& mesh,
                           nlohmann::json& report) {
  const auto& comm = session.comm();
  const refine::Options how{.parent_field = false};
  auto ready = adapt::with_level0_map(comm, mesh, how);
  const double least = coarse.longest > curved::longest_kept ? good_map : 0;
  if (ready.mesh.get().info.level0 == nullptr || ready.level0.smallest > least) return;
  const double before = smallest_mean_ratio(comm, mesh);
  auto split = adapt::refine(comm, std::move(ready.mesh), coarse.is_at_cell, how).mesh;
  const double after = smallest_mean_ratio(comm, split);
  if (after < kept_shape * before) {
    session.warn(fmt::format(
        "cells at these walls were not split: the smallest mean ratio would be {:.3f}, which is {:.3f} now; "
        "make level 0 with shorter edges there",
        after, before));
    return;
  }
  const auto n_split = comm.sum(std::accumulate(coarse.is_at_cell.begin(), coarse.is_at_cell.end(), std::int64_t{0}));
  report["split_cells"] = n_split;
  session.warn(
      fmt::format("{} split into eight, and the mesh is level 0 now: {} cells became {}, their smallest "
                  "mean ratio {:.3f}, which was {:.3f}",
                  counted(n_split, "cell at these walls was", "cells at these walls were"), mesh.info.n_global_cells,
                  split.info.n_global_cells, after, before));
  mesh = std::move(split);
  adapt::make_level0(mesh);
  mesh.info.provenance += "; split at coarse walls";
}

}  // namespace

void forget_levels(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  if (!options.as_level0) return;
  const auto is_refined = [](mesh::Lineage lineage) { return lineage != mesh::Lineage{}; };
  report["refined_cells"] = session.comm().sum(std::count_if(mesh.lineage.begin(), mesh.lineage.end(), is_refined));
  adapt::make_level0(mesh);
}

void treat_coarse_walls(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  const auto& comm = session.comm();
  if (!asks_for_surfaces(options) || !options.to->is_native) return;
  const auto coarse = curved::find_coarse_edges(comm, mesh);
  const auto p = coarse.where;
  report["coarse_walls"] = {{"edges", coarse.count}, {"longest", coarse.longest}, {"where", {p.x, p.y, p.z}}};
  if (coarse.count == 0) return;
  session.note(curved::text_of(coarse));
  if (options.repair && !options.strict) split_at_coarse_walls(session, coarse, mesh, report);
}

}  // namespace pamr::convert
