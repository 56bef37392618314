// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "cli/text_file.hpp"
#include "convert/cad_surfaces.hpp"
#include "convert/formats.hpp"
#include "convert/known_shapes.hpp"
#include "convert/read_mesh.hpp"
#include "meshing/associate/associate_surfaces.hpp"
#include "meshing/repair/find_wall_ears.hpp"
#include "meshing/repair/open_wall_ears.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/toml_table.hpp"
#include "pamr/curved/curve_cells.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/io/export/write_boundary.hpp"
#include "pamr/io/export/write_cgns.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/export/write_vtu.hpp"
#include "pamr/io/gmsh/write_gmsh.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/su2/write_su2.hpp"
#include "pamr/io/ugrid/write_ugrid.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string input, output, surfaces, cad, unit = geometry::usual_cad_unit, gmsh_version = "4.1", solution_in,
                                            solution_out;
  std::vector<std::string> ties, surface_files, patches, kinds, solution_fields;
  std::vector<std::vector<double>> creases;
  double tolerance = -1, feature_angle = -1, scale = 1;
  int format = io::newest_format, order = 1;
  bool asks_version = false, asks_unit = false, recognize = false, repair = false, no_repair = false, strict = false,
       text = false, interfaces = false, force = false;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option(
          "IN", options.input,
          "mesh to read: .hdf or .vtkhdf (native, or VTKHDF of another program), .msh (Gmsh 2.2 or 4.1), .vtu, .mesh "
          "or .meshb (Medit), .su2, .lb8.ugrid or .b8.ugrid (AFLR3)")
      .required();
  line.option(
          "OUT", options.output,
          "mesh to write: .hdf or .vtkhdf (native), .msh, .vtu, .mesh, .meshb, .su2, .lb8.ugrid, .b8.ugrid or .cgns; "
          "its boundary: .stl, .obj, .ply, .off or .vtp; "
          "without an extension, or an existing folder: an OpenFOAM case")
      .required();
  line.flag("--repair", options.repair,
            "turn inverted cells of another program's mesh over instead of refusing them, and split inner edges and "
            "faces so that no "
            "inner face has two edges on one curved wall (cells there get flat when they are refined); the latter is "
            "done anyway for such a mesh with surfaces");
  line.flag("--no-repair", options.no_repair, "split nothing");
  line.flag("--strict", options.strict,
            "refuse what would only be reported: inverted cells, nodes of no cell, "
            "boundary faces without tag");
  line.option("--surfaces", options.surfaces, "TOML file of surfaces that patches lie on (docs/surfaces.md)");
  line.option("--surface", options.surface_files,
              "STL, OBJ, PLY or OFF file of the body that the patch after it (--patch) lies on; may be repeated")
      .type_name("FILE")
      .one_at_a_time();
  line.option("--patch", options.patches,
              "patch that lies on the --surface of the same place; for a boundary to write: a patch of it (all)")
      .type_name("NAME")
      .one_at_a_time();
  line.option(
          "--cad", options.cad,
          "STEP (or BREP) file of the body that the mesh was made from: finds by geometry on which of its faces each "
          "patch lies")
      .type_name("FILE");
  const auto unit =
      line.option("--unit", options.unit, "unit of the mesh's coordinates, kept in the mesh: mm, cm, m, um, in, ft")
          .show_default();
  line.option("--scale", options.scale, "factor for all coordinates, before surfaces are looked at").show_default();
  line.option("--kind", options.kinds,
              "PATCH=KIND: wall, symmetry, symmetryPlane, farfield, inflow, outflow or patch (none); may be repeated")
      .type_name("PAIR")
      .one_at_a_time();
  line.option("--sol-in", options.solution_in, "Medit's .sol or .solb with fields of a .mesh or .meshb to read")
      .type_name("FILE");
  line.option("--sol-out", options.solution_out, "the same to write beside a .mesh or .meshb").type_name("FILE");
  line.option("--sol-fields", options.solution_fields,
              "NAME,NAME,...: names of the fields to read, in their order; fields to write (all of reals)")
      .delimiter(',')
      .type_name("NAMES");
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
  const auto version = line.option("--gmsh-version", options.gmsh_version, "format of a .msh to write")
                           .one_of({"2.2", "4.1"})
                           .show_default();
  line.after_reading([&options, version, unit] {
    options.asks_version = version.is_given();
    options.asks_unit = unit.is_given();
  });
  line.flag("--interfaces", options.interfaces,
            "write to a .msh, .mesh or .meshb also the triangles between regions, as a group A_B for regions A and B");
  line.flag("--text", options.text, "write a .msh as text instead of binary");
  line.option("--order", options.order,
              "of the cells of a .msh or .vtu to write: 2 gives each edge a node, on the surface in curved boundaries")
      .range(1, 2)
      .show_default();
  line.option("--format", options.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.flag("--force", options.force, cli::force_help);
}

