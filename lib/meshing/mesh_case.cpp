// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/mesh_case.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "meshing/case_text.hpp"
#include "meshing/charged_spheres.hpp"
#include "meshing/region.hpp"
#include "meshing/sphere_in_box.hpp"
#include "meshing/supersonic_sphere.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::meshing {
namespace {

struct ShapeName {
  std::string_view name;
  const char* unit;  ///< the only one, or null
};
constexpr std::array<ShapeName, 7> shapes{{{"blunt-cone", "m"},
                                           {"sphere-in-box", "1"},
                                           {"charged-spheres", "1"},
                                           {"sphere-pair", "1"},
                                           {"charged-sphere", "1"},
                                           {"supersonic-sphere", "m"},
                                           {"surfaces", nullptr}}};

std::string known_shapes() {
  std::string result;
  for (const auto& shape : shapes) result += (result.empty() ? "" : " or ") + quoted(shape.name);
  return result;
}

/// A number that a table may hold.
struct Number {
  std::string_view name;
  double* value;
  double low, high;
};
constexpr double least_length = 1e-12, greatest_length = 1e12;
Number length(std::string_view name, double& value) { return {name, &value, least_length, greatest_length}; }
Number growth(double& value) { return {"growth", &value, 0.05, 0.8}; }

/// One read of a case file.
class Reader {
 public:
  Reader(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

  MeshCase read() {
    result_.where = where_;
    const auto root = toml::parse(text_, where_);
    const auto* node = root.get("mesh");
    if (node == nullptr) throw Error(where_ + ": expected a table [mesh], found none");
    const auto& mesh = table(*node, "mesh");
    result_.shape = text(mesh, "shape", known_shapes());
    const auto shape =
        std::find_if(shapes.begin(), shapes.end(), [&](const ShapeName& s) { return s.name == result_.shape; });
    if (shape == shapes.end())
      refuse(where_, mesh.get("shape")->source(), "shape = " + known_shapes(), quoted(result_.shape));
    if (result_.shape == "surfaces") {
      read_surfaces(root, mesh);
    } else {
      read_shape(mesh);
    }
    read_unit(mesh, shape->unit);
    for (const auto& [key, value] : mesh) {
      if (key == "seed") read_seed(value);
      if (std::find(read_.begin(), read_.end(), key.str()) == read_.end())
        refuse(where_, key.source(), known_keys(), quoted(key.str()));
    }
    return std::move(result_);
  }

 private:
  std::string known_keys() const {
    std::string result = "one of the keys";
    for (std::size_t i = 0; i < read_.size(); ++i) result += (i == 0 ? " " : ", ") + read_[i];
    return result + " in [mesh]";
  }

  const toml::table& table(const toml::node& node, std::string_view name) const {
    const auto* as_table = node.as_table();
    if (as_table == nullptr) refuse(where_, node.source(), fmt::format("a table [{}]", name), shown(node));
    return *as_table;
  }

  std::string text(const toml::table& from, std::string_view key, std::string_view expected) const {
    const auto* node = from.get(key);
    if (node == nullptr) refuse(where_, from.source(), fmt::format("{} = {} in [mesh]", key, expected), "none");
    const auto value = node->value_exact<std::string>();
    if (!value) refuse(where_, node->source(), fmt::format("{} = {}", key, expected), shown(*node));
    return *value;
  }

  double number(const toml::node& node, const std::string& name, double low, double high) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !(*value >= low && *value <= high))
      refuse(where_, node.source(), fmt::format("{} between {:g} and {:g}", name, low, high), shown(node));
    return *value;
  }

  void read_unit(const toml::table& mesh, const char* unit) {
    result_.combination.length_unit = text(mesh, "length_unit", unit != nullptr ? quoted(unit) : "a unit");
    if (unit != nullptr && result_.combination.length_unit != unit)
      refuse(where_, mesh.get("length_unit")->source(), fmt::format("length_unit = \"{}\" for {}", unit, result_.shape),
             quoted(result_.combination.length_unit));
  }

  void read_seed(const toml::node& node) {
    const auto value = node.value_exact<std::int64_t>();
    constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
    if (!value || *value < 0 || *value > most)
      refuse(where_, node.source(), fmt::format("an integer seed between 0 and {}", most), shown(node));
    result_.seed = static_cast<std::uint32_t>(*value);
  }

