// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "meshing/cad_case.hpp"
#include "meshing/make_mesh.hpp"
#include "meshing/mesh_case.hpp"
#include "meshing/read_mesh_case.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/native/native_file.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string case_file, shape, output, unit = geometry::usual_cad_unit;
  std::vector<std::string> solids;
  int n = 0;
  double size = 0;
  int format = io::newest_format;
  bool force = false, asks_unit = false;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("CASE", options.case_file,
              "case file (TOML) whose table [mesh] says what to mesh, or the solid to mesh (.step, .iges, .brep)");
  line.option("--shape", options.shape,
              "kuhn-cube, blunt-cone, sphere-in-box, charged-spheres or supersonic-sphere, instead of a case file");
  line.option("--n", options.n, "kuhn-cube: cubes a side, 6 cells each").positive();
  line.option("--size", options.size,
              "sphere-in-box: edge length (default 0.28); largest edge length of the others: blunt-cone in meters "
              "(default 0.01), charged-spheres in Debye lengths (default 0.5), supersonic-sphere in meters (default "
              "0.004), "
              "a STEP, IGES or BREP file in --unit (default a fifteenth of its size)")
      .positive();
  auto unit = line.option("--unit", options.unit, "of the mesh of a STEP, IGES or BREP file: mm, cm, m, um, in or ft");
  unit.show_default();
  line.option("--solid", options.solids,
              "name of a solid of a STEP, IGES or BREP file to take, with its number where several have one name, or "
              "without it: all of these; may be given several times (default all solids)")
      .one_at_a_time();
  line.option("-o,--output", options.output, "mesh to write (.hdf)").required();
  line.option("--format", options.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.flag("--force", options.force, cli::force_help);
  line.after_reading([unit, &options] { options.asks_unit = unit.is_given(); });
}

/// A mesh or triangles instead of a case are for other tools, or need a case. Local.
void refuse_mesh(const std::string& file) {
  const auto* format = io::find_format(file);
  if (format == nullptr || format->is_folder) return;
  const auto* found = format->is_surface
                          ? "triangles: name them in a [[surface]] of a case file (docs/tools/"
                            "pamr-mesh-case.md); `pamr-surface info` says whether they are closed"
                          : "the name of a mesh: `pamr-refine` refines a mesh, `pamr-convert` converts one";
  throw Error(fmt::format("{}: expected a case file (TOML) or a solid (STEP, IGES or BREP), found {}", file, found));
}

void require_consistent(const Options& o) {
  refuse_mesh(o.case_file);
  if (o.case_file.empty() == o.shape.empty())
    throw Error(std::string("expected either a case file or --shape, found ") + (o.shape.empty() ? "neither" : "both"));
  if ((o.shape == "kuhn-cube") != (o.n > 0))
    throw Error(o.n > 0 ? "expected --n with --shape kuhn-cube only"
                        : "expected --n N with --shape kuhn-cube, found none");
  const bool is_cad = geometry::is_cad_file(o.case_file);
  if (o.size > 0 && ((o.shape.empty() && !is_cad) || o.shape == "kuhn-cube"))
    throw Error(
        "expected --size with --shape or a STEP, IGES or BREP file only, and not with kuhn-cube; a case file has sizes "
        "of its own");
  if (!geometry::is_cad_unit(o.unit)) throw Error("--unit: expected mm, cm, m, um, in or ft, found " + o.unit);
  if (!o.solids.empty() && !is_cad) throw Error("expected --solid with a STEP, IGES or BREP file only");
  if (o.asks_unit && !is_cad)
    throw Error("expected --unit with a STEP, IGES or BREP file only; a case file has unit in its [[surface]]");
}

/// `text`: of the case file. Collective.
meshing::LevelZero make(const cli::Session& session, const Options& options, const std::string& text) {
  const auto& comm = session.comm();
  if (options.shape == "kuhn-cube") return meshing::make_kuhn_cube(comm, options.n);
  meshing::MeshCase mesh_case;
  const bool is_cad = geometry::is_cad_file(options.case_file);
  par::agree(comm, [&] {  // it may read surface files
    mesh_case = is_cad ? meshing::case_of_cad(options.case_file, {options.unit, options.size, options.solids})
                : options.shape.empty() ? meshing::read_mesh_case(text, options.case_file)
                                        : meshing::case_of_shape(options.shape, options.size);
  });
  const auto show = [&](int done, const char* next) {
    constexpr int n = meshing::Listener::n_steps;
    session.step(done < n ? fmt::format("meshing, step {} of {}: {}", done + 1, n, next) : "meshing: order and check");
  };
  show(0, "interior");
  return meshing::make_mesh(comm, mesh_case,
                            {show, [&](const std::string& warning) { session.warn(warning); },
                             [&](const std::string& note) { session.note(note); }});
}

/// " of the body's 6.28 (-1.2 %)"; empty where the body's volume is not known.
std::string beside_body(double volume, double body_volume) {
  if (!(body_volume > 0)) return {};
  return fmt::format(" of the body's {:.6g} ({:+.1f} %)", body_volume, 100 * (volume / body_volume - 1));
}

cli::ExitCode make_mesh(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  require_consistent(options);
  std::string text;
  if (geometry::is_cad_file(options.case_file))
    session.check_input(options.case_file);
  else if (!options.case_file.empty())
    text = session.read_case(options.case_file);
  session.check_native_output(options.output, options.force);

  const auto made = make(session, options, text);
  const auto& info = made.mesh.info;
  session.step(fmt::format("writing {} cells to {}", info.n_global_cells, options.output));
  io::write_native(comm, options.output, made.mesh, {.format = options.format});

  const auto summary = meshing::summary_of(comm, made.mesh);
  nlohmann::json patches, body_volume, regions = nlohmann::json::object();
  std::vector<std::string> lines;  // of regions
  if (made.body_volume > 0) body_volume = made.body_volume;
  for (std::size_t r = 0; r < made.region_volumes.size(); ++r) {
    const double volume = summary.region_volumes[r], of_solids = made.region_volumes[r];
    auto& region = regions[info.regions[r].name] = {{"number", info.regions[r].number}, {"volume", volume}};
    region["body_volume"] = of_solids > 0 ? nlohmann::json(of_solids) : nlohmann::json();
    lines.push_back(fmt::format("region {} {}: volume {:.6g}{}", info.regions[r].number, info.regions[r].name, volume,
                                beside_body(volume, of_solids)));
  }
  for (std::size_t p = 0; p < info.patches.size(); ++p) patches[info.patches[p].name] = {{"faces", summary.faces[p]}};
  session.write_report({{"cells", info.n_global_cells},
                        {"nodes", info.n_global_nodes},
                        {"min_mean_ratio", summary.min_mean_ratio},
                        {"volume", summary.volume},
                        {"body_volume", body_volume},
                        {"patches", patches},
                        {"regions", regions},
                        {"split_edges", made.split_edges},
                        {"split_faces", made.split_faces}});
  session.summary(fmt::format("{} cells, {} nodes, smallest mean ratio {:.3f}, volume {:.6g}{} -> {}",
                              info.n_global_cells, info.n_global_nodes, summary.min_mean_ratio, summary.volume,
                              beside_body(summary.volume, made.body_volume), options.output));
  for (const auto& line : lines) session.summary(line);
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-mesh", "Makes a level-0 mesh of tetrahedra.",
       "pamr-mesh --shape kuhn-cube --n 8 -o cube.hdf\npamr-mesh --shape sphere-in-box --size 0.28 -o sphere.hdf\n"
       "pamr-mesh part.step -o part.hdf --size 2",
       cli::files_in_case, true},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return make_mesh(session, options); });
}
