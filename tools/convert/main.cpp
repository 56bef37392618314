// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/run_tool.hpp"
#include "cli/text_file.hpp"
#include "convert/tie.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/self_intersection.hpp"
#include "pamr/io/gmsh.hpp"
#include "pamr/io/native_file.hpp"
#include "pamr/io/write_gmsh.hpp"
#include "pamr/io/write_vtu.hpp"
#include "pamr/mesh/assemble.hpp"
#include "pamr/mesh/validate.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string input, output, surfaces, gmsh_version = "4.1";
  std::vector<std::string> ties;
  double tolerance = -1e-6;
  bool repair = false, strict = false, text = false, force = false;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("IN", options.input, "mesh to read: .hdf (native) or .msh (Gmsh 2.2 or 4.1, text or binary)")
      ->required();
  app.add_option("OUT", options.output, "mesh to write: .hdf, .msh or .vtu")->required();
  app.add_flag("--repair", options.repair, "turn inverted cells of a .msh over instead of refusing them");
  app.add_flag("--strict", options.strict,
               "refuse what would only be reported: inverted cells, nodes of no cell, "
               "boundary faces without tag");
  app.add_option("--surfaces", options.surfaces, "TOML file of surfaces to tie patches to (docs/surfaces.md)");
  app.add_option("--tie", options.ties, "PATCH=SURFACE, where the two have different names");
  app.add_option("--tolerance", options.tolerance,
                 "largest distance of a node from its surface, length units (default: 1e-6 of the mesh's size)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--gmsh-version", options.gmsh_version, "format of a .msh to write")
      ->check(CLI::IsMember({"2.2", "4.1"}))
      ->capture_default_str();
  app.add_flag("--text", options.text, "write a .msh as text instead of binary");
  app.add_flag("--force", options.force, cli::force_help);
}

std::string extension(const std::string& file, std::initializer_list<std::string_view> known) {
  const auto found = std::filesystem::path(file).extension().string();
  std::string list;
  for (const auto ending : known) {
    if (found == ending) return found;
    list += (list.empty() ? "" : ", ") + std::string(ending);
  }
  throw Error("file '" + file + "': expected a name that ends in " + list + ", found \"" + found + "\"");
}

/// Reads either format; says what the reader had to change.
mesh::DistMesh read(cli::Session& session, const Options& options, nlohmann::json& report) {
  const auto& comm = session.comm();
  if (extension(options.input, {".hdf", ".msh"}) == ".hdf")
    return mesh::assemble(comm, io::read_native(comm, options.input));
  auto read = io::read_gmsh(comm, options.input, {.repair = options.repair && !options.strict});
  report["turned_cells"] = read.n_turned;
  report["dropped_nodes"] = read.n_dropped_nodes;
  report["untagged_faces"] = read.n_untagged_faces;
  if (options.strict && read.n_dropped_nodes > 0)
    throw Error(fmt::format("file '{}': expected nodes that belong to cells, found {} others", options.input,
                            read.n_dropped_nodes));
  if (options.strict && read.n_untagged_faces > 0)
    throw Error(fmt::format("file '{}': expected a triangle on every boundary face, found {} faces without",
                            options.input, read.n_untagged_faces));
  if (read.n_turned > 0) session.warn(fmt::format("{} inverted cells were turned over", read.n_turned));
  if (read.n_dropped_nodes > 0) session.warn(fmt::format("{} nodes of no cell were left out", read.n_dropped_nodes));
  if (read.n_untagged_faces > 0 && read.mesh.info.patches.size() > 1)
    session.warn(fmt::format("{} boundary faces without tag are in the patch 'boundary'", read.n_untagged_faces));
  read.mesh.info.provenance = "pamr-convert from Gmsh";
  return std::move(read.mesh);
}

void write(const par::Comm& comm, const Options& options, const mesh::DistMesh& mesh) {
  const auto ending = extension(options.output, {".hdf", ".msh", ".vtu"});
  if (ending == ".hdf") io::write_native(comm, options.output, mesh);
  if (ending == ".vtu") io::write_vtu(comm, options.output, mesh);
  if (ending == ".msh")
    io::write_gmsh(comm, options.output, mesh,
                   {options.gmsh_version == "2.2" ? io::GmshVersion::v2_2 : io::GmshVersion::v4_1, !options.text});
}

cli::ExitCode convert(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  (void)extension(options.input, {".hdf", ".msh"});
  (void)extension(options.output, {".hdf", ".msh", ".vtu"});
  std::vector<std::string> inputs{options.input};
  session.check_input(options.input);
  if (!options.surfaces.empty()) {
    session.check_input(options.surfaces);
    inputs.push_back(options.surfaces);
  }
  if (options.surfaces.empty() && !options.ties.empty())
    throw Error("--tie: expected --surfaces beside it, found none");
  session.check_output(options.output, inputs, options.force);

  nlohmann::json report;
  auto mesh = read(session, options, report);
  mesh::require_valid(comm, mesh, options.input);
  if (!options.surfaces.empty())
    for (const auto& tie : convert_tool::tie_patches(comm, mesh, cli::read_text(comm, options.surfaces),
                                                     options.surfaces, options.ties, options.tolerance))
      report["ties"][tie.patch] = {{"surface", tie.surface}, {"worst_distance", tie.worst_distance}};
  if (comm.is_first())
    for (const auto& surface : mesh.info.triangulations)
      if (const auto warning = geometry::self_intersection_warning(surface); !warning.empty()) session.warn(warning);
  write(comm, options, mesh);
  report["cells"] = mesh.info.n_global_cells;
  report["nodes"] = mesh.info.n_global_nodes;
  report["patches"] = nlohmann::json::array();
  for (const auto& patch : mesh.info.patches) report["patches"].push_back(patch.name);
  session.write_report(report);
  session.summary(fmt::format("{} cells, {} nodes, {} patches -> {}", mesh.info.n_global_cells,
                              mesh.info.n_global_nodes, mesh.info.patches.size(), options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-convert", "Converts meshes from and to Gmsh's format, and to VTK's.",
       "pamr-convert part.msh part.hdf --surfaces part.toml\n  pamr-convert level3.hdf level3.vtu"},
      [&](CLI::App& app) { declare(app, options); }, [&](cli::Session& session) { return convert(session, options); });
}
