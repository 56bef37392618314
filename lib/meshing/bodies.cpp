// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "meshing/cad_body.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::meshing {
namespace {

const geometry::CadSurface* cad(const geometry::SurfaceSet& surfaces, int i) {
  return dynamic_cast<const geometry::CadSurface*>(surfaces.get(i));
}

/// The surface of each face of a shape.
std::vector<int> surfaces_of_faces(const geometry::SurfaceSet& surfaces, const geometry::CadModel& model) {
  std::vector<int> result(model.faces().size(), -1);
  int last = 0;
  for (int i = 0; i < surfaces.size(); ++i) {
    const auto* part = cad(surfaces, i);
    if (part == nullptr || &part->model() != &model) continue;
    last = i;
    for (const int f : part->faces()) {
      if (result[at(f)] >= 0)
        throw Error(fmt::format(
            "{}: expected each face of the shape on one surface, found face {} on \"{}\" and \"{}\": say faces, "
            "face_names or face_colors of each",
            surfaces.described_at[at(i)], f + 1, surfaces.name[at(result[at(f)])], surfaces.name[at(i)]));
      result[at(f)] = i;
    }
  }
  std::vector<std::string> missing;
  for (std::size_t f = 0; f < result.size(); ++f)
    if (result[f] < 0) missing.push_back(std::to_string(f + 1));
  if (!missing.empty())
    throw Error(
        fmt::format("{}: expected every face of the shape on a surface, found some on none: add a [[surface]] of the "
                    "same file with faces = [{}]",
                    surfaces.described_at[at(last)], listed(missing, {.most = all_items})));
  return result;
}

}  // namespace

std::vector<int> sides_of(const geometry::SurfaceSet& surfaces) {
  std::vector<int> result;
  int n = 0;
  for (int i = 0; i < surfaces.size(); ++i) {
    const auto* part = cad(surfaces, i);
    int known = -1;
    for (int j = 0; j < i && part != nullptr && known < 0; ++j)
      if (const auto* other = cad(surfaces, j); other != nullptr && &other->model() == &part->model())
        known = result[at(j)];
    result.push_back(known >= 0 ? known : n++);
  }
  return result;
}

Bodies join_bodies(const geometry::SurfaceSet& surfaces, double longest_error) {
  auto set = std::make_shared<geometry::SurfaceSet>();
  Bodies result;
  const auto side = sides_of(surfaces);
  for (int i = 0; i < surfaces.size(); ++i) {
    if (side[at(i)] < set->size()) continue;
    result.first.push_back(i);
    auto& faces = result.surface_of_face.emplace_back();
    auto surface = surfaces.surface[at(i)];
    if (const auto* part = cad(surfaces, i)) {
      faces = surfaces_of_faces(surfaces, part->model());
      try {
        surface = std::make_shared<const CadBody>(part->shared_model(), longest_error);
      } catch (const Error& error) {
        throw Error(
            fmt::format("{}: surface \"{}\": {}", surfaces.described_at[at(i)], surfaces.name[at(i)], error.what()));
      }
    }
    set->add(surfaces.name[at(i)], surfaces.described_at[at(i)], std::move(surface));
  }
  result.set = std::move(set);
  return result;
}

}  // namespace pamr::meshing
