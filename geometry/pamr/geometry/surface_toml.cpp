// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface_toml.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/cone.hpp"
#include "pamr/geometry/cylinder.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/polynomial.hpp"
#include "pamr/geometry/quadric.hpp"
#include "pamr/geometry/revolution.hpp"
#include "pamr/geometry/sphere.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/torus.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace pamr::geometry {

namespace {

constexpr std::string_view kinds =
    "plane, sphere, cylinder, cone, torus, quadric, revolution, polynomial or triangulation";

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array of " + std::to_string(node.as_array()->size());
    case toml::node_type::string:
      return "the text \"" + node.as_string()->get() + "\"";
    case toml::node_type::integer:
      return decimal(static_cast<double>(node.as_integer()->get()));
    case toml::node_type::floating_point:
      return decimal(node.as_floating_point()->get());
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "true" : "false";
    default:
      return "a date or time";
  }
}

/// file:line:column
std::string place_in(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line) + ":" + std::to_string(source.begin.column);
}

/// Reads the keys of one table; errors name the file, the line and the table.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string where, std::string context)
      : table_(table), where_(std::move(where)), context_(std::move(context)) {}

  [[noreturn]] void fail(const toml::source_region& place, const std::string& message) const {
    throw Error(place_in(where_, place) + ": " + context_ + ": " + message);
  }
  [[noreturn]] void fail(const std::string& message) const { fail(table_.source(), message); }

  bool has(std::string_view key) const { return table_.contains(key); }

  /// The value of the key with which a message begins ("radius: expected", "profile piece 2"); the table without one.
  const toml::source_region& place_of(std::string_view message) const {
    const std::string key(message.substr(0, message.find_first_of(": ")));
    for (const auto& name : {key, key + "s"})
      if (const toml::node* node = table_.get(name); node != nullptr) return node->source();
    return table_.source();
  }

  const toml::node& required(std::string_view key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) fail("expected the key " + std::string(key) + ", found none");
    return *node;
  }

  double number(std::string_view key) const { return finite(required(key), key); }

  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key) const {
    const toml::node& node = required(key);
    const toml::array* values = node.as_array();
    if (values == nullptr || values->size() != N)
      fail(node.source(), std::string(key) + ": expected " + std::to_string(N) + " numbers, found " + kind_of(node));
    std::array<double, N> result{};
    for (std::size_t i = 0; i < N; ++i) result[i] = finite((*values)[i], key);
    return result;
  }

  Vec3 vector(std::string_view key) const {
    const auto values = numbers<3>(key);
    return {values[0], values[1], values[2]};
  }

  /// An array of arrays of two points or more.
  std::vector<std::vector<Vec3>> polylines(std::string_view key) const {
    const toml::node& node = required(key);
    const auto refuse = [&](const toml::node& what) {
      fail(what.source(),
           std::string(key) + ": expected polylines [[[x, y, z], [x, y, z], ...], ...], found " + kind_of(what));
    };
    std::vector<std::vector<Vec3>> result;
    if (!node.is_array()) refuse(node);
    for (const toml::node& line : *node.as_array()) {
      if (!line.is_array() || line.as_array()->size() < 2) refuse(line);
      auto& read = result.emplace_back();
      for (const toml::node& point : *line.as_array()) {
        const toml::array* x = point.as_array();
        if (x == nullptr || x->size() != 3) refuse(point);
        read.push_back({finite((*x)[0], key), finite((*x)[1], key), finite((*x)[2], key)});
      }
    }
    return result;
  }

  Meridian meridian(std::string_view key) const {
    const auto values = numbers<2>(key);
    return {values[0], values[1]};
  }

  std::string text(std::string_view key) const {
    const toml::node& node = required(key);
    if (!node.is_string() || node.as_string()->get().empty())
      fail(node.source(), std::string(key) + ": expected a text that is not empty, found " + kind_of(node));
    return node.as_string()->get();
  }

  bool truth(std::string_view key) const {
    const toml::node& node = required(key);
    if (!node.is_boolean()) fail(node.source(), std::string(key) + ": expected true or false, found " + kind_of(node));
    return node.as_boolean()->get();
  }

  const toml::array& tables(std::string_view key) const {
    const toml::node& node = required(key);
    const toml::array* values = node.as_array();
    if (values == nullptr || values->empty() ||
        !std::all_of(values->begin(), values->end(), [](const toml::node& item) { return item.is_table(); }))
      fail(node.source(), std::string(key) + ": expected an array of one table or more, found " + kind_of(node));
    return *values;
  }

  void refuse_keys_but(std::initializer_list<std::string_view> known) const {
    std::string list;
    for (const std::string_view key : known) list += (list.empty() ? "" : ", ") + std::string(key);
    for (const auto& [key, node] : table_)
      if (std::find(known.begin(), known.end(), key.str()) == known.end())
        fail(key.source(), "expected only the keys " + list + ", found " + std::string(key.str()));
  }

 private:
  double finite(const toml::node& node, std::string_view key) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail(node.source(), std::string(key) + ": expected a finite number, found " + kind_of(node));
    return *value;
  }

  const toml::table& table_;
  std::string where_, context_;
};

