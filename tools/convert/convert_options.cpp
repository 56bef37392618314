// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/convert_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/native/format.hpp"

namespace pamr::convert {

namespace {

void declare_surfaces(cli::CommandLine& line, Options& options) {
  line.group("Surfaces that patches lie on",
             "pamr-convert part.msh part.hdf --surface body.stl --patch wall\n"
             "pamr-convert part.msh part.hdf --cad part.step");
  line.option("--surfaces", options.surfaces, "TOML file of surfaces that patches lie on (docs/surfaces.md)");
  line.option("--surface", options.surface_files,
              "STL, OBJ, PLY or OFF file of the body that the patch after it (--patch) lies on; may be repeated")
      .type_name("FILE")
      .one_at_a_time();
  line.option("--patch", options.patches,
              "patch (or patches: \"face_*\") that lies on the --surface of the same place; for a boundary to write: a "
              "patch of it (all)")
      .type_name("NAME")
      .one_at_a_time();
  line.option("--cad", options.cad,
              "STEP, IGES or BREP file of the body that the mesh was made from: finds by geometry on which of its "
              "faces each "
              "patch lies")
      .type_name("FILE");
  line.flag("--recognize", options.recognize,
            "put patches without a surface that certainly lie on a sphere, cylinder, cone or torus on it");
  line.option("--feature-angle", options.feature_angle,
              "degrees between two triangles of a --surface, more is a sharp edge (default: 40)")
      .range(0.0, 180.0);
  line.option("--crease", options.creases,
              "X,Y,Z,X,Y,Z,...: polyline along edges of the --surface that are sharp as well; may be repeated")
      .delimiter(',')
      .type_name("POINTS")
      .one_at_a_time();
  line.option("--tie", options.ties, "PATCH=SURFACE, where the two have different names");
  line.option("--tolerance", options.tolerance,
              "largest distance of a node from its surface, length units (default: 1e-6 of the mesh's size, and "
              "for triangulated surfaces 1.5 times how far their facets lie off there)")
      .not_negative();
}

void check_foam_case(const cli::Session& session, const Options& options) {
  par::agree(session.comm(), [&] {
    if (!session.comm().is_first()) return;
    namespace fs = std::filesystem;
    std::error_code none;  // what cannot be looked at is not there; writing will say why
    auto folder = fs::path(options.output);
    while (!folder.has_filename() && folder.has_relative_path()) folder = folder.parent_path();
    const auto parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    if (fs::exists(folder, none) && !fs::is_directory(folder, none))
      throw Error(options.output + ": expected a folder for an OpenFOAM case, found a file of that name");
    if (!fs::is_directory(parent, none))
      throw Error(options.output + ": expected an existing folder to write into, found none named " + parent.string());
    if (fs::exists(io::foam_folder(folder), none) && !options.force)
      throw Error(options.output + ": constant/polyMesh exists already (--force replaces it)");
  });
}

/// Files of fields go with Medit's meshes only. Local.
void check_solutions(const Options& options) {
  const auto check = [](const std::string& file, const std::string& mesh, const io::Format& format, const char* name) {
    if (file.empty()) return;
    const auto ending = std::filesystem::path(file).extension();
    if (ending != ".sol" && ending != ".solb")
      throw Error(fmt::format("{}: expected a name that ends in .sol or .solb, found '{}'", name, file));
    if (!format.has_solutions)
      throw Error(fmt::format("{}: expected a {} beside it, found '{}'", name,
                              io::list_endings([](const io::Format& f) { return f.has_solutions; }, " or "), mesh));
  };
  check(options.solution_in, options.input, *options.from, "--sol-in");
  check(options.solution_out, options.output, *options.to, "--sol-out");
  if (options.solution_in.empty() && options.solution_out.empty() && !options.solution_fields.empty())
    throw Error("--sol-fields: expected --sol-in or --sol-out beside it, found neither");
  for (auto name = options.solution_fields.begin(); name != options.solution_fields.end(); ++name)
    if (std::find(options.solution_fields.begin(), name, *name) != name)
      throw Error(fmt::format("--sol-fields: expected different names, found '{}' twice", *name));
  if (!options.solution_in.empty() && !options.solution_out.empty())
    throw Error("expected --sol-in or --sol-out, found both");
}

/// Throws `Error` if an option is given that the format of the output does not know.
void require_known(const Options& options, bool is_given, const std::string& option, bool io::Format::*knows) {
  if (is_given && !(options.to->*knows))
    throw Error(fmt::format("{}: expected an output that ends in {}, found '{}'", option,
                            io::list_endings([&](const io::Format& f) { return f.*knows; }, " or "), options.output));
}

/// The formats of meshes that are read, or written, with their endings.
std::string formats_help(bool is_read) {
  std::string text;
  for (const auto& format : io::formats())
    if (!format.is_surface && !format.is_folder && (is_read ? format.read != nullptr : format.write != nullptr))
      text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", io::list_endings(format, " or "), format.name);
  return text;
}

void declare_repair(cli::CommandLine& line, Options& options) {
  line.group("Walls that are too coarse", "pamr-convert part.hdf mended.hdf --repair");
  line.flag(
      "--repair", options.repair,
      "split edges and faces so that no face beside a curved wall has two edges on it (cells there get flat when they "
      "are refined; done anyway "
      "for such a mesh with surfaces), and split cells at walls whose edges are longer than their radius into eight");
  line.flag("--no-repair", options.no_repair,
            "leave edges, faces and cells at coarse curved walls as they are, also where surfaces are given");
}

/// Yields --gmsh-version and --format.
std::pair<cli::Option, cli::Option> declare_formats(cli::CommandLine& line, Options& options) {
  line.group("Formats",
             "pamr-convert level3.hdf curved.msh --order 2 --gmsh-version 2.2\n"
             "pamr-convert box.mesh box.hdf --sol-in box.sol --sol-fields density,pressure");
  line.option("--sol-in", options.solution_in, "Medit's .sol or .solb with fields of a .mesh or .meshb to read")
      .type_name("FILE");
  line.option("--sol-out", options.solution_out, "the same to write beside a .mesh or .meshb").type_name("FILE");
  line.option("--sol-fields", options.solution_fields,
              "NAME,NAME,...: names of the fields to read, in their order; fields to write (all of reals)")
      .delimiter(',')
      .type_name("NAMES");
  const auto version = line.option("--gmsh-version", options.gmsh_version, "format of a .msh to write")
                           .one_of({"2.2", "4.1"})
                           .show_default();
  line.flag("--interfaces", options.interfaces,
            fmt::format("write to a {} also the triangles between regions, as a group A_B for regions A and B",
                        io::list_endings([](const io::Format& f) { return f.has_interfaces; }, " or ")));
  line.flag("--text", options.text, "write a .msh as text instead of binary");
  line.option(
          "--order", options.order,
          fmt::format("of the cells of a {} to write: 2 gives each edge a node, on the surface in curved boundaries",
                      io::list_endings([](const io::Format& f) { return f.has_second_order; }, " or ")))
      .range(1, 2)
      .show_default();
  auto format = line.option("--format", options.format, cli::format_help);
  format.range(io::oldest_format, io::newest_format).show_default();
  return {version, format};
}

}  // namespace

void declare(cli::CommandLine& line, Options& options) {
  line.option("IN", options.input, "mesh to read: " + formats_help(true) + ", or the folder of an OpenFOAM case")
      .required();
  line.option(
          "OUT", options.output,
          fmt::format("mesh to write: {}; its boundary: {}; without an extension, or an existing folder: an "
                      "OpenFOAM case",
                      formats_help(false), io::list_endings([](const io::Format& f) { return f.is_surface; }, " or ")))
      .required();
  const auto unit = line.option(
      "--unit", options.unit,
      "mm, cm, m, um, in or ft: unit of the coordinates after --scale, which native files keep (default: that "
      "of IN, none with --scale; with --cad mm)");
  line.option("--scale", options.scale,
              "factor for all coordinates and for the surfaces that a native mesh has; new surfaces are in the new "
              "coordinates")
      .show_default();
  line.option(
          "--kind", options.kinds,
          "PATCH=KIND: wall, symmetry, symmetryPlane, farfield, inflow, outflow, patch (none) or untagged (for one: "
          "its faces have no tag); may be repeated; PATCH may stand for several: \"face_*\"")
      .type_name("PAIR")
      .one_at_a_time();
  line.flag("--weld", options.weld,
            "join boundary nodes that lie in one place (parts that were meshed apart, cells with nodes of their own): "
            "the faces between them become inner ones");
  line.flag("--split-prisms", options.split_prisms,
            "cut prisms and pyramids of IN into three and two tetrahedra, quadrangles into triangles, instead of "
            "refusing them");
  line.flag("--strict", options.strict,
            "make an error of each warning about what IN holds or lacks, and repair nothing");
  line.flag("--as-level-0", options.as_level0,
            "forget how a native mesh was refined: all its cells are of level 0 (no coarsening below them)");
  line.flag("--force", options.force, cli::force_help);
  declare_repair(line, options);
  declare_surfaces(line, options);
  const auto [version, format] = declare_formats(line, options);
  line.after_reading([&options, unit, version = version, format = format] {
    options.asks_version = version.is_given();
    options.asks_format = format.is_given();
    options.asks_unit = unit.is_given();
  });
}

bool brings_surfaces(const Options& options) {
  return !options.surfaces.empty() || !options.surface_files.empty() || !options.cad.empty() || options.recognize;
}

bool asks_for_surfaces(const Options& options) {
  return brings_surfaces(options) || options.repair || options.as_level0 || options.order == 2;
}

io::Interfaces interfaces_of(const Options& options) {
  return options.interfaces ? io::Interfaces::by_regions : io::Interfaces::patches;
}

std::string check_files(cli::Session& session, const Options& options) {
  const bool as_boundary = options.to->is_surface;
  check_solutions(options);
  require_known(options, options.text, "--text", &io::Format::has_text);
  require_known(options, options.asks_version, "--gmsh-version", &io::Format::has_text);
  require_known(options, options.interfaces, "--interfaces", &io::Format::has_interfaces);
  require_known(options, options.order == 2, "--order 2", &io::Format::has_second_order);
  if (as_boundary && !options.surface_files.empty())
    throw Error("--surface: expected a mesh to write, found a boundary: " + options.output);
  if (options.split_prisms && options.from->is_native)
    throw Error("--split-prisms: expected a mesh of another program, found '" + options.input + "'");
  if (options.as_level0 && !options.from->is_native)
    throw Error("--as-level-0: expected a native mesh, found '" + options.input + "', whose cells are of level 0");
  if (options.repair && options.no_repair) throw Error("expected --repair or --no-repair, found both");
  if (options.repair && options.strict) throw Error("expected --repair or --strict, which repairs nothing, found both");
  if (options.surfaces.empty() && !options.ties.empty())
    throw Error("--tie: expected --surfaces beside it, found none");
  if (!as_boundary && options.surface_files.empty() && !options.patches.empty())
    throw Error("--patch: expected --surface beside it, or a boundary to write, found " + options.output);
  if (!as_boundary && options.surface_files.size() != options.patches.size())
    throw Error(fmt::format("expected a --patch NAME for each --surface FILE, found {} and {}", options.patches.size(),
                            options.surface_files.size()));
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    throw Error(fmt::format("--scale: expected a number above 0, found {}", options.scale));
  if (!geometry::is_cad_unit(options.unit))
    throw Error(fmt::format("--unit: expected mm, cm, m, um, in or ft, found \"{}\"", options.unit));
  if (as_boundary && !options.cad.empty())
    throw Error("--cad: expected a mesh to write, found a boundary: " + options.output);
  if (as_boundary && options.recognize)
    throw Error("--recognize: expected a mesh to write, found a boundary: " + options.output);
  if (as_boundary && !options.surfaces.empty())
    throw Error("--surfaces: expected a mesh to write, found a boundary: " + options.output);
  if (as_boundary && !options.kinds.empty())
    throw Error("--kind: expected a mesh to write, found a boundary, which has no kinds: " + options.output);
  if (!brings_surfaces(options) && options.tolerance >= 0)
    throw Error("--tolerance: expected --surface, --surfaces, --cad or --recognize beside it, found none");
  if (options.surface_files.empty() && options.feature_angle >= 0)
    throw Error("--feature-angle: expected --surface beside it, found none");
  if (!options.creases.empty() && options.surface_files.size() != 1)
    throw Error(fmt::format("--crease: expected one --surface beside it, found {}", options.surface_files.size()));
  for (const auto& polyline : options.creases)
    if (polyline.size() < 6 || polyline.size() % 3 != 0)
      throw Error(fmt::format("--crease: expected two points or more of three coordinates each, found {} numbers",
                              polyline.size()));
  require_known(options, options.asks_format, fmt::format("--format {}", options.format), &io::Format::is_native);
  require_known(options, options.as_level0, "--as-level-0", &io::Format::is_native);
  session.check_input(options.input);
  if (options.from->file_beside != nullptr) session.keep(options.from->file_beside(options.input).string());
  for (const auto& input : {options.cad, options.solution_in})
    if (!input.empty()) session.check_input(input);
  for (const auto& input : options.surface_files) session.check_input(input);
  auto surfaces = options.surfaces.empty() ? std::string() : session.read_case(options.surfaces);
  if (options.to->is_folder) {
    check_foam_case(session, options);
    session.check_folder(io::foam_folder(options.output).string());
    return surfaces;
  }
  session.check_output(options.output, options.force);
  if (!options.solution_out.empty()) session.check_output(options.solution_out, options.force);
  if (options.to->file_beside != nullptr)
    session.check_output(options.to->file_beside(options.output).string(), options.force);
  return surfaces;
}

}  // namespace pamr::convert