  /// The numbers of table `name` of [mesh], where it is there; other keys than those are refused.
  void read_numbers(const toml::table& mesh, const std::string& name, const std::vector<Number>& known,
                    std::string_view inner = {}) {
    read_.push_back(name);
    const auto* node = mesh.get(name);
    if (node == nullptr) return;
    for (const auto& [key, value] : table(*node, "mesh." + name)) {
      if (!inner.empty() && key.str() == inner) continue;
      const auto found =
          std::find_if(known.begin(), known.end(), [k = key.str()](const Number& n) { return n.name == k; });
      if (found == known.end()) {
        std::string names;
        for (const auto& n : known) names += (names.empty() ? "" : ", ") + std::string(n.name);
        refuse(where_, key.source(), fmt::format("one of {} in [mesh.{}] of {}", names, name, result_.shape),
               quoted(key.str()));
      }
      *found->value = number(value, std::string(key.str()), found->low, found->high);
    }
  }

  void read_shape(const toml::table& mesh) {
    if (result_.shape == "sphere-in-box") {
      read_numbers(mesh, "sizes", {{"edge", &result_.box_size, box_size_limits.low, box_size_limits.high}});
    } else if (result_.shape == "blunt-cone") {
      std::vector<Number> sizes;
      for (const auto& l : blunt_cone_size_limits())
        sizes.push_back({l.name, &(result_.blunt_cone.*l.value), l.low, l.high});
      read_numbers(mesh, "sizes", sizes);
    } else if (result_.shape == "charged-sphere") {
      ChargedSphere s;
      read_numbers(mesh, "geometry", {length("radius", s.radius), length("outer_radius", s.outer_radius)});
      read_numbers(
          mesh, "sizes",
          {length("far", s.far), growth(s.growth), length("sphere", s.size_sphere), length("outer", s.size_outer)});
      build([&] { return charged_sphere(s); });
    } else if (result_.shape == "supersonic-sphere") {
      SupersonicSphere s;
      read_numbers(mesh, "geometry",
                   {length("radius", s.radius),
                    {"parts", &s.parts, 2, 32},
                    length("inflow", s.inflow),
                    length("outflow", s.outflow),
                    length("side", s.side)});
      read_numbers(mesh, "sizes", {length("far", s.far), growth(s.growth), length("sphere", s.size_sphere)});
      build([&] { return supersonic_sphere(s); });
    } else {
      read_charged_spheres(mesh);
    }
  }

  void read_charged_spheres(const toml::table& mesh) {
    const bool has_plate = result_.shape == "charged-spheres";
    ChargedSpheres s;
    if (!has_plate) s.height = 0;
    std::vector<Number> geometry{length("radius", s.radius), length("distance", s.distance),
                                 length("half_length", s.half_length), length("width", s.width), length("top", s.top)};
    std::vector<Number> sizes{length("far", s.far), growth(s.growth), length("sphere", s.size_sphere),
                              length("walls", s.size_walls)};
    if (has_plate) {
      geometry.push_back(length("height", s.height));
      sizes.push_back(length("plate", s.size_plate));
    }
    read_numbers(mesh, "geometry", geometry);
    read_numbers(mesh, "sizes", sizes);
    build([&] { return charged_spheres(s); });
  }

  /// What parameters do not go together is refused without a line.
  template <class Make>
  void build(const Make& make) {
    try {
      result_.combination = make();
    } catch (const Error& error) {
      throw Error(where_ + ": " + error.what());
    }
  }

