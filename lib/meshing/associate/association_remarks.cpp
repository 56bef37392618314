// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/association_remarks.hpp"

#include <fmt/format.h>

#include <utility>

#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace pamr::meshing {

namespace {

/// Whether named parts divide a surface.
bool is_divided(const geometry::Surface* surface) {
  const auto* triangulated = dynamic_cast<const geometry::Triangulated*>(surface);
  return triangulated != nullptr && triangulated->has_parts();
}

}  // namespace

std::vector<std::string> remarks_on(const std::vector<Association>& associations,
                                    const geometry::SurfaceSet& surfaces) {
  std::vector<std::string> remarks;
  for (const auto& found : associations) {
    if (found.creases && found.creases->n_across > 0)
      remarks.push_back(fmt::format(
          "patch '{}': {} edges of the mesh run across {} of surface \"{}\" (up to {:.3g} from "
          "them), not along them: the sharp edges are rounded there",
          found.patch, found.creases->n_across,
          is_divided(surfaces.find(found.surface)) ? "sharp edges, or borders of named parts," : "sharp edges",
          found.surface, found.creases->worst_across));
    if (found.n_off > 0)
      remarks.push_back(
          fmt::format("patch '{}': nodes up to {:.3g} off surface \"{}\": the next refinement at them brings "
                      "them there",
                      found.patch, found.worst_distance, found.surface));
  }
  for (auto& remark : surfaces.remarks()) remarks.push_back(std::move(remark));
  for (const auto& surface : surfaces.triangulations)
    if (auto warning = geometry::self_intersection_warning(*surface, geometry::find_self_intersections(*surface));
        !warning.empty())
      remarks.push_back(std::move(warning));
  return remarks;
}

}  // namespace pamr::meshing
