// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/case_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <limits>

#include "mesh/charged_spheres.hpp"
#include "mesh/sphere_in_box.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

constexpr const char* shapes = "\"blunt-cone\" or \"sphere-in-box\"";

[[noreturn]] void refuse(const std::string& where, const toml::source_region& source, const std::string& expected,
                         const std::string& found) {
  throw Error(fmt::format("{}:{}: expected {}, found {}", where, source.begin.line, expected, found));
}

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

/// What a node holds, for a message.
std::string shown(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return quoted(*text);
  if (const auto integer = node.value_exact<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto real = node.value_exact<double>()) return fmt::format("{:g}", *real);
  if (const auto truth = node.value_exact<bool>()) return *truth ? "true" : "false";
  return node.is_table() ? "a table" : node.is_array() ? "an array" : "a date or time";
}

/// One read of a case file.
class Reader {
 public:
  explicit Reader(std::string where) : where_(std::move(where)) {}

  MeshCase read(const toml::table& root) {
    const auto* node = root.get("mesh");
    if (node == nullptr) throw Error(where_ + ": expected a table [mesh], found none");
    const auto& mesh = table(*node, "mesh");
    result_.shape = text(mesh, "shape", shapes);
    if (result_.shape != "blunt-cone" && result_.shape != "sphere-in-box")
      refuse(where_, mesh.get("shape")->source(), std::string("shape = ") + shapes, quoted(result_.shape));
    for (const auto& [key, value] : mesh) read_key(key, value);
    if (mesh.get("length_unit") == nullptr)
      refuse(where_, mesh.source(), "length_unit = " + quoted(unit()) + " in [mesh]", "none");
    return result_;
  }

 private:
  const char* unit() const { return result_.shape == "blunt-cone" ? "m" : "1"; }

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

  double number(const toml::key& key, const toml::node& node, double low, double high) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !(*value >= low && *value <= high))
      refuse(where_, node.source(), fmt::format("{} between {:g} and {:g}", key.str(), low, high), shown(node));
    return *value;
  }

  void read_key(const toml::key& key, const toml::node& node) {
    if (key == "shape") return;
    if (key == "length_unit") {
      if (node.value_exact<std::string>() != unit())
        refuse(where_, node.source(), fmt::format("length_unit = \"{}\" for {}", unit(), result_.shape), shown(node));
    } else if (key == "seed") {
      const auto value = node.value_exact<std::int64_t>();
      constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
      if (!value || *value < 0 || *value > most)
        refuse(where_, node.source(), fmt::format("an integer seed between 0 and {}", most), shown(node));
      result_.seed = static_cast<std::uint32_t>(*value);
    } else if (key == "sizes") {
      for (const auto& [name, value] : table(node, "mesh.sizes")) read_size(name, value);
    } else {
      refuse(where_, key.source(), "shape, length_unit, seed or sizes in [mesh]", quoted(key.str()));
    }
  }

  void read_size(const toml::key& key, const toml::node& node) {
    std::string known;
    if (result_.shape == "sphere-in-box") {
      if (key == "edge") {
        result_.box_size = number(key, node, box_size_limits.low, box_size_limits.high);
        return;
      }
      known = "edge";
    } else {
      for (const auto& limit : blunt_cone_size_limits()) {
        if (key == limit.name) {
          result_.blunt_cone.*limit.value = number(key, node, limit.low, limit.high);
          return;
        }
        known += (known.empty() ? "" : ", ") + std::string(limit.name);
      }
    }
    refuse(where_, key.source(), fmt::format("one of the sizes {} of {}", known, result_.shape), quoted(key.str()));
  }

  std::string where_;
  MeshCase result_;
};

}  // namespace

MeshCase case_of_shape(const std::string& shape, double size) {
  MeshCase result;
  result.shape = shape;
  if (shape == "blunt-cone") {
    if (size != 0) result.blunt_cone = BluntConeSizes::scaled_to(size);
  } else if (shape == "sphere-in-box") {
    if (size != 0) result.box_size = size;
  } else if (shape == "charged-spheres") {
    ChargedSpheres spheres;
    if (size != 0) spheres.far = size;
    result.combination = charged_spheres(spheres);
  } else {
    throw Error(
        fmt::format("expected --shape kuhn-cube, blunt-cone, sphere-in-box or charged-spheres, found \"{}\"", shape));
  }
  return result;
}

MeshCase read_case(std::string_view text, const std::string& where) {
  try {
    return Reader(where).read(toml::parse(text, where));
  } catch (const toml::parse_error& error) {
    refuse(where, error.source(), "TOML", std::string(error.description()));
  }
}

Domain domain_of(const MeshCase& mesh_case) {
  if (mesh_case.shape == "blunt-cone") return blunt_cone(mesh_case.blunt_cone);
  if (mesh_case.shape == "sphere-in-box") return sphere_in_box(mesh_case.box_size);
  return combine(mesh_case.combination, mesh_case.shape);
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
  return line + fmt::format(", region {}", c.region);
}

}  // namespace pamr::meshing
