// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/toml_table.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/cone.hpp"
#include "pamr/geometry/cylinder.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/polynomial.hpp"
#include "pamr/geometry/quadric.hpp"
#include "pamr/geometry/revolution.hpp"
#include "pamr/geometry/sphere.hpp"
#include "pamr/geometry/torus.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace pamr::geometry {

namespace {

/// The tables of an array that must have one or more, each called `what` with its number.
std::vector<TomlTable> parts_of(const TomlTable& surface, std::string_view key, std::string_view what) {
  auto parts = surface.list(key);
  if (parts.empty()) surface.refuse(key, "an array of one table or more");
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].set_title(fmt::format("{} {}", what, i + 1));
  return parts;
}

Meridian meridian(const TomlTable& table, std::string_view key) {
  const auto [x, r] = table.numbers<2>(key);
  return {x, r};
}

std::vector<ProfilePiece> read_profile(const TomlTable& surface, const std::string& title) {
  std::vector<ProfilePiece> profile;
  for (const auto& piece : parts_of(surface, "profile", title + ": profile piece")) {
    auto& read = profile.emplace_back(ProfilePiece{meridian(piece, "from"), meridian(piece, "to"), {}});
    if (piece.has("center")) read.arc = ProfileArc{meridian(piece, "center"), {}};
    if (!piece.has("clockwise")) continue;
    if (!read.arc) piece.refuse("center", "[x, r] beside clockwise");
    read.arc->clockwise = piece.flag("clockwise");
  }
  return profile;
}

std::vector<PolynomialSegment> read_segments(const TomlTable& surface, const std::string& title) {
  std::vector<PolynomialSegment> segments;
  for (const auto& segment : parts_of(surface, "segments", title + ": segment")) {
    const auto x = segment.numbers<6>("x"), y = segment.numbers<6>("y"), z = segment.numbers<6>("z");
    auto& read = segments.emplace_back();
    for (std::size_t i = 0; i < 6; ++i) read.coefficient[i] = {x[i], y[i], z[i]};
    read.u = segment.numbers<2>("u");
    read.v = segment.numbers<2>("v");
  }
  return segments;
}

/// The triangles of the surface that a table describes, and their named parts; null: none.
struct Triangles {
  std::shared_ptr<const Triangulation> surface;
  std::shared_ptr<const NamedParts> parts;
};
using FindTriangles = std::function<Triangles(const TomlTable& surface, bool open_allowed)>;

/// The texts of CAD files, and the shapes made of them so far.
class CadShelf {
 public:
  /// Adds a text; false where there is another one of that name.
  bool add(CadSource source) {
    const auto* known = find(source.file);
    if (known != nullptr) return known->text == source.text;
    sources_.push_back(std::move(source));
    return true;
  }
  const CadSource* find(const std::string& file) const {
    const auto found = std::find_if(sources_.begin(), sources_.end(), [&](const auto& s) { return s.file == file; });
    return found == sources_.end() ? nullptr : &*found;
  }
  std::shared_ptr<const CadModel> model(const CadSource& source, const std::string& unit) {
    auto& made = models_[{source.file, unit}];
    if (!made) made = make_cad_model(source, unit);
    return made;
  }
  const std::vector<CadSource>& sources() const { return sources_; }

 private:
  std::vector<CadSource> sources_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const CadModel>> models_;
};

/// Where the data of surfaces come from: files beside a case, or what travels with a mesh.
struct Sources {
  FindTriangles triangles;
  std::function<const CadSource&(const TomlTable& surface)> cad;
  CadShelf* shelf = nullptr;
};

/// Adds the faces whose name or color one of the texts of a key is.
void add_faces(const TomlTable& surface, std::string_view key, const CadModel& model, std::string CadFaceData::*field,
               std::vector<int>& faces) {
  if (!surface.has(key)) return;
  for (const auto& text : surface.texts(key)) {
    const auto before = faces.size();
    for (std::size_t f = 0; f < model.faces().size(); ++f)
      if (model.faces()[f].data().*field == text) faces.push_back(static_cast<int>(f));
    if (faces.size() > before && !text.empty()) continue;
    std::set<std::string> known;
    for (const auto& face : model.faces()) known.insert(face.data().*field);
    known.erase("");
    const std::string what = field == &CadFaceData::name ? "names" : "colors";
    surface.refuse(key,
                   known.empty()
                       ? "faces by number: no face of the shape has one of these " + what
                       : fmt::format("{} of faces of the shape ({})", what, listed(known, {.most = all_items})),
                   "\"" + text + "\"");
  }
}

/// Numbers from 1 on, names or colors; all faces where these keys are missing.
std::vector<int> read_faces(const TomlTable& surface, const CadModel& model) {
  std::vector<int> faces;
  add_faces(surface, "face_names", model, &CadFaceData::name, faces);
  add_faces(surface, "face_colors", model, &CadFaceData::color, faces);
  if (surface.has("faces"))
    for (const auto number : surface.integers("faces", 1, static_cast<std::int64_t>(model.faces().size())))
      faces.push_back(static_cast<int>(number - 1));
  if (!surface.has("faces") && !surface.has("face_names") && !surface.has("face_colors"))
    for (std::size_t f = 0; f < model.faces().size(); ++f) faces.push_back(static_cast<int>(f));
  return faces;
}

