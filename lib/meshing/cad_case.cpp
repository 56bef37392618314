// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/cad_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "meshing/cad_body.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr double default_far = 1.0 / 15;  // of the size of the shape
constexpr double default_growth = 0.35;

/// Collects faces by the names of their patches.
class Patches {
 public:
  void add(const std::string& name, std::size_t face) {
    const auto [place, is_new] = known_.try_emplace(name, part_.size());
    if (is_new) part_.push_back({name, {}});
    part_[place->second].faces.push_back(static_cast<int>(face) + 1);
  }
  bool has(const std::string& name) const { return known_.contains(name); }
  std::vector<geometry::CadPart> parts() && { return std::move(part_); }

 private:
  std::map<std::string, std::size_t> known_;
  std::vector<geometry::CadPart> part_;
};

std::string patch_name(const std::string& name, const std::string& color, int number) {
  return !name.empty() ? name : !color.empty() ? "color_" + color.substr(1) : fmt::format("face_{}", number);
}

/// The patches of a shape in the order of their first faces, with the numbers of these from 1 on.
std::vector<geometry::CadPart> patches_of(const geometry::CadModel& model) {
  Patches patches;
  for (std::size_t f = 0; f < model.faces().size(); ++f) {
    const auto& face = model.faces()[f].data();
    patches.add(patch_name(face.name, face.color, static_cast<int>(f) + 1), f);
  }
  return std::move(patches).parts();
}

/// The patches of an assembly, those between two regions behind the others.
std::vector<geometry::CadPart> patches_of(const geometry::CadAssembly& assembly) {
  Patches patches;
  for (std::size_t f = 0; f < assembly.face.size(); ++f)
    if (const auto& face = assembly.face[f]; face.region[1] < 0)
      patches.add(patch_name(face.name, face.color, face.number), f);
  std::map<std::array<int, 2>, std::string> between;
  for (std::size_t f = 0; f < assembly.face.size(); ++f) {
    const auto& sides = assembly.face[f].region;
    if (sides[1] < 0) continue;
    auto& name = between[sides];
    if (name.empty()) {
      name = assembly.region[at(sides[0])] + "_" + assembly.region[at(sides[1])];
      while (patches.has(name)) name += '_';
    }
    patches.add(name, f);
  }
  return std::move(patches).parts();
}

AssemblyRegions regions_of(const geometry::CadAssembly& assembly) {
  AssemblyRegions result;
  if (assembly.region.size() < 2) return result;
  result.name = assembly.region;
  result.of_solid = assembly.region_of_solid;
  for (const auto& face : assembly.face) result.of_face.push_back(face.region);
  return result;
}

}  // namespace

MeshCase case_of_cad(const std::filesystem::path& file, const CadRequest& request) {
  auto source = geometry::read_cad_source(file);
  auto model = geometry::make_cad_model(source, request.unit);
  MeshCase result;
  auto& c = result.combination;
  std::vector<geometry::CadPart> patches;
  if (model->n_solids() < 2 && request.solids.empty()) {
    patches = patches_of(*model);
  } else {
    auto assembly = geometry::make_cad_assembly(source, request.unit, request.solids);
    try {
      require_no_loose_faces(at(model->n_solids()), assembly.loose_face);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
    patches = patches_of(assembly);
    c.regions = regions_of(assembly);
    source = {file.stem().string() + "_solids.brep", std::move(assembly.text)};
    model = geometry::make_cad_model(source, request.unit, true);
  }
  result.shape = "surfaces";
  result.where = file.string();
  c.surfaces = std::make_shared<const geometry::SurfaceSet>(
      geometry::cad_surfaces(source, request.unit, model, patches, file.string()));
  c.region = "-" + patches.front().name;
  c.length_unit = request.unit;
  c.far = request.far > 0 ? request.far : default_far * model->size();
  c.growth = default_growth;
  if (!(request.far > 0)) c.thickness_factor = 1;  // longer ones cost the mesher more, for no fewer nodes
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
