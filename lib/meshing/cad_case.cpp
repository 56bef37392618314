// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/cad_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr double default_far = 1.0 / 15;  // of the size of the shape
constexpr double default_growth = 0.35;

/// The patches of a shape in the order of their first faces, with the numbers of these from 1 on.
std::vector<geometry::CadPart> patches_of(const geometry::CadModel& model) {
  std::vector<geometry::CadPart> result;
  std::map<std::string, std::size_t> known;
  for (std::size_t f = 0; f < model.faces().size(); ++f) {
    const auto& face = model.faces()[f].data();
    const auto number = static_cast<int>(f) + 1;
    const auto name = !face.name.empty()    ? face.name
                      : !face.color.empty() ? "color_" + face.color.substr(1)
                                            : fmt::format("face_{}", number);
    const auto [place, is_new] = known.try_emplace(name, result.size());
    if (is_new) result.push_back({name, {}});
    result[place->second].faces.push_back(number);
  }
  return result;
}

}  // namespace

MeshCase case_of_cad(const std::filesystem::path& file, double far, const std::string& unit) {
  auto source = geometry::read_cad_source(file);
  const auto model = geometry::make_cad_model(source, unit);
  const auto patches = patches_of(*model);
  MeshCase result;
  result.shape = "surfaces";
  result.where = file.string();
  auto& c = result.combination;
  c.surfaces =
      std::make_shared<const geometry::SurfaceSet>(geometry::cad_surfaces(source, unit, model, patches, file.string()));
  c.region = "-" + patches.front().name;
  c.length_unit = unit;
  c.far = far > 0 ? far : default_far * model->size();
  c.growth = default_growth;
  if (!(far > 0)) c.thickness_factor = 1;  // longer ones cost the mesher more, for no fewer nodes
  bound_by_shapes(c);
  return result;
}

bool is_all_cad(const geometry::SurfaceSet& surfaces) {
  return std::all_of(surfaces.surface.begin(), surfaces.surface.end(), [](const auto& surface) {
    return dynamic_cast<const geometry::CadSurface*>(surface.get()) != nullptr;
  });
}

void bound_by_shapes(Combination& c) {
  constexpr double margin = 0.02;
  geometry::Box box;
  double size = 0;
  for (const auto& surface : c.surfaces->surface) {
    const auto& model = dynamic_cast<const geometry::CadSurface&>(*surface).model();
    size = std::max(size, model.size());
    for (const auto& face : model.faces()) box.merge(geometry::box_of(face.points()));
  }
  const Vec3 around = margin * size * Vec3{1, 1, 1};
  c.low = box.low - around;
  c.high = box.high + around;
}

}  // namespace pamr::meshing