bool brings_surfaces(const Options& options) {
  return !options.surfaces.empty() || !options.surface_files.empty() || !options.cad.empty() || options.recognize;
}

/// Whether the surfaces of the mesh are looked at, not only handed on.
bool asks_for_surfaces(const Options& options) {
  return brings_surfaces(options) || options.repair || options.order == 2;
}

bool is_foam_case(const std::string& output) {
  std::error_code none;
  return std::filesystem::path(output).extension().empty() || std::filesystem::is_directory(output, none);
}

io::Interfaces interfaces_of(const Options& options) {
  return options.interfaces ? io::Interfaces::by_regions : io::Interfaces::none;
}

/// `second_order`: null for linear cells. Collective.
void write(const par::Comm& comm, const Options& options, bool as_foam, const mesh::DistMesh& mesh,
           const mesh::SecondOrder* second_order) {
  if (as_foam) return io::write_foam(comm, options.output, mesh);
  if (io::is_surface_file(options.output)) return io::write_boundary(comm, options.output, mesh, options.patches);
  const auto ending = convert::ending_of_output(options.output);
  if (convert::is_native_file(options.output)) io::write_native(comm, options.output, mesh, {.format = options.format});
  if (ending == ".vtu") io::write_vtu(comm, options.output, mesh, second_order);
  if (ending == ".su2") io::write_su2(comm, options.output, mesh);
  if (ending == ".ugrid") io::write_ugrid(comm, options.output, mesh);
  if (ending == ".cgns") io::write_cgns(comm, options.output, mesh);
  if (convert::is_medit_file(options.output)) io::write_medit(comm, options.output, mesh, interfaces_of(options));
  if (!options.solution_out.empty()) io::write_medit_fields(comm, options.solution_out, mesh, options.solution_fields);
  if (ending == ".msh")
    io::write_gmsh(comm, options.output, mesh,
                   {options.gmsh_version == "2.2" ? io::GmshVersion::v2_2 : io::GmshVersion::v4_1, !options.text,
                    interfaces_of(options)},
                   second_order);
}

/// Options for the reader. Local.
convert::ReadRequest read_request(const Options& options) {
  return {.file = options.input,
          .repair = options.repair,
          .strict = options.strict,
          .build_surfaces = asks_for_surfaces(options),
          .solution = options.solution_in,
          .field_names = options.solution_in.empty() ? std::vector<std::string>() : options.solution_fields};
}

/// Scale, unit and kinds as asked for. Collective.
void adjust(const par::Comm& comm, const Options& options, bool as_foam, mesh::DistMesh& mesh) {
  auto& unit = mesh.info.length_unit;
  if (options.scale != 1) {
    const bool needs_surfaces = options.order == 2 || (!as_foam && convert::is_native_file(options.output));
    convert::scale_mesh(comm, mesh, options.scale, needs_surfaces);
    unit = options.asks_unit ? options.unit : "";  // what it was no longer holds
  } else if (options.asks_unit) {
    if (geometry::is_cad_unit(unit) && unit != options.unit)
      throw Error(
          fmt::format("--unit: expected the unit of the mesh, {}, or --scale beside it to convert the coordinates, "
                      "found {}",
                      unit, options.unit));
    unit = options.unit;
  }
  convert::set_kinds(options.kinds, mesh);
}