std::vector<ProfilePiece> read_profile(const TableReader& surface, const std::string& where,
                                       const std::string& context) {
  std::vector<ProfilePiece> profile;
  for (const toml::node& node : surface.tables("profile")) {
    const TableReader piece(*node.as_table(), where, context + ": profile piece " + std::to_string(profile.size() + 1));
    piece.refuse_keys_but({"from", "to", "center", "clockwise"});
    ProfilePiece& read = profile.emplace_back(ProfilePiece{piece.meridian("from"), piece.meridian("to"), {}});
    if (piece.has("center")) read.arc = ProfileArc{piece.meridian("center"), {}};
    if (!piece.has("clockwise")) continue;
    if (!read.arc) piece.fail("expected the key center beside clockwise, found none");
    read.arc->clockwise = piece.truth("clockwise");
  }
  return profile;
}

std::vector<PolynomialSegment> read_segments(const TableReader& surface, const std::string& where,
                                             const std::string& context) {
  std::vector<PolynomialSegment> segments;
  for (const toml::node& node : surface.tables("segments")) {
    const TableReader piece(*node.as_table(), where, context + ": segment " + std::to_string(segments.size() + 1));
    piece.refuse_keys_but({"x", "y", "z", "u", "v"});
    const auto x = piece.numbers<6>("x"), y = piece.numbers<6>("y"), z = piece.numbers<6>("z");
    PolynomialSegment& read = segments.emplace_back();
    for (std::size_t i = 0; i < 6; ++i) read.coefficient[i] = {x[i], y[i], z[i]};
    read.u = piece.numbers<2>("u");
    read.v = piece.numbers<2>("v");
  }
  return segments;
}

/// The triangles of a surface of that name, asked for by its table.
using FindTriangles = std::function<std::shared_ptr<const Triangulation>(const TableReader& table, bool open_allowed)>;

/// The file must be named even when the triangles come from elsewhere.
std::shared_ptr<const Surface> read_triangulated(const TableReader& table, const FindTriangles& find_triangles) {
  table.refuse_keys_but({"name", "kind", "file", "feature_angle", "creases", "shortest_crease", "open", "near"});
  table.text("file");
  Triangulated::Options options;
  if (table.has("feature_angle")) options.crease.angle = table.number("feature_angle");
  if (table.has("creases")) options.crease.given = table.polylines("creases");
  if (table.has("shortest_crease")) options.crease.shortest = table.number("shortest_crease");
  if (table.has("open")) options.open_allowed = table.truth("open");
  if (table.has("near")) options.near = table.vector("near");
  return std::make_shared<Triangulated>(find_triangles(table, options.open_allowed), options);
}