  void read_surfaces(const toml::table& root, const toml::table& mesh) {
    auto& c = result_.combination;
    const auto surfaces = surfaces_of(root, text_);
    auto set = geometry::surfaces_with_files(surfaces, where_);
    if (set.name.empty()) throw Error(where_ + ": expected tables [[surface]] for shape \"surfaces\", found none");
    set.toml = set.toml.substr(set.toml.find_first_not_of('\n'));
    c.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(set));
    c.region = text(mesh, "region", "\"+NAME & -NAME ...\"");
    try {
      const Region region(c.region, c.surfaces->name, where_);
    } catch (const Error& error) {
      throw Error(with_place(error.what(), mesh.get("region")->source().begin));
    }
    read_bounds(mesh);
    c.far = c.growth = 0;
    read_numbers(mesh, "sizes", {length("far", c.far), growth(c.growth)}, "near");
    if (c.far == 0) refuse(where_, mesh.source(), "far = LENGTH in [mesh.sizes]", "none");
    if (c.growth == 0) c.growth = default_growth;
    const auto* near = mesh.get("sizes")->as_table()->get("near");
    if (near == nullptr) return;
    for (const auto& [key, value] : table(*near, "mesh.sizes.near")) {
      const std::string name(key.str());
      if (c.surfaces->find(name) == nullptr) refuse(where_, key.source(), "the name of a surface", quoted(name));
      c.near.emplace_back(name, number(value, name, least_length, c.far));
    }
  }

  /// "file: what" with line and column after the file.
  std::string with_place(const std::string& message, const toml::source_position& place) const {
    return fmt::format("{}:{}:{}{}", where_, place.line, place.column, message.substr(where_.size()));
  }

  void read_bounds(const toml::table& mesh) {
    const std::string expected = "bounds = [[x, y, z], [x, y, z]], lower and upper corner";
    const auto* node = mesh.get("bounds");
    if (node == nullptr) refuse(where_, mesh.source(), expected + " in [mesh]", "none");
    const auto* corners = node->as_array();
    std::array<std::array<double, 3>, 2> at{};
    if (corners == nullptr || corners->size() != 2) refuse(where_, node->source(), expected, shown(*node));
    for (std::size_t i = 0; i < 2; ++i) {
      const auto* corner = corners->get(i)->as_array();
      if (corner == nullptr || corner->size() != 3) refuse(where_, node->source(), expected, shown(*corners->get(i)));
      for (std::size_t k = 0; k < 3; ++k)
        at[i][k] = number(*corner->get(k), "a coordinate", -greatest_length, greatest_length);
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (!(at[0][k] < at[1][k]))
        refuse(where_, node->source(), "each coordinate of the upper corner over that of the lower one",
               fmt::format("{:g} and {:g}", at[1][k], at[0][k]));
    result_.combination.low = {at[0][0], at[0][1], at[0][2]};
    result_.combination.high = {at[1][0], at[1][1], at[1][2]};
    read_.insert(read_.end(), {"region", "bounds"});
  }

  static constexpr double default_growth = 0.35;
  std::string_view text_;
  std::string where_;
  MeshCase result_;
  std::vector<std::string> read_{"shape", "length_unit", "seed"};  ///< keys of [mesh] that this shape knows
};

}  // namespace

MeshCase case_of_shape(const std::string& shape, double size) {
  MeshCase result;
  result.shape = result.where = shape;
  if (shape == "blunt-cone") {
    if (size != 0) result.blunt_cone = BluntConeSizes::scaled_to(size);
  } else if (shape == "sphere-in-box") {
    if (size != 0) result.box_size = size;
  } else if (shape == "charged-spheres") {
    ChargedSpheres spheres;
    if (size != 0) spheres.far = size;
    result.combination = charged_spheres(spheres);
  } else if (shape == "supersonic-sphere") {
    SupersonicSphere sphere;
    sphere.far = size;
    result.combination = supersonic_sphere(sphere);
  } else {
    throw Error(
        fmt::format("expected --shape kuhn-cube, blunt-cone, sphere-in-box, charged-spheres or supersonic-sphere (more "
                    "with a case file), found \"{}\"",
                    shape));
  }
  return result;
}

MeshCase read_case(std::string_view text, const std::string& where) {
  try {
    return Reader(text, where).read();
  } catch (const toml::parse_error& error) {
    refuse(where, error.source(), "TOML", std::string(error.description()));
  }
}

Domain domain_of(const MeshCase& mesh_case) {
  if (mesh_case.shape == "blunt-cone") return blunt_cone(mesh_case.blunt_cone);
  if (mesh_case.shape == "sphere-in-box") return sphere_in_box(mesh_case.box_size);
  return combine(mesh_case.combination, mesh_case.where);
}

std::string describe(const MeshCase& mesh_case) {
  auto line = fmt::format("pamr-mesh: shape {}, seed {}, sizes", mesh_case.shape, mesh_case.seed);
  if (mesh_case.shape == "sphere-in-box") return line + fmt::format(" edge {}", mesh_case.box_size);
  if (mesh_case.shape == "blunt-cone") {
    for (const auto& limit : blunt_cone_size_limits())
      line += fmt::format(" {} {}", limit.name, mesh_case.blunt_cone.*limit.value);
    return line;
  }
  const auto& c = mesh_case.combination;
  line += fmt::format(" far {} growth {}", c.far, c.growth);
  for (const auto& [name, size] : c.near) line += fmt::format(" {} {}", name, size);
  return line + fmt::format(", bounds {} {} {} to {} {} {}, region {}", c.low.x, c.low.y, c.low.z, c.high.x, c.high.y,
                            c.high.z, c.region);
}

}  // namespace pamr::meshing
