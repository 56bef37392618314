// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/read_mesh_case.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "meshing/associate/associate_surfaces.hpp"
#include "meshing/cad_case.hpp"
#include "meshing/charged_spheres.hpp"
#include "meshing/sphere_in_box.hpp"
#include "meshing/supersonic_sphere.hpp"
#include "pamr/base/case_file.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"
#include "pamr/io/text.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;
using Table = std::optional<TomlTable>;

constexpr double max_length = 1e12;
constexpr NumberRange length_range{1e-12, max_length}, growth_range{0.05, 0.8};

/// Takes the number of a key where the table and the key are there.
void take(const Table& table, std::string_view key, double& value, NumberRange range = length_range) {
  if (table) value = table->number_or(key, value, range);
}

BluntConeSizes read_blunt_cone(const TomlTable& mesh) {
  BluntConeSizes result;
  const auto sizes = mesh.find_table("sizes");
  for (const auto& limit : blunt_cone_size_limits())
    take(sizes, limit.name, result.*limit.value, {limit.low, limit.high});
  return result;
}

double read_sphere_in_box(const TomlTable& mesh) {
  double edge = default_box_size;
  take(mesh.find_table("sizes"), "edge", edge, {box_size_limits.low, box_size_limits.high});
  return edge;
}

Combination read_charged_sphere(const TomlTable& mesh) {
  ChargedSphere s;
  const auto geometry = mesh.find_table("geometry"), sizes = mesh.find_table("sizes");
  take(geometry, "radius", s.radius);
  take(geometry, "outer_radius", s.outer_radius);
  take(sizes, "far", s.far);
  take(sizes, "growth", s.growth, growth_range);
  take(sizes, "sphere", s.size_sphere);
  take(sizes, "outer", s.size_outer);
  return charged_sphere(s);
}

Combination read_charged_spheres(const TomlTable& mesh, bool has_plate) {
  ChargedSpheres s;
  if (!has_plate) s.height = 0;
  const auto geometry = mesh.find_table("geometry"), sizes = mesh.find_table("sizes");
  take(geometry, "radius", s.radius);
  take(geometry, "distance", s.distance);
  take(geometry, "half_length", s.half_length);
  take(geometry, "width", s.width);
  take(geometry, "top", s.top);
  take(sizes, "far", s.far);
  take(sizes, "growth", s.growth, growth_range);
  take(sizes, "sphere", s.size_sphere);
  take(sizes, "walls", s.size_walls);
  if (has_plate) {
    take(geometry, "height", s.height);
    take(sizes, "plate", s.size_plate);
  }
  return charged_spheres(s);
}

Combination read_supersonic_sphere(const TomlTable& mesh) {
  SupersonicSphere s;
  const auto geometry = mesh.find_table("geometry"), sizes = mesh.find_table("sizes");
  take(geometry, "radius", s.radius);
  take(geometry, "parts", s.parts, {2, 32});
  take(geometry, "inflow", s.inflow);
  take(geometry, "outflow", s.outflow);
  take(geometry, "side", s.side);
  take(sizes, "far", s.far);
  take(sizes, "growth", s.growth, growth_range);
  take(sizes, "sphere", s.size_sphere);
  return supersonic_sphere(s);
}

/// A text that files and reports can hold: neither blank nor with control characters.
std::string read_word(const TomlTable& table, std::string_view key, std::string_view expected) {
  auto word = table.text(key, expected);
  if (word.find_first_not_of(' ') == std::string::npos || !io::is_clean_text(word, ""))
    table.refuse(key, std::string(expected) + ", neither blank nor with control characters");
  return word;
}

/// One region as a text, or tables of several.
void read_regions(const TomlTable& mesh, Combination& c) {
  constexpr std::string_view sides = "\"+NAME & -NAME ...\"",
                             either = "\"+NAME & -NAME ...\", or tables [[mesh.region]]";
  if (!mesh.has_list("region")) {
    c.region = mesh.text("region", either);
    (void)regions_of(c, mesh.at("region"));
    return;
  }
  for (const auto& table : mesh.list("region"))
    c.parts.push_back(
        {read_word(table, "name", "the name of the region"), table.text("sides", sides), table.at("sides")});
  if (c.parts.empty()) mesh.refuse("region", either);
  (void)regions_of(c, mesh.at("region"));
}

void read_bounds(const TomlTable& mesh, Combination& c) {
  const auto corners = mesh.points<Vec3>("bounds", 2);
  c.low = corners[0];
  c.high = corners[1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = c.low[axis], high = c.high[axis];
    if (!(low < high && low >= -max_length && high <= max_length))
      mesh.refuse("bounds",
                  fmt::format("[lower corner, upper corner] with each coordinate of the upper one over that of the "
                              "lower one, up to {:g}",
                              max_length),
                  fmt::format("{:g} and {:g}", high, low));
  }
}