std::shared_ptr<const Surface> read_surface(const TableReader& table, const std::string& where,
                                            const std::string& context, const FindTriangles& find_triangles) {
  const std::string kind = table.text("kind");
  if (kind == "plane") {
    table.refuse_keys_but({"name", "kind", "point", "normal"});
    return std::make_shared<Plane>(table.vector("point"), table.vector("normal"));
  }
  if (kind == "sphere") {
    table.refuse_keys_but({"name", "kind", "center", "radius"});
    return std::make_shared<Sphere>(table.vector("center"), table.number("radius"));
  }
  if (kind == "cylinder") {
    table.refuse_keys_but({"name", "kind", "point", "axis", "radius"});
    return std::make_shared<Cylinder>(table.vector("point"), table.vector("axis"), table.number("radius"));
  }
  if (kind == "cone") {
    table.refuse_keys_but({"name", "kind", "apex", "axis", "half_angle"});
    return std::make_shared<Cone>(table.vector("apex"), table.vector("axis"), table.number("half_angle"));
  }
  if (kind == "torus") {
    table.refuse_keys_but({"name", "kind", "center", "axis", "major_radius", "minor_radius"});
    return std::make_shared<Torus>(table.vector("center"), table.vector("axis"), table.number("major_radius"),
                                   table.number("minor_radius"));
  }
  if (kind == "revolution") {
    table.refuse_keys_but({"name", "kind", "origin", "axis", "profile"});
    return std::make_shared<Revolution>(table.vector("origin"), table.vector("axis"),
                                        read_profile(table, where, context));
  }
  if (kind == "quadric") {
    table.refuse_keys_but({"name", "kind", "coefficients"});
    return std::make_shared<Quadric>(table.numbers<10>("coefficients"));
  }
  if (kind == "polynomial") {
    table.refuse_keys_but({"name", "kind", "segments"});
    return std::make_shared<Polynomial>(read_segments(table, where, context));
  }
  if (kind == "triangulation") return read_triangulated(table, find_triangles);
  table.fail(table.required("kind").source(), "kind: expected " + std::string(kinds) + ", found \"" + kind + "\"");
}

toml::table parse(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw Error(place_in(file, error.source()) + ": expected TOML, found: " + std::string(error.description()));
  }
}

/// Calls `use(reader, name, context)` for each surface; errors that do not name the file get file and line.
template <class Use>
void for_each_surface(const toml::table& root, const std::string& file, const Use& use) {
  const TableReader top(root, file, "surfaces");
  top.refuse_keys_but({"surface"});
  if (!top.has("surface")) return;
  int n = 0;
  for (const toml::node& node : top.tables("surface")) {
    const toml::table& table = *node.as_table();
    const std::string name = TableReader(table, file, "surface " + std::to_string(++n)).text("name");
    const std::string context = "surface \"" + name + "\"";
    const TableReader reader(table, file, context);
    try {
      use(reader, name, context);
    } catch (const Error& error) {
      const std::string message = error.what();
      if (message.starts_with(file + ":")) throw;
      reader.fail(reader.place_of(message), message);
    }
  }
}

SurfaceSet read_set(std::string_view text, const std::string& file, const FindTriangles& find_triangles) {
  const auto root = parse(text, file);
  SurfaceSet set;
  set.toml = text;
  for_each_surface(root, file, [&](const TableReader& reader, const std::string& name, const std::string& context) {
    set.add(name, place_in(file, reader.required("name").source()),
            read_surface(reader, file, context, find_triangles));
  });
  return set;
}

}  // namespace

SurfaceSet surfaces_from_toml(std::string_view text, std::string_view where,
                              std::vector<std::shared_ptr<const Triangulation>> triangulations) {
  auto set = read_set(text, std::string(where), [&](const TableReader& table, bool) {
    const auto name = table.text("name");
    const auto data = std::find_if(triangulations.begin(), triangulations.end(),
                                   [&](const auto& candidate) { return candidate->name == name; });
    if (data == triangulations.end()) table.fail("expected its triangles beside the description, found none");
    return *data;
  });
  set.triangulations = std::move(triangulations);
  return set;
}

SurfaceSet surfaces_with_files(std::string_view text, std::string_view where) {
  const std::string file(where);
  std::vector<std::shared_ptr<const Triangulation>> read;
  auto set = read_set(text, file, [&](const TableReader& table, bool open_allowed) {
    const auto path = std::filesystem::path(file).parent_path() / table.text("file");
    auto triangles = read_triangulation(path, open_allowed);
    triangles.name = table.text("name");
    return read.emplace_back(std::make_shared<const Triangulation>(std::move(triangles)));
  });
  set.triangulations = std::move(read);
  return set;
}

}  // namespace pamr::geometry