std::shared_ptr<const Surface> read_cad_surface(const TomlTable& surface, const Sources& sources) {
  const auto& source = sources.cad(surface);
  const auto unit = surface.text_or("unit", usual_cad_unit, "mm, cm, m, um, in or ft");
  if (!is_cad_unit(unit)) surface.refuse("unit", "mm, cm, m, um, in or ft");
  const auto model = sources.shelf->model(source, unit);
  return std::make_shared<CadSurface>(model, read_faces(surface, *model));
}

/// Edges between named parts, as points from 0 on, two by two: how these borders travel with a mesh.
constexpr const char* border_edges_key = "border_edges";

std::vector<std::array<int, 2>> read_border_edges(const TomlTable& surface, const Triangulation& triangles) {
  const auto points = surface.integers(border_edges_key, 0, std::ssize(triangles.points) - 1);
  if (points.size() % 2 != 0) surface.refuse(border_edges_key, "two points for each edge");
  std::vector<std::array<int, 2>> edges;
  for (std::size_t i = 0; i < points.size(); i += 2)
    edges.push_back({static_cast<int>(points[i]), static_cast<int>(points[i + 1])});
  return edges;
}

/// Puts a line into the n-th table `[[surface]]` of a description, below its head. Throws `Error` where that table is
/// written otherwise.
void add_to_surface(std::string& toml, int n, const std::string& line, const std::string& file) {
  std::size_t begin = 0;
  for (int seen = 0; begin < toml.size();) {
    const auto end = std::min(toml.find('\n', begin), toml.size());
    auto head = toml.substr(begin, std::min(end, toml.find('#', begin)) - begin);
    std::erase_if(head, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (head == "[[surface]]" && seen++ == n) {
      toml.insert(end, "\n" + line);
      return;
    }
    begin = end + 1;
  }
  throw Error(fmt::format("{}: expected tables [[surface]] for a file of several named solids", file));
}

/// The file must be named even when the triangles come from elsewhere.
std::shared_ptr<const Surface> read_triangulated(const TomlTable& surface, const FindTriangles& find_triangles) {
  surface.text("file", "the name of a file of triangles");
  Triangulated::Options options;
  options.crease.angle = surface.number_or("feature_angle", options.crease.angle);
  if (surface.has("creases")) options.crease.given = surface.polylines<Vec3>("creases");
  options.crease.shortest = surface.number_or("shortest_crease", options.crease.shortest);
  options.open_allowed = surface.flag_or("open", options.open_allowed);
  if (surface.has("near")) options.near = surface.point<Vec3>("near");
  auto triangles = find_triangles(surface, options.open_allowed);
  if (surface.has(border_edges_key)) options.crease.borders = read_border_edges(surface, *triangles.surface);
  options.parts = std::move(triangles.parts);
  return std::make_shared<Triangulated>(std::move(triangles.surface), options);
}

std::shared_ptr<const Surface> read_surface(const TomlTable& t, const std::string& title, const Sources& sources) {
  const auto kind = t.word("kind", {"plane", "sphere", "cylinder", "cone", "torus", "quadric", "revolution",
                                    "polynomial", "triangulation", "cad"});
  const auto point = [&t](std::string_view key) { return t.point<Vec3>(key); };
  if (kind == "plane") return std::make_shared<Plane>(point("point"), point("normal"));
  if (kind == "sphere") return std::make_shared<Sphere>(point("center"), t.number("radius"));
  if (kind == "cylinder") return std::make_shared<Cylinder>(point("point"), point("axis"), t.number("radius"));
  if (kind == "cone") return std::make_shared<Cone>(point("apex"), point("axis"), t.number("half_angle"));
  if (kind == "torus")
    return std::make_shared<Torus>(point("center"), point("axis"), t.number("major_radius"), t.number("minor_radius"));
  if (kind == "revolution") return std::make_shared<Revolution>(point("origin"), point("axis"), read_profile(t, title));
  if (kind == "quadric") return std::make_shared<Quadric>(t.numbers<10>("coefficients"));
  if (kind == "polynomial") return std::make_shared<Polynomial>(read_segments(t, title));
  if (kind == "cad") return read_cad_surface(t, sources);
  return read_triangulated(t, sources.triangles);
}

/// Where the key stands with which a message of a surface begins ("radius: expected", "profile piece 2").
std::string place_of(const TomlTable& surface, std::string_view message) {
  const std::string key(message.substr(0, message.find_first_of(": ")));
  for (const auto& name : {key, key + "s"})
    if (surface.has(name)) return surface.at(name);
  return surface.at();
}

/// Adds the surface of a table. Errors of its values name their place in the file.
void add_surface(TomlTable table, const std::string& file, const Sources& sources, SurfaceSet& set) {
  table.set_title(fmt::format("surface {}", set.size() + 1));
  const auto name = table.text("name");
  const auto title = fmt::format("surface \"{}\"", name);
  table.set_title(title);
  try {
    auto surface = read_surface(table, title, sources);
    set.add(name, table.at("name"), std::move(surface));
  } catch (const Error& error) {
    const std::string_view message = error.what();
    if (message.starts_with(file + ":")) throw;
    throw Error(fmt::format("{}: {}: {}", place_of(table, message), title, message));
  }
}

SurfaceSet read_set(const TomlTable& root, const std::string& file, const Sources& sources) {
  SurfaceSet set;
  for (const auto& table : root.list("surface")) add_surface(table, file, sources, set);
  return set;
}

}  // namespace

