// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/surface_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pamr/geometry/parameters.hpp"

namespace pamr::surface_mesh {

namespace {

using nlohmann::json;

constexpr std::size_t max_listed = 100;

json to_json(geometry::Vec3 p) { return json::array({p.x, p.y, p.z}); }

json to_json(const Found& found) {
  json result{{"count", found.count}};
  if (found.count > 0) result["where"] = to_json(found.where);
  return result;
}

}  // namespace

json to_json(const Description& d) {
  json result{{"points", d.n_points},
              {"triangles", d.n_triangles},
              {"box", {{"low", to_json(d.box.low)}, {"high", to_json(d.box.high)}}},
              {"area", d.area},
              {"volume", d.volume},
              {"closed", d.is_closed()},
              {"valid", d.is_surface()},
              {"body", d.is_body()},
              {"unused_points", to_json(d.unused_points)},
              {"coincident_points", to_json(d.coincident_points)},
              {"flat_triangles", to_json(d.flat_triangles)},
              {"duplicate_triangles", to_json(d.duplicate_triangles)},
              {"open_edges", to_json(d.open_edges)},
              {"non_manifold_edges", to_json(d.non_manifold_edges)},
              {"non_manifold_points", to_json(d.non_manifold_points)},
              {"turned_edges", to_json(d.turned_edges)},
              {"n_loops", d.loops.size()},
              {"n_shells", d.shells.size()},
              {"edge_length", {{"min", d.min_edge}, {"mean", d.mean_edge}, {"max", d.max_edge}}},
              {"min_angle", d.min_angle},
              {"sharp_edges", d.sharp_edges}};
  auto& loops = result["loops"] = json::array();
  for (std::size_t i = 0; i < std::min(d.loops.size(), max_listed); ++i)
    loops.push_back({{"edges", d.loops[i].n_edges},
                     {"length", d.loops[i].length},
                     {"size", d.loops[i].size},
                     {"where", to_json(d.loops[i].where)}});
  auto& shells = result["shells"] = json::array();
  for (std::size_t i = 0; i < std::min(d.shells.size(), max_listed); ++i)
    shells.push_back({{"triangles", d.shells[i].n_triangles},
                      {"area", d.shells[i].area},
                      {"volume", d.shells[i].volume},
                      {"closed", d.shells[i].is_closed},
                      {"apart", d.shells[i].is_apart},
                      {"inside_of", d.shells[i].depth},
                      {"where", to_json(d.shells[i].where)}});
  result["self_intersections"] = nullptr;
  if (d.self_intersections) result["self_intersections"] = to_json(*d.self_intersections);
  result["deviation"] = nullptr;
  if (d.deviation) result["deviation"] = {{"mean", d.deviation->mean}, {"worst", d.deviation->worst}};
  if (d.deviation && d.deviation->worst > 0) result["deviation"]["where"] = to_json(d.deviation->where);
  result["faults"] = faults_of(d);
  return result;
}

json to_json(const Repaired& r) {
  return {
      {"unused_points", r.n_unused_points},
      {"welded_points", r.n_welded_points},
      {"weld", r.weld},
      {"collapsed_triangles", r.n_collapsed},
      {"duplicate_triangles", r.n_duplicates},
      {"cut_edges", r.oriented.n_cut_edges},
      {"copied_points", r.oriented.n_new_points},
      {"turned_triangles", r.oriented.n_turned},
      {"dropped_shells", r.shells.n_shells},
      {"triangles_of_dropped_shells", r.shells.n_triangles},
      {"stitched_edges", r.n_stitched},
      {"flat_triangles", {{"collapsed", r.flat.n_collapsed}, {"flipped", r.flat.n_flipped}, {"left", r.flat.n_left}}},
      {"holes",
       {{"closed", r.holes.n_holes},
        {"max_size", r.max_hole},
        {"triangles", r.holes.n_triangles},
        {"points", r.holes.n_points},
        {"left_large", r.holes.n_large},
        {"failed", r.holes.n_failed}}},
      {"self_intersections",
       {{"pairs", r.intersections.n_pairs},
        {"pairs_left", r.intersections.n_pairs_left},
        {"removed_triangles", r.intersections.n_removed},
        {"added_triangles", r.intersections.n_added}}},
      {"turned_shells", r.turned.n_outwards + r.turned.n_inwards},
      {"shells_turned_inwards", r.turned.n_inwards},
      {"steps", steps_of(r)}};
}

json to_json(const SurfaceDistance& distance) {
  return {{"at_least", distance.at_least}, {"at_most", distance.at_most}, {"where", to_json(distance.where)}};
}

std::vector<std::string> lines_of(const Description& d) {
  const Found none;
  const auto& cuts = d.self_intersections ? *d.self_intersections : none;
  std::int64_t n_closed = 0;
  for (const auto& shell : d.shells) n_closed += shell.is_closed ? 1 : 0;
  std::vector<std::string> lines{
      fmt::format("{} triangles, {} points, {} shells ({} closed)", d.n_triangles, d.n_points, d.shells.size(),
                  n_closed),
      fmt::format("box {} to {}, area {:.10g}, volume {:.10g}", geometry::decimal(d.box.low),
                  geometry::decimal(d.box.high), d.area, d.volume),
      fmt::format("edges {:.4g} to {:.4g} (mean {:.4g}), smallest angle {:.3g} degrees at {}, {} sharp edges",
                  d.min_edge, d.max_edge, d.mean_edge, d.min_angle, geometry::decimal(d.min_angle_where),
                  d.sharp_edges),
      fmt::format("open edges {} in {} loops, non-manifold edges {} and points {}, turned edges {}", d.open_edges.count,
                  d.loops.size(), d.non_manifold_edges.count, d.non_manifold_points.count, d.turned_edges.count),
      fmt::format("points: {} unused, {} at the place of another; triangles: {} without area, {} twice; "
                  "self-intersections {}",
                  d.unused_points.count, d.coincident_points.count, d.flat_triangles.count, d.duplicate_triangles.count,
                  d.self_intersections ? fmt::format("{}", cuts.count) : "not looked for")};
  if (d.deviation)
    lines.push_back(
        fmt::format("triangles are off the smooth surface through their points by {:.3g} (mean), {:.3g} (worst)",
                    d.deviation->mean, d.deviation->worst));
  return lines;
}

}  // namespace pamr::surface_mesh