/// The interfaces that were written, and which number stands for which group in formats that know numbers alone.
/// Collective.
void report_groups(cli::Session& session, const Options& options, bool as_foam, const mesh::DistMesh& mesh,
                   nlohmann::json& report) {
  const bool to_medit = !as_foam && convert::is_medit_file(options.output);
  if (!to_medit && !options.interfaces) return;
  const auto names = io::group_triangles(session.comm(), mesh, interfaces_of(options)).name;
  for (auto p = mesh.info.patches.size(); p < names.size(); ++p) report["interfaces"].push_back(names[p]);
  if (options.interfaces && names.size() == mesh.info.patches.size())
    session.warn("--interfaces: expected two regions or more (cell field 'region'), found one: nothing to write");
  if (!to_medit) return;
  const auto reference = io::medit_references(names);
  for (std::size_t p = 0; p < reference.size(); ++p) report["references"][names[p]] = reference[p];
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
void check_solutions(const Options& options, bool as_foam) {
  const auto check = [](const std::string& file, const std::string& mesh, bool is_medit, const char* name) {
    if (file.empty()) return;
    const auto ending = std::filesystem::path(file).extension();
    if (ending != ".sol" && ending != ".solb")
      throw Error(fmt::format("{}: expected a name that ends in .sol or .solb, found '{}'", name, file));
    if (!is_medit) throw Error(fmt::format("{}: expected a .mesh or .meshb beside it, found '{}'", name, mesh));
  };
  check(options.solution_in, options.input, convert::is_medit_file(options.input), "--sol-in");
  check(options.solution_out, options.output, !as_foam && convert::is_medit_file(options.output), "--sol-out");
  if (options.solution_in.empty() && options.solution_out.empty() && !options.solution_fields.empty())
    throw Error("--sol-fields: expected --sol-in or --sol-out beside it, found neither");
  if (!options.solution_in.empty() && !options.solution_out.empty())
    throw Error("expected --sol-in or --sol-out, found both");
}

/// Checks what can be checked before anything is read. Collective.
void check_files(cli::Session& session, const Options& options, bool as_foam) {
  (void)convert::ending_of_input(options.input);
  const bool as_boundary = io::is_surface_file(options.output) && !as_foam;
  if (!as_foam) (void)convert::ending_of_output(options.output);
  check_solutions(options, as_foam);
  const bool to_gmsh = !as_foam && options.output.ends_with(".msh");
  for (const auto& [is_given, name] :
       {std::pair(options.text, "--text"), std::pair(options.asks_version, "--gmsh-version")})
    if (is_given && !to_gmsh)
      throw Error(fmt::format("{}: expected an output that ends in .msh beside it, found '{}'", name, options.output));
  if (options.interfaces && (as_foam || !(to_gmsh || convert::is_medit_file(options.output))))
    throw Error(
        fmt::format("--interfaces: expected an output that ends in .msh, .mesh or .meshb, found '{}'", options.output));
  if (options.order == 2 && (as_foam || !(options.output.ends_with(".msh") || options.output.ends_with(".vtu"))))
    throw Error(fmt::format("--order 2: expected an output that ends in .msh or .vtu, found '{}'", options.output));
  if (as_boundary && !options.surface_files.empty())
    throw Error("--surface: expected a mesh to write, found a boundary: " + options.output);
  if (options.repair && options.no_repair) throw Error("expected --repair or --no-repair, found both");
  if (options.surfaces.empty() && !options.ties.empty())
    throw Error("--tie: expected --surfaces beside it, found none");
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
  if (options.surface_files.empty() && options.feature_angle >= 0)
    throw Error("--feature-angle: expected --surface beside it, found none");
  if (!options.creases.empty() && options.surface_files.size() != 1)
    throw Error(fmt::format("--crease: expected one --surface beside it, found {}", options.surface_files.size()));
  for (const auto& polyline : options.creases)
    if (polyline.size() < 6 || polyline.size() % 3 != 0)
      throw Error(fmt::format("--crease: expected two points or more of three coordinates each, found {} numbers",
                              polyline.size()));
  if (options.format != io::newest_format && (as_foam || !convert::is_native_file(options.output)))
    throw Error(
        fmt::format("--format {}: expected an output that ends in .hdf, found '{}'", options.format, options.output));
  std::vector<std::string> inputs{options.input};
  if (!options.surfaces.empty()) inputs.push_back(options.surfaces);
  if (!options.cad.empty()) inputs.push_back(options.cad);
  if (!options.solution_in.empty()) inputs.push_back(options.solution_in);
  inputs.insert(inputs.end(), options.surface_files.begin(), options.surface_files.end());
  for (const auto& input : inputs) session.check_input(input);
  if (!as_foam) {
    std::vector<std::string> outputs{options.output};
    if (!options.solution_out.empty()) outputs.push_back(options.solution_out);
    if (options.output.ends_with(".ugrid")) outputs.push_back(io::mapbc_file(options.output).string());
    for (const auto& output : outputs) session.check_output(output, inputs, options.force);
    return;
  }
  check_foam_case(session, options);
  session.prepare_output(io::foam_folder(options.output).string(), inputs);
}

/// Patches that get a surface by name.
std::vector<std::string> named_patches(const Options& options, const std::string& toml) {
  auto named = options.patches;
  for (const auto& pair : options.ties) named.push_back(pair.substr(0, pair.find('=')));
  if (toml.empty()) return named;
  for (const auto& table : parse_toml(toml, options.surfaces).list("surface"))
    if (const auto name = table.find_text("name")) named.push_back(*name);
  return named;
}

/// Associates patches with surfaces where that is asked for. Collective.
void associate(cli::Session& session, const Options& options, bool as_foam, mesh::DistMesh& mesh,
               nlohmann::json& report) {
  const auto& comm = session.comm();
  const bool is_import = !convert::is_native_file(options.input);
  if (!brings_surfaces(options)) {
    if (is_import && !as_foam && convert::is_native_file(options.output))
      convert::tell_known_shapes(session, convert::find_known_shapes(comm, mesh, {}, false, report));
    return;
  }
  meshing::AssociationRequest request;
  request.file = "--surface";
  if (!options.surfaces.empty()) {
    request.toml = cli::read_text(comm, options.surfaces);
    request.file = options.surfaces;
  }
  request.pairs = options.ties;
  request.tolerance = options.tolerance;
  request.feature_angle = options.feature_angle;
  for (const auto& numbers : options.creases) {
    auto& polyline = request.creases.emplace_back();
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
      polyline.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  }
  for (std::size_t i = 0; i < options.patches.size(); ++i)
    request.files.emplace_back(options.patches[i], options.surface_files[i]);
  std::vector<std::string> named;
  par::agree(comm, [&] { named = named_patches(options, request.toml); });
  if (!options.cad.empty())
    request.made = convert::find_cad_surfaces(
        session, {options.cad, options.unit, options.tolerance, options.strict, named}, mesh, report);
  named.insert(named.end(), request.made.name.begin(), request.made.name.end());
  convert::KnownShapes shapes;
  if (is_import || options.recognize) shapes = convert::find_known_shapes(comm, mesh, named, options.recognize, report);
  request.made.append(shapes.bound);
  const auto associations = meshing::associate_surfaces(comm, mesh, request);
  convert::tell_known_shapes(session, shapes);
  for (const auto& found : associations) {
    report["ties"][found.patch] = {{"surface", found.surface}, {"worst_distance", found.worst_distance}};
    if (found.creases) {
      report["ties"][found.patch]["edges_along_creases"] = found.creases->n_along;
      report["ties"][found.patch]["edges_across_creases"] = found.creases->n_across;
      if (found.creases->n_across > 0)
        session.warn(
            fmt::format("patch '{}': {} edges of the mesh run across sharp edges of surface \"{}\" (up to {:.3g} from "
                        "them), not along them: the sharp edges are rounded there",
                        found.patch, found.creases->n_across, found.surface, found.creases->worst_across));
    }
    if (found.n_off > 0)
      session.warn(
          fmt::format("patch '{}': nodes up to {:.3g} off surface \"{}\": the next refinement at them brings "
                      "them there",
                      found.patch, found.worst_distance, found.surface));
  }
  if (!comm.is_first()) return;
  for (const auto& surface : mesh.info.surfaces->triangulations)
    if (const auto warning = geometry::self_intersection_warning(*surface); !warning.empty()) session.warn(warning);
}

/// Gives flat patches that meet patches with a surface their planes, and says which others refinements will bend.
/// Collective.
void keep_flat_patches(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  if (!asks_for_surfaces(options)) return;
  const auto undescribed = mesh::find_undescribed_patches(session.comm(), mesh);
  mesh.info = mesh::with_planes(std::move(mesh.info), undescribed);
  for (const auto& [patch, plane, n_smooth_faces, continues] : undescribed) {
    const auto& info = mesh.info.patches[static_cast<std::size_t>(patch)];
    if (plane.is_flat)
      report["planes"][info.name] = {{"surface", mesh.info.surface_name(info)}, {"worst_distance", plane.distance}};
  }
  for (const auto& warning : mesh::warnings_of(mesh.info, undescribed)) session.warn(warning);
}

/// Opens inner faces with two edges on one curved wall, or warns of them. Collective.
void treat_ears(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  const auto& comm = session.comm();
  const bool is_refined =
      comm.any(std::any_of(mesh.lineage.begin(), mesh.lineage.end(), [](auto l) { return l != mesh::Lineage{}; }));
  const bool has_new_surfaces = brings_surfaces(options);
  const bool repair = !options.strict && !options.no_repair &&
                      (options.repair || (has_new_surfaces && convert::is_file_of_elements(options.input)));
  if (repair && is_refined) throw Error("--repair: expected a mesh of level 0, found cells that were refined");
  if (is_refined || (!has_new_surfaces && !repair)) return;
  const auto ears = meshing::find_wall_ears(comm, mesh);
  report["wall_ears"] = ears.count;
  if (!repair) {
    if (ears.count > 0)
      session.warn(
          fmt::format("{} inner faces have two edges on one curved wall: cells behind them lose a third of their mean "
                      "ratio at every refinement; --repair splits {} inner edges and {} inner faces and keeps the "
                      "boundary",
                      ears.count, ears.edge.size(), ears.face.size()));
    return;
  }
  report["split_edges"] = ears.edge.size();
  report["split_faces"] = ears.face.size();
  if (ears.count == 0) return;
  mesh = meshing::open_wall_ears(comm, std::move(mesh), ears);
  mesh.info.provenance += "; repaired at curved walls";
  session.warn(fmt::format(
      "{} inner faces had two edges on one curved wall, where cells lose a third of their mean ratio at "
      "every refinement: {} inner edges and {} inner faces were split, the boundary is as it was{}",
      ears.count, ears.edge.size(), ears.face.size(), options.repair ? "" : " (--no-repair splits nothing)"));
}

/// Gives the cells mid-edge nodes and says which edges could not follow their surface. Collective.
mesh::SecondOrder curve(cli::Session& session, const mesh::DistMesh& mesh, nlohmann::json& report) {
  session.step(fmt::format("giving {} cells nodes on their edges", mesh.info.n_global_cells));
  auto [nodes, curved] = curved::curve_cells(session.comm(), mesh);
  const auto& straightening = curved.straightening;
  report["order"] = 2;
  report["edges"] = curved.n_edges;
  report["curved_edges"] = curved.n_curved_edges;
  report["curved_cells"] = curved.n_curved_cells;
  report["straightened_edges"] = straightening.n_edges;
  report["straightened_cells"] = straightening.n_cells;
  report["straightening_rounds"] = straightening.rounds;
  report["min_jacobian"] = straightening.min_jacobian;
  report["off_surface_mid_nodes"] = curved.n_off_surface;
  report["max_off_surface"] = curved.max_off_surface;
  if (straightening.n_edges > 0)
    session.warn(fmt::format(
        "{} cells would fold or nearly so with curved edges: {} of {} curved edges are straighter than their surfaces, "
        "by up to {:.3g}; refine the mesh there",
        straightening.n_cells, straightening.n_edges, curved.n_curved_edges, curved.max_off_surface));
  else if (curved.n_off_surface > 0)
    session.warn(
        fmt::format("{} mid-edge nodes are off their surfaces, by up to {:.3g}: no common point of the surfaces "
                    "of their patches was found near by",
                    curved.n_off_surface, curved.max_off_surface));
  return std::move(nodes);
}

std::string summary_of_order(const nlohmann::json& report) {
  return fmt::format(" of second order ({} edges curved, {} straightened)", report["curved_edges"].get<std::int64_t>(),
                     report["straightened_edges"].get<std::int64_t>());
}

cli::ExitCode convert_file(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  if (options.output.empty()) throw Error("OUT: expected the name of a mesh to write, found an empty name");
  const bool as_foam = comm.any(is_foam_case(options.output));
  check_files(session, options, as_foam);

  nlohmann::json report;
  session.step("reading " + options.input);
  auto mesh = convert::read_mesh(session, read_request(options), report);
  adjust(comm, options, as_foam, mesh);
  validate::require_valid(comm, mesh, options.input);
  session.step(fmt::format("looking at {} cells", mesh.info.n_global_cells));
  associate(session, options, as_foam, mesh, report);
  keep_flat_patches(session, options, mesh, report);
  treat_ears(session, options, mesh, report);
  std::optional<mesh::SecondOrder> second_order;
  if (options.order == 2) second_order = curve(session, mesh, report);
  session.step(fmt::format("writing {} cells to {}", mesh.info.n_global_cells, options.output));
  write(comm, options, as_foam, mesh, second_order ? &*second_order : nullptr);
  const auto n_nodes = second_order ? second_order->n_global_nodes : mesh.info.n_global_nodes;
  report["cells"] = mesh.info.n_global_cells;
  report["nodes"] = n_nodes;
  report["patches"] = nlohmann::json::array();
  for (const auto& patch : mesh.info.patches) report["patches"].push_back(patch.name);
  report_groups(session, options, as_foam, mesh, report);
  for (const auto& region : mesh.info.regions) report["regions"][std::to_string(region.number)] = region.name;
  session.write_report(report);
  const auto n_patches = mesh.info.patches.size();
  session.summary(fmt::format("{} cells{}, {} nodes, {} {} -> {}", mesh.info.n_global_cells,
                              second_order ? summary_of_order(report) : "", n_nodes, n_patches,
                              n_patches == 1 ? "patch" : "patches", options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-convert",
       "Converts meshes from and to the formats of Gmsh, VTK, Medit, SU2, AFLR3, and to OpenFOAM's and CGNS.",
       "pamr-convert part.msh part.hdf --surfaces part.toml\n  pamr-convert level3.hdf level3.vtu\n  pamr-convert "
       "level3.hdf curved.msh --order 2\n  pamr-convert level3.hdf foam_case"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return convert_file(session, options); });
}