SurfaceSet surfaces_from_toml(std::string_view text, std::string_view where,
                              std::vector<std::shared_ptr<const Triangulation>> triangulations) {
  const std::string file(where);
  const auto root = parse_toml(text, file);
  Sources sources;
  sources.triangles = [&](const TomlTable& surface, bool) -> Triangles {
    const auto name = surface.text("name");
    const auto data = std::find_if(triangulations.begin(), triangulations.end(),
                                   [&](const auto& candidate) { return candidate->name == name; });
    if (data == triangulations.end()) surface.fail("expected its triangles beside the description, found none");
    return {*data, nullptr};
  };
  CadShelf shelf;
  for (const auto& table : root.list("cad"))
    if (!shelf.add({table.text("file"), table.text("text")}))
      table.fail(fmt::format("expected one text of \"{}\", found two that differ", table.text("file")));
  sources.shelf = &shelf;
  sources.cad = [&shelf](const TomlTable& surface) -> const CadSource& {
    const auto* source = shelf.find(surface.text("file"));
    if (source == nullptr) surface.fail("expected the text of its CAD file beside the description, found none");
    return *source;
  };
  auto set = read_set(root, file, sources);
  root.finish();
  set.toml = text;
  set.triangulations = std::move(triangulations);
  return set;
}

std::string border_edges_line(const Triangulation& surface, const NamedParts& parts) {
  const auto edges = parts.name.empty() ? std::vector<std::array<int, 2>>() : borders_of(surface, parts.part);
  if (edges.empty()) return {};
  constexpr std::size_t in_a_line = 10;
  std::string text = fmt::format("{} = [", border_edges_key);
  for (std::size_t i = 0; i < edges.size(); ++i)
    text += fmt::format("{}{}, {}", i == 0 ? "" : i % in_a_line == 0 ? ",\n  " : ", ", edges[i][0], edges[i][1]);
  return text + "]";
}

SurfaceSet surfaces_of_case(const TomlTable& root, const std::string& where, const PartChoice& is_part) {
  std::vector<std::shared_ptr<const Triangulation>> read;
  std::vector<std::pair<std::string, std::string>> borders;  // of a surface, and their line
  const auto path_of = [&where](const TomlTable& surface) {
    return std::filesystem::path(where).parent_path() / surface.text("file");
  };
  Sources sources;
  sources.triangles = [&](const TomlTable& surface, bool open_allowed) -> Triangles {
    auto [triangles, found, rest] = read_named_triangulation(path_of(surface), open_allowed, is_part);
    triangles.name = surface.text("name");
    std::shared_ptr<const NamedParts> parts;
    if (!found.name.empty()) {
      borders.emplace_back(triangles.name, border_edges_line(triangles, found));
      parts = std::make_shared<const NamedParts>(std::move(found));
    }
    return {read.emplace_back(std::make_shared<const Triangulation>(std::move(triangles))), parts};
  };
  CadShelf shelf;
  sources.shelf = &shelf;
  sources.cad = [&](const TomlTable& surface) -> const CadSource& {
    const auto name = surface.text("file");
    if (const auto* known = shelf.find(name)) return *known;
    auto source = read_cad_source(path_of(surface));
    source.file = name;
    shelf.add(std::move(source));
    return *shelf.find(name);
  };
  auto set = read_set(root, where, sources);
  set.toml = root.source_of("surface");
  set.toml.erase(0, std::min(set.toml.find_first_not_of('\n'), set.toml.size()));
  for (const auto& [name, line] : borders)
    if (!line.empty()) add_to_surface(set.toml, set.index_of(name), line, where);
  if (!shelf.sources().empty() && !set.toml.empty() && set.toml.back() != '\n') set.toml += '\n';
  for (const auto& source : shelf.sources()) set.toml += "\n" + cad_table(source);
  set.triangulations = std::move(read);
  return set;
}

std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return result + "\"";
}

std::string plane_keys(const std::string& name, Vec3 point, Vec3 normal, std::string_view separator) {
  return fmt::format("name = {1}{0}kind = \"plane\"{0}point = {2}{0}normal = {3}", separator, toml_text(name),
                     decimal(point), decimal(normal));
}

}  // namespace pamr::geometry
