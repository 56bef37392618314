// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/write_triangulation.hpp"
#include "pamr/io/formats.hpp"
#include "surface_mesh/change_scale.hpp"
#include "surface_mesh/decimate.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/remesh.hpp"
#include "surface_mesh/repair.hpp"
#include "surface_mesh/smooth_surface.hpp"
#include "surface_mesh/subdivide_surface.hpp"
#include "surface_mesh/surface_report.hpp"

namespace {

using namespace pamr;
using geometry::Triangulation;

struct Options {
  std::string command, input, output, scheme = "midpoint", unit;
  surface_mesh::RepairOptions repair;
  surface_mesh::DecimateOptions decimate;
  surface_mesh::SmoothOptions smooth;
  surface_mesh::RemeshOptions remesh;
  double feature_angle = 40, factor = 0;
  int subdivisions = 1;
  std::vector<std::vector<double>> by;
  bool keep_intersections = false, is_open = false, as_bytes = false, force = false;
};

/// A command with what all of them have.
cli::CommandLine add_command(cli::CommandLine& line, Options& options, const std::string& name, const std::string& help,
                             const std::string& example) {
  auto command = line.subcommand(name, help);
  command.group("Options of this command", example);
  command.after_reading([&options, name] { options.command = name; });
  command.option("IN", options.input, "triangles to read: STL, OBJ, PLY or OFF").required();
  if (name == "info") return command;
  command.option("-o,--output", options.output, "file to write: .stl, .obj, .ply or .off").required();
  command.flag("--binary", options.as_bytes, "write STL in bytes and single precision instead of text with all digits");
  command.flag("--force", options.force, cli::force_help);
  return command;
}

void add_feature_angle(cli::CommandLine& command, Options& options) {
  command.option("--feature-angle", options.feature_angle, "degrees between two triangles, more is a sharp edge")
      .range(0.0, 180.0)
      .show_default();
}

void declare_mending(cli::CommandLine& line, Options& o) {
  auto info = add_command(line, o, "info",
                          "what there is to say about the triangles; exit 1 if they are not the "
                          "closed surface of a body",
                          "pamr-surface info scan.stl --json -");
  add_feature_angle(info, o);
  auto repair = add_command(line, o, "repair",
                            "makes them the closed surface of a body, each step counted; exit 1 if "
                            "something is left",
                            "pamr-surface repair scan.stl -o body.ply --close-holes 0.1");
  add_feature_angle(repair, o);
  repair.option("--weld", o.repair.weld, "points this near to each other are one (default: 1e-7 of the box's diagonal)")
      .not_negative();
  repair
      .option("--close-holes", o.repair.max_hole,
              "largest hole to close, by the diagonal of its box (default: a tenth of the diagonal of all)")
      .not_negative();
  repair
      .option("--min-shell", o.repair.min_shell_area, "drop shells of less area (default: open ones below 1 % of all)")
      .not_negative();
  repair.flag("--keep-intersections", o.keep_intersections, "leave triangles that cut each other as they are");
  repair.flag("--open", o.is_open, "the surface may end: what is not closed is no fault");
}

void declare(cli::CommandLine& line, Options& o) {
  declare_mending(line, o);
  auto decimate = add_command(line, o, "decimate", "fewer triangles, sharp edges kept",
                              "pamr-surface decimate body.ply -o small.ply --error 0.01");
  add_feature_angle(decimate, o);
  decimate.option("--error", o.decimate.error, "largest distance between the old and the new surface").positive();
  decimate.option("--triangles", o.decimate.n_triangles, "how many may be left").positive();
  auto smooth = add_command(line, o, "smooth", "moves points to even out noise; sharp edges stay",
                            "pamr-surface smooth body.ply -o smooth.ply --max-move 0.01");
  add_feature_angle(smooth, o);
  smooth.option("--steps", o.smooth.n_steps, "how often").range(1, 1000).show_default();
  smooth.option("--max-move", o.smooth.max_move, "largest movement along the normal (default: no bound)").positive();
  auto subdivide = add_command(line, o, "subdivide", "splits each triangle into four",
                               "pamr-surface subdivide body.ply -o fine.ply --scheme butterfly");
  subdivide.option("--steps", o.subdivisions, "how often").range(1, 8).show_default();
  subdivide
      .option("--scheme", o.scheme,
              "midpoint: the same surface; butterfly: smooth through the points; loop: smooth, points move")
      .one_of({"midpoint", "butterfly", "loop"})
      .show_default();
  auto remesh = add_command(line, o, "remesh", "new triangles of one size on the same surface, sharp edges kept",
                            "pamr-surface remesh body.ply -o even.ply --size 0.5");
  add_feature_angle(remesh, o);
  remesh.option("--size", o.remesh.size, "edge length").positive().required();
  remesh.option("--steps", o.remesh.n_steps, "how often edges are split, collapsed and flipped")
      .range(1, 50)
      .show_default();
  auto scale = add_command(line, o, "scale", "multiplies all coordinates",
                           "pamr-surface scale body.stl -o meters.stl --unit mm");
  auto factor = scale.option("--factor", o.factor, "by this number").positive();
  scale.option("--unit", o.unit, "from this unit of the file to meters: " + surface_mesh::known_units())
      .excludes(factor);
  auto translate = add_command(line, o, "translate", "adds a vector to all points",
                               "pamr-surface translate body.stl -o moved.stl --by 0,0,1");
  translate.option("--by", o.by, "X,Y,Z").delimiter(',').type_name("X,Y,Z").one_at_a_time().required();
}

/// The input as a surface that can be edited; with the way to make it one, if it is none.
Triangulation as_surface(Triangulation surface, const std::string& file) {
  geometry::drop_unused_points(surface);
  try {
    geometry::require_valid(surface, file, true);
  } catch (const Error& error) {
    throw Error(std::string(error.what()) + "; `pamr-surface repair` mends surfaces");
  }
  return surface;
}

/// What a command says of its work.
struct Outcome {
  Triangulation surface = {};
  nlohmann::json report = nlohmann::json::object();
  std::vector<std::string> lines = {};
  std::vector<std::string> faults = {};  ///< exit code 1
};

Outcome mend(const Options& options, const Triangulation& input) {
  auto how = options.repair;
  how.feature_angle = options.feature_angle;
  how.resolve_intersections = !options.keep_intersections;
  auto repaired = surface_mesh::repair(input, how);
  Outcome outcome{.report = surface_mesh::to_json(repaired), .lines = surface_mesh::steps_of(repaired)};
  if (outcome.lines.empty()) outcome.lines.push_back("nothing to repair");
  if (repaired.holes.n_large > 0)
    outcome.lines.push_back(fmt::format("holes larger than {:.3g}, or of more than 500 edges, left open: {}",
                                        repaired.max_hole, repaired.holes.n_large));
  auto left = repaired.left;
  if (options.is_open && left.is_surface()) left.open_edges = {};
  outcome.faults = surface_mesh::faults_of(left);
  outcome.report["left"] = surface_mesh::to_json(repaired.left);
  outcome.surface = std::move(repaired.surface);
  return outcome;
}

Outcome decimate(const Options& options, const Triangulation& surface) {
  auto how = options.decimate;
  how.feature_angle = options.feature_angle;
  if (!(how.error > 0) && how.n_triangles == 0)
    throw Error("decimate: expected --error E or --triangles N, found neither");
  auto done = surface_mesh::decimate(surface, how);
  Outcome outcome;
  outcome.report = {
      {"sharp_edges", done.n_sharp_edges},
      {"rounds", done.n_rounds},
      {"fixed_points", done.n_fixed},
      {"distance",
       {{"from_old", surface_mesh::to_json(done.from_old)}, {"to_old", surface_mesh::to_json(done.to_old)}}}};
  const auto& [one, other] = std::pair(done.from_old, done.to_old);
  outcome.lines.push_back(
      fmt::format("largest distance of the old surface from the new one: {:.4g} to {:.4g}, of the new one from the old "
                  "one: {:.4g} to {:.4g}",
                  one.at_least, one.at_most, other.at_least, other.at_most));
  if (done.n_fixed > 0)
    outcome.lines.push_back(fmt::format("{} fixed where the error was exceeded or triangles would cut each other",
                                        counted(done.n_fixed, "point was", "points were")));
  if (done.cuts_itself) outcome.lines.push_back("the surface cuts itself, as it did before");
  if (how.n_triangles > 0 && how.error <= 0 && std::ssize(done.surface.triangles) > how.n_triangles)
    outcome.faults.push_back(
        fmt::format("expected {} triangles, found {}: the others keep sharp edges, ends and shapes", how.n_triangles,
                    done.surface.triangles.size()));
  outcome.surface = std::move(done.surface);
  return outcome;
}

/// Makes it a fault of the outcome if the edit made of a surface what is none, or made it cut itself.
void check_edit(const Triangulation& before, Outcome& outcome) {
  const auto after = surface_mesh::describe(outcome.surface, {.find_deviation = false});
  if (after.is_surface() && after.self_intersections->count == 0) return;
  auto left = after;
  left.open_edges = {};  // the input may end
  if (after.is_surface() && geometry::cuts_itself(before)) {
    outcome.lines.push_back("the surface cuts itself, as it did before");
    left.self_intersections = surface_mesh::Found{};
  }
  outcome.faults = surface_mesh::faults_of(left);
}

Outcome smooth(const Options& options, const Triangulation& surface) {
  auto how = options.smooth;
  how.feature_angle = options.feature_angle;
  auto done = surface_mesh::smooth(surface, how);
  Outcome outcome{
      .report = {{"fixed_points", done.n_fixed}, {"worst_move", done.worst_move}, {"mean_move", done.mean_move}}};
  outcome.lines.push_back(
      fmt::format("points moved by {:.4g} (mean) to {:.4g}, {} stayed", done.mean_move, done.worst_move, done.n_fixed));
  outcome.surface = std::move(done.surface);
  check_edit(surface, outcome);
  return outcome;
}

constexpr double max_triangles = 1e8;  ///< that a command makes

Outcome subdivide(const Options& options, const Triangulation& surface) {
  using Scheme = surface_mesh::SubdivisionScheme;
  const auto scheme = options.scheme == "loop"        ? Scheme::loop
                      : options.scheme == "butterfly" ? Scheme::butterfly
                                                      : Scheme::midpoint;
  if (static_cast<double>(surface.triangles.size()) * std::pow(4.0, options.subdivisions) > max_triangles)
    throw Error(fmt::format("subdivide: expected at most {:.0g} triangles, found {} to split {} times", max_triangles,
                            surface.triangles.size(), options.subdivisions));
  Outcome outcome{.surface = surface_mesh::subdivide(surface, scheme, options.subdivisions)};
  const auto before = surface_mesh::describe(surface, {.find_self_intersections = false, .find_deviation = false});
  outcome.report["sharp_edges"] = before.sharp_edges;
  if (scheme != Scheme::midpoint && before.sharp_edges > 0)
    outcome.lines.push_back(fmt::format("{} rounded (--scheme midpoint keeps them)",
                                        counted(before.sharp_edges, "sharp edge was", "sharp edges were")));
  if (scheme != Scheme::midpoint) check_edit(surface, outcome);
  return outcome;
}

Outcome remesh(const Options& options, const Triangulation& surface) {
  auto how = options.remesh;
  how.feature_angle = options.feature_angle;
  const double area = surface_mesh::describe(surface, {.find_self_intersections = false, .find_deviation = false}).area;
  const double n_triangles = area / (0.25 * std::numbers::sqrt3 * how.size * how.size);  // of equal sides
  if (!(n_triangles < max_triangles))
    throw Error(
        fmt::format("remesh: expected a --size of fewer than {:.0g} triangles, found {:g}, which makes some {:.2g}",
                    max_triangles, how.size, n_triangles));
  auto done = surface_mesh::remesh(surface, how);
  const auto one = surface_mesh::distance_from_to(surface, done.surface),
             other = surface_mesh::distance_from_to(done.surface, surface);
  Outcome outcome{
      .report = {{"sharp_edges", done.n_sharp_edges},
                 {"distance", {{"from_old", surface_mesh::to_json(one)}, {"to_old", surface_mesh::to_json(other)}}}}};
  outcome.lines.push_back(
      fmt::format("largest distance of the old surface from the new one: {:.4g} to {:.4g}, of the new one from the old "
                  "one: {:.4g} to {:.4g}; {} sharp edges kept",
                  one.at_least, one.at_most, other.at_least, other.at_most, done.n_sharp_edges));
  outcome.surface = std::move(done.surface);
  check_edit(surface, outcome);
  return outcome;
}

Outcome move(const Options& options, Triangulation input) {
  Outcome outcome{.surface = std::move(input)};  // sound or not
  if (options.command == "translate") {
    if (options.by.size() != 1 || options.by[0].size() != 3)
      throw Error(
          fmt::format("--by: expected three numbers X,Y,Z, found {}", options.by.empty() ? 0 : options.by[0].size()));
    surface_mesh::translate(outcome.surface, {options.by[0][0], options.by[0][1], options.by[0][2]});
    return outcome;
  }
  if (options.unit.empty() && !(options.factor > 0))
    throw Error("scale: expected --factor F or --unit U, found neither");
  const double factor = options.unit.empty() ? options.factor : surface_mesh::meters_of(options.unit);
  surface_mesh::scale(outcome.surface, factor);
  outcome.report["factor"] = factor;
  return outcome;
}

Outcome edit(const Options& options, Triangulation input) {
  if (options.command == "repair") return mend(options, input);
  if (options.command == "scale" || options.command == "translate") return move(options, std::move(input));
  const auto surface = as_surface(std::move(input), options.input);
  if (options.command == "decimate") return decimate(options, surface);
  if (options.command == "smooth") return smooth(options, surface);
  if (options.command == "subdivide") return subdivide(options, surface);
  return remesh(options, surface);
}

/// Writes the result, and says what the format does not keep.
void write(const Options& options, Outcome& outcome) {
  auto format = geometry::surface_format_of(options.output);
  const bool is_stl = format == geometry::SurfaceFormat::stl;
  if (is_stl && options.as_bytes) format = geometry::SurfaceFormat::stl_single;
  const auto bytes = geometry::to_bytes(outcome.surface, format);
  if (is_stl) {
    auto used = outcome.surface;
    geometry::drop_unused_points(used);
    const auto read_back = geometry::parse_soup(bytes, options.output);
    const auto n_lost = std::ssize(used.points) - std::ssize(read_back.points);
    outcome.report["points_lost_in_stl"] = n_lost;
    if (n_lost > 0)
      outcome.lines.push_back(fmt::format("STL has no numbers of points: {} become one with another when it is read{}",
                                          n_lost, options.as_bytes ? " (single precision)" : ""));
  }
  cli::write_whole(options.output, bytes);
}

/// What is shown while a command works.
std::string step_of(const Options& options) {
  const auto& command = options.command;
  const char* work = command == "info"        ? "looking at"
                     : command == "repair"    ? "mending"
                     : command == "decimate"  ? "decimating"
                     : command == "smooth"    ? "smoothing"
                     : command == "subdivide" ? "subdividing"
                     : command == "remesh"    ? "remeshing"
                                              : "moving";
  return fmt::format("{} {}", work, options.input);
}

/// The input, of which it is said what is left out. Local.
Triangulation read(cli::Session& session, const Options& options) {
  auto input = geometry::read_soup(options.input);
  for (const auto& remark : input.remarks) session.warn(options.input + ": " + remark);
  return input;
}

cli::ExitCode inform(cli::Session& session, const Options& options) {
  surface_mesh::Description found;
  std::vector<std::string> faults;
  par::agree(session.comm(), [&] {
    if (!session.comm().is_first()) return;
    const auto input = read(session, options);
    found = surface_mesh::describe(input, {.feature_angle = options.feature_angle});
    faults = surface_mesh::faults_of(found);
  });
  session.write_report(surface_mesh::to_json(found));
  for (const auto& text : surface_mesh::lines_of(found)) session.summary(text);
  for (const auto& text : faults) session.warn(options.input + ": " + text);
  return session.comm().any(!faults.empty()) ? cli::ExitCode::failed : cli::ExitCode::done;
}

/// A mesh is for other tools. Local.
void refuse_mesh(const std::string& file) {
  const auto* format = io::find_format(file);
  if (format == nullptr || format->is_surface || format->is_folder) return;
  throw Error(
      fmt::format("{}: expected triangles (STL, OBJ, PLY or OFF), found the name of a mesh: `pamr-quality` measures a "
                  "mesh, and `pamr-convert {} boundary.stl` writes its boundary as triangles",
                  file, file));
}

cli::ExitCode run(cli::Session& session, const Options& options) {
  refuse_mesh(options.input);
  session.check_input(options.input);
  if (options.command != "info") {
    (void)geometry::surface_format_of(options.output);
    session.check_output(options.output, options.force);
  }
  session.step(step_of(options));
  if (options.command == "info") return inform(session, options);
  Outcome outcome;
  par::agree(session.comm(), [&] {  // one process does it, the others wait
    if (!session.comm().is_first()) return;
    outcome = edit(options, read(session, options));
    write(options, outcome);
  });
  outcome.report["points"] = outcome.surface.points.size();
  outcome.report["triangles"] = outcome.surface.triangles.size();
  session.write_report(outcome.report);
  for (const auto& text : outcome.lines) session.summary(text);
  session.summary(fmt::format("{} triangles, {} points -> {}", outcome.surface.triangles.size(),
                              outcome.surface.points.size(), options.output));
  for (const auto& text : outcome.faults) session.warn(options.output + ": left: " + text);
  return session.comm().any(!outcome.faults.empty()) ? cli::ExitCode::failed : cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-surface", "Looks at triangulated surfaces, mends and edits them, before a mesh is made.",
       "pamr-surface info scan.stl --json -\npamr-surface repair scan.stl -o body.ply && pamr-surface decimate "
       "body.ply "
       "-o small.ply --error 0.01"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
