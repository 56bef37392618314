// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "convert/cad_surfaces.hpp"
#include "convert/coarse_walls.hpp"
#include "convert/convert_options.hpp"
#include "convert/known_shapes.hpp"
#include "convert/read_mesh.hpp"
#include "convert/torn_mesh.hpp"
#include "meshing/associate/associate_surfaces.hpp"
#include "meshing/associate/association_remarks.hpp"
#include "meshing/read_mesh_case.hpp"
#include "meshing/repair/find_wall_ears.hpp"
#include "meshing/repair/open_wall_ears.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/curved/curve_cells.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/interfaces.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;
using convert::Options;

/// Writes fields beside a mesh and yields them: files of Medit have no place for their names, which are said in order.
/// Collective.
std::vector<const mesh::Field*> write_fields(const cli::Session& session, const Options& options,
                                             const mesh::DistMesh& mesh) {
  if (options.solution_out.empty()) return {};
  auto [written, of_cells] = io::choose_medit_fields(mesh, options.solution_fields);
  io::write_medit_fields(session.comm(), options.solution_out, mesh, {written, of_cells});
  written.insert(written.end(), of_cells.begin(), of_cells.end());
  const auto in_quotes = [](const mesh::Field* field) { return "'" + field->name + "'"; };
  session.note(fmt::format("files of Medit have no names of fields: in order, {} has {}", options.solution_out,
                           listed(written, {.before_last = " and ", .most = all_items}, in_quotes)));
  return written;
}

/// `second_order`: null for linear cells. Collective.
void write(const cli::Session& session, const Options& options, const mesh::DistMesh& mesh,
           const mesh::SecondOrder* second_order) {
  const auto& comm = session.comm();
  auto fields = write_fields(session, options, mesh);  // first, because their names may be wrong
  io::write_mesh(comm, options.output, mesh,
                 {.format = options.format,
                  .remark = session.remarks(),
                  .note = [&](const std::string& text) { session.note(text); },
                  .gmsh = {options.gmsh_version == "2.2" ? io::GmshVersion::v2_2 : io::GmshVersion::v4_1, !options.text,
                           convert::interfaces_of(options)},
                  .second_order = second_order,
                  .patches = options.patches,
                  .kept = std::move(fields)});
}

/// Options for the reader. Local.
convert::ReadRequest read_request(const Options& options) {
  return {.file = options.input,
          .strict = options.strict,
          .split_prisms = options.split_prisms,
          .build_surfaces = convert::asks_for_surfaces(options),
          .solution = options.solution_in,
          .field_names = options.solution_in.empty() ? std::vector<std::string>() : options.solution_fields};
}