void read_sizes(const TomlTable& sizes, Combination& c) {
  constexpr double default_growth = 0.35;
  constexpr NumberRange curvature_range{0.05, 2};
  c.far = sizes.number("far", length_range);
  if (c.has_cad()) {
    c.curvature = sizes.number_or("curvature", c.curvature, curvature_range);
    c.least = sizes.number_or("least", c.least, {length_range.low, c.far});
  }
  c.growth = sizes.number_or("growth", default_growth, growth_range);
  const auto near = sizes.find_table("near");
  if (!near) return;
  for (const auto& name : near->keys()) {
    if (c.surfaces->index_of(name) < 0)
      throw Error(
          fmt::format("{}: expected names of surfaces in [mesh.sizes.near], found \"{}\"", near->at(name), name));
    c.near.emplace_back(name, near->number(name, {length_range.low, c.far}));
  }
}

Combination read_combination(const TomlTable& file, const TomlTable& mesh, const std::string& where) {
  Combination c;
  c.surfaces = std::make_shared<const geometry::SurfaceSet>(
      geometry::surfaces_of_case(file, where, [](const std::string&) { return true; }));
  if (c.surfaces->size() == 0) throw Error(where + ": expected tables [[surface]] for shape \"surfaces\", found none");
  read_regions(mesh, c);
  if (!mesh.has("bounds") && is_all_cad(*c.surfaces))
    bound_by_shapes(c);
  else
    read_bounds(mesh, c);
  read_sizes(mesh.table("sizes"), c);
  return c;
}

/// The unit of the mesh; shapes with lengths of their own have only one.
std::string read_unit(const TomlTable& mesh, const std::string& shape) {
  if (shape == "surfaces") return read_word(mesh, "length_unit", "a unit");
  const std::string unit = shape == "blunt-cone" || shape == "supersonic-sphere" ? "m" : "1";
  const auto expected = fmt::format("\"{}\" for shape \"{}\"", unit, shape);
  if (mesh.text("length_unit", expected) != unit) mesh.refuse("length_unit", expected);
  return unit;
}

}  // namespace

MeshCase read_mesh_case(std::string_view text, const std::string& where) {
  const auto file = parse_case(text, where);
  const auto mesh = file.table("mesh");
  MeshCase result;
  result.where = where;
  result.shape = mesh.word("shape", {"blunt-cone", "sphere-in-box", "charged-spheres", "sphere-pair", "charged-sphere",
                                     "supersonic-sphere", "surfaces"});
  result.seed = static_cast<std::uint32_t>(mesh.integer_or("seed", 0, 0, std::numeric_limits<std::uint32_t>::max()));
  const auto unit = read_unit(mesh, result.shape);
  const auto combination = [&] {
    if (result.shape == "surfaces") return read_combination(file, mesh, where);
    if (result.shape == "charged-sphere") return read_charged_sphere(mesh);
    if (result.shape == "supersonic-sphere") return read_supersonic_sphere(mesh);
    return read_charged_spheres(mesh, result.shape == "charged-spheres");
  };
  try {
    if (result.shape == "blunt-cone") {
      result.blunt_cone = read_blunt_cone(mesh);
      for (const auto& limit : blunt_cone_geometry_limits())
        take(mesh.find_table("geometry"), limit.name, result.cone_geometry.*limit.value, {limit.low, limit.high});
    } else if (result.shape == "sphere-in-box")
      result.box_size = read_sphere_in_box(mesh);
    else
      result.combination = combination();
  } catch (const Error& error) {  // parameters that do not go together are refused without a line
    const std::string message = error.what();
    throw Error(message.starts_with(where + ":") ? message : where + ": " + message);
  }
  result.combination.length_unit = unit;
  file.finish();
  return result;
}

geometry::SurfaceSet read_surfaces(std::string_view text, const std::string& where,
                                   const std::vector<mesh::Patch>& patches) {
  const auto file = parse_case(text, where);
  auto surfaces = geometry::surfaces_of_case(file, where, parts_with_patch(patches));
  file.finish();
  const auto tables = file.keys();
  const bool brings_text = std::any_of(surfaces.surface.begin(), surfaces.surface.end(), [](const auto& surface) {
    const auto* triangulated = dynamic_cast<const geometry::Triangulated*>(surface.get());
    return dynamic_cast<const geometry::CadSurface*>(surface.get()) != nullptr ||
           (triangulated != nullptr && triangulated->has_parts());
  });
  const bool has_surfaces_only = tables.empty() || (tables.size() == 1 && tables[0] == "surface");
  if (has_surfaces_only && !brings_text) surfaces.toml = text;
  return surfaces;
}

}  // namespace pamr::meshing
