// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/repair.hpp"

#include <fmt/format.h>

#include <utility>

namespace pamr::surface_mesh {

Repaired repair(geometry::Triangulation surface, const RepairOptions& options) {
  constexpr double weld_part = 1e-7, hole_part = 0.1;
  Repaired done;
  done.n_unused_points = drop_unused(surface);
  const double diagonal = describe(surface, {.find_self_intersections = false, .find_deviation = false}).diagonal();
  done.weld = options.weld < 0 ? weld_part * diagonal : options.weld;
  done.max_hole = options.max_hole < 0 ? hole_part * diagonal : options.max_hole;
  done.n_welded_points = weld(surface, done.weld);
  done.n_collapsed = drop_collapsed(surface);
  done.n_duplicates = drop_duplicates(surface);
  (void)drop_unused(surface);  // those of dropped triangles
  done.oriented = orient_and_part(surface);
  done.shells = drop_small_shells(surface, options.min_shell_area);
  done.n_stitched = stitch(surface);
  done.flat = mend_flat(surface);
  done.holes = close_holes(surface, done.max_hole);
  if (options.resolve_intersections && done.flat.n_left == 0) done.intersections = resolve_intersections(surface);
  if (done.flat.n_left == 0) done.turned = turn_shells(surface);
  done.left = describe(surface, {.feature_angle = options.feature_angle});
  done.surface = std::move(surface);
  return done;
}

bool Repaired::has_changed() const { return !steps_of(*this).empty(); }

std::vector<std::string> steps_of(const Repaired& r) {
  std::vector<std::string> steps;
  const auto add = [&](std::int64_t n, const std::string& text) {
    if (n > 0) steps.push_back(text);
  };
  add(r.n_unused_points, fmt::format("unused points dropped: {}", r.n_unused_points));
  add(r.n_welded_points, fmt::format("points welded to others within {:.3g}: {}", r.weld, r.n_welded_points));
  add(r.n_collapsed, fmt::format("triangles with a point twice dropped: {}", r.n_collapsed));
  add(r.n_duplicates, fmt::format("duplicate triangles dropped: {}", r.n_duplicates));
  add(r.oriented.n_cut_edges, fmt::format("edges with more than two triangles cut: {}", r.oriented.n_cut_edges));
  add(r.oriented.n_new_points, fmt::format("points copied to part triangles: {}", r.oriented.n_new_points));
  add(r.oriented.n_turned, fmt::format("triangles turned over: {}", r.oriented.n_turned));
  add(r.shells.n_shells,
      fmt::format("small shells dropped: {} (triangles: {})", r.shells.n_shells, r.shells.n_triangles));
  add(r.n_stitched, fmt::format("pairs of open edges stitched: {}", r.n_stitched));
  add(r.flat.n_collapsed + r.flat.n_flipped,
      fmt::format("edges of triangles without area collapsed: {}, flipped: {}", r.flat.n_collapsed, r.flat.n_flipped));
  add(r.holes.n_holes, fmt::format("holes up to {:.3g} closed: {} (new triangles: {}, points: {})", r.max_hole,
                                   r.holes.n_holes, r.holes.n_triangles, r.holes.n_points));
  add(r.intersections.n_removed,
      fmt::format("triangles replaced where some cut each other: {} by {} (pairs before: {}, left: {})",
                  r.intersections.n_removed, r.intersections.n_added, r.intersections.n_pairs,
                  r.intersections.n_pairs_left));
  add(r.turned.n_outwards, fmt::format("shells turned outwards: {}", r.turned.n_outwards));
  add(r.turned.n_inwards, fmt::format("shells inside of others turned inwards: {}", r.turned.n_inwards));
  return steps;
}

}  // namespace pamr::surface_mesh