/// Scale, unit and kinds as asked for. Collective.
void adjust(const par::Comm& comm, const Options& options, mesh::DistMesh& mesh) {
  auto& unit = mesh.info.length_unit;
  if (options.scale != 1) {
    const bool needs_surfaces = convert::asks_for_surfaces(options) || options.to->is_native;
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
  auto& patches = mesh.info.patches;
  const auto untagged = mesh::find_untagged(patches);
  convert::set_kinds(options.kinds, mesh);
  if (!options.cad.empty() && untagged < patches.size() && !mesh::is_untagged(patches[untagged]))
    throw Error(
        fmt::format("--kind: expected no kind for {}, the faces without a tag, which --cad divides: give kinds in "
                    "a second call",
                    patches[untagged].name));
}

/// The interfaces that were written, and which number stands for which group in formats that know numbers alone.
/// Collective.
void report_groups(cli::Session& session, const Options& options, const mesh::DistMesh& mesh, nlohmann::json& report) {
  const bool to_medit = options.to->has_solutions;
  if (!to_medit && !options.interfaces) return;
  const auto groups = io::group_triangles(session.comm(), mesh, convert::interfaces_of(options));
  const auto& names = groups.name;
  for (auto p = mesh.info.patches.size(); p < names.size(); ++p) report["interfaces"].push_back(names[p]);
  if (options.interfaces && names.size() == mesh.info.patches.size())
    session.warn("--interfaces: expected two regions or more (cell field 'region'), found one: nothing to write");
  if (!to_medit) return;
  const auto reference = io::medit_references(mesh.info, names, groups.number);
  for (std::size_t p = 0; p < reference.size(); ++p)
    if (reference[p] >= 0) report["references"][names[p]] = reference[p];
}

/// Patches that get a surface by name.
std::vector<std::string> named_patches(const Options& options, const geometry::SurfaceSet& described,
                                       const mesh::MeshInfo& info) {
  auto given = options.patches;
  for (const auto& pair : options.ties) given.push_back(pair.substr(0, pair.find('=')));
  std::vector<std::string> named;
  for (const auto& name : given)
    for (const int patch : mesh::find_patches(info.patches, name)) named.push_back(info.patches[at(patch)].name);
  for (auto& name : meshing::names_of_patches_on(described)) named.push_back(std::move(name));
  return named;
}

/// Associates patches with surfaces where that is asked for. `surfaces`: text of --surfaces. Collective.
void associate(cli::Session& session, const Options& options, const std::string& surfaces, mesh::DistMesh& mesh,
               nlohmann::json& report) {
  const auto& comm = session.comm();
  const bool is_import = !options.from->is_native;
  if (!convert::brings_surfaces(options)) {
    if (is_import && (options.to->is_native || options.order == 2))
      convert::tell_known_shapes(session, convert::find_known_shapes(comm, mesh, {}, false, report));
    return;
  }
  meshing::AssociationRequest request;
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
  par::agree(comm, [&] {
    if (!options.surfaces.empty())
      request.described = meshing::read_surfaces(surfaces, options.surfaces, mesh.info.patches);
    named = named_patches(options, request.described, mesh.info);
  });
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
    }
  }
  if (!comm.is_first()) return;
  for (const auto& remark : meshing::remarks_on(associations, *mesh.info.surfaces)) session.warn(remark);
}

/// Gives flat patches that meet patches with a surface their planes, and says which others refinements will bend.
/// Collective.
void keep_flat_patches(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  if (!convert::asks_for_surfaces(options)) return;
  const auto undescribed = mesh::find_undescribed_patches(session.comm(), mesh);
  mesh.info = mesh::with_planes(std::move(mesh.info), undescribed);
  for (const auto& [patch, plane, n_smooth_faces, continues] : undescribed) {
    const auto& info = mesh.info.patches[static_cast<std::size_t>(patch)];
    if (plane.is_flat)
      report["planes"][info.name] = {{"surface", mesh.info.surface_name(info)}, {"worst_distance", plane.distance}};
  }
  for (const auto& warning : mesh::warnings_of(mesh.info, undescribed)) session.warn(warning);
}

/// Opens faces with two edges on one curved wall, or warns of them. Collective.
void treat_ears(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  const auto& comm = session.comm();
  const bool is_refined =
      comm.any(std::any_of(mesh.lineage.begin(), mesh.lineage.end(), [](auto l) { return l != mesh::Lineage{}; }));
  const bool has_new_surfaces = convert::brings_surfaces(options);
  const bool repair =
      !options.strict && !options.no_repair && (options.repair || (has_new_surfaces && options.from->has_elements));
  if (repair && is_refined)
    throw Error("--repair: expected a mesh of level 0, found cells that were refined (--as-level-0 forgets that)");
  if (is_refined || (!has_new_surfaces && !repair)) return;
  const auto ears = meshing::find_wall_ears(comm, mesh);
  report["wall_ears"] = ears.n_inside;
  report["rim_ears"] = ears.n_at_rims;
  if (repair) {
    report["split_edges"] = ears.edge.size();
    report["split_faces"] = ears.face.size();
  }
  if (ears.count() == 0) return;
  std::string found;
  if (ears.n_inside > 0)
    found = counted(ears.n_inside, "inner face", "inner faces") + " with two edges on one curved wall";
  if (ears.n_at_rims > 0)
    found += fmt::format("{}{} with two edges on the rim of a curved wall", found.empty() ? "" : " and ",
                         counted(ears.n_at_rims, "boundary face", "boundary faces"));
  if (ears.n_left > 0) found += fmt::format(" ({} in a curved or periodic patch, which are left)", ears.n_left);
  const auto splits =
      counted(std::ssize(ears.edge), "edge", "edges") + " and " + counted(std::ssize(ears.face), "face", "faces");
  std::string cure = "make level 0 with shorter edges there";
  if (ears.can_be_opened() && repair)
    cure = fmt::format("{} were split, and the boundary keeps its shape{}", splits,
                       options.repair ? "" : " (--no-repair splits nothing)");
  else if (ears.can_be_opened())
    cure = fmt::format("--repair splits {} and keeps the shape of the boundary", splits);
  session.warn(
      fmt::format("{}: cells behind them lose a third of their mean ratio at every refinement; {}", found, cure));
  if (!repair || !ears.can_be_opened()) return;
  mesh = meshing::open_wall_ears(comm, std::move(mesh), ears);
  mesh.info.provenance += "; repaired at curved walls";
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
        "{} would fold or nearly so with curved edges: {} of {} curved edges {} straighter than their surfaces, "
        "by up to {:.3g}; refine the mesh there",
        counted(straightening.n_cells, "cell", "cells"), straightening.n_edges, curved.n_curved_edges,
        straightening.n_edges == 1 ? "is" : "are", curved.max_off_surface));
  else if (curved.n_off_surface > 0)
    session.warn(
        fmt::format("{} off their surfaces, by up to {:.3g}: no common point of the surfaces "
                    "of their patches was found near by",
                    counted(curved.n_off_surface, "mid-edge node is", "mid-edge nodes are"), curved.max_off_surface));
  return std::move(nodes);
}

std::string summary_of_order(const nlohmann::json& report) {
  return fmt::format(" of second order ({} edges curved, {} straightened)", report["curved_edges"].get<std::int64_t>(),
                     report["straightened_edges"].get<std::int64_t>());
}

cli::ExitCode convert_file(cli::Session& session, Options options) {
  const auto& comm = session.comm();
  if (options.output.empty()) throw Error("OUT: expected the name of a mesh to write, found an empty name");
  options.from = &io::format_to_read(options.input);
  options.to = &io::format_to_write(comm, options.output);
  const auto surfaces = convert::check_files(session, options);

  nlohmann::json report;
  session.step("reading " + options.input);
  auto [mesh, warnings, notes] = convert::read_mesh(session, read_request(options), report);
  adjust(comm, options, mesh);
  convert::forget_levels(session, options, mesh, report);
  validate::require_valid(comm, mesh, options.input);
  convert::treat_tears(session, options, mesh, report);
  session.step(fmt::format("looking at {} cells", mesh.info.n_global_cells));
  associate(session, options, surfaces, mesh, report);
  for (const auto& warning : warnings) session.warn(warning);
  for (const auto& note : notes) session.note(note);
  keep_flat_patches(session, options, mesh, report);
  treat_ears(session, options, mesh, report);
  convert::treat_coarse_walls(session, options, mesh, report);
  std::optional<mesh::SecondOrder> second_order;
  if (options.order == 2) second_order = curve(session, mesh, report);
  session.step(fmt::format("writing {} cells to {}", mesh.info.n_global_cells, options.output));
  write(session, options, mesh, second_order ? &*second_order : nullptr);
  const auto n_nodes = second_order ? second_order->n_global_nodes : mesh.info.n_global_nodes;
  report["cells"] = mesh.info.n_global_cells;
  report["nodes"] = n_nodes;
  report["patches"] = nlohmann::json::array();
  for (const auto& patch : mesh.info.patches) report["patches"].push_back(patch.name);
  report_groups(session, options, mesh, report);
  for (const auto& region : mesh.info.regions) report["regions"][std::to_string(region.number)] = region.name;
  session.write_report(report);
  session.summary(fmt::format("{} cells{}, {} nodes, {} -> {}", mesh.info.n_global_cells,
                              second_order ? summary_of_order(report) : "", n_nodes,
                              counted(std::ssize(mesh.info.patches), "patch", "patches"), options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-convert",
       "Converts meshes from and to the formats of Gmsh, VTK, Medit, SU2, AFLR3, OpenFOAM and CGNS, and from MFEM's.",
       "pamr-convert part.msh part.hdf --surfaces part.toml\npamr-convert level3.hdf level3.vtu\npamr-convert "
       "level3.hdf curved.msh --order 2\npamr-convert level3.hdf foam_case",
       cli::files_in_case},
      [&](cli::CommandLine& line) { convert::declare(line, options); },
      [&](cli::Session& session) { return convert_file(session, options); });
}
