// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "cli/text_file.hpp"
#include "meshing/mesh3.hpp"
#include "meshing/mesh_case.hpp"
#include "meshing/order_raw_mesh.hpp"
#include "meshing/peel.hpp"
#include "meshing/repair/wall_ears.hpp"
#include "meshing/snap.hpp"
#include "meshing/to_block_mesh.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string case_file, shape, output;
  int n = 0;
  double size = 0;
  bool force = false;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("CASE", options.case_file, "case file (TOML) whose table [mesh] says what to mesh");
  line.option("--shape", options.shape,
              "kuhn-cube, blunt-cone, sphere-in-box, charged-spheres or supersonic-sphere, instead of a case file");
  line.option("--n", options.n, "kuhn-cube: cubes a side, 6 cells each").positive();
  line.option(
          "--size", options.size,
          "sphere-in-box: edge length (default 0.28); largest edge length of the others: blunt-cone in meters "
          "(default 0.01), charged-spheres in Debye lengths (default 0.5), supersonic-sphere in meters (default 0.004)")
      .positive();
  line.option("-o,--output", options.output, "mesh to write (.hdf)").required();
  line.flag("--force", options.force, cli::force_help);
}

void require_consistent(const Options& o) {
  if (o.case_file.empty() == o.shape.empty())
    throw Error(std::string("expected either a case file or --shape, found ") + (o.shape.empty() ? "neither" : "both"));
  if ((o.shape == "kuhn-cube") != (o.n > 0))
    throw Error(o.n > 0 ? "expected --n with --shape kuhn-cube only"
                        : "expected --n N with --shape kuhn-cube, found none");
  if (o.size > 0 && (o.shape.empty() || o.shape == "kuhn-cube"))
    throw Error("expected --size with --shape only, and not with kuhn-cube");
}

meshing::RawMesh level_zero(const cli::Session& session, const meshing::Domain& domain, unsigned seed) {
  auto progress = session.progress("meshing", 3, "steps");
  auto raw = meshing::run_mesh3(domain, seed);
  progress.update(1, "boundary");
  meshing::place_boundary(domain, raw);
  meshing::peel(domain, raw);
  progress.update(2, "quality");
  meshing::improve(domain, raw);
  raw = meshing::ordered(raw);
  progress.update(3);
  return raw;
}

/// Whether two domains that differ by their sizes differ in these anywhere inside: on a grid.
bool differ_in_sizes(const meshing::Domain& a, const meshing::Domain& b) {
  constexpr int n = 32;
  const double step = 2 * a.radius / n;
  for (int i = 0; i < n * n * n; ++i) {
    const geometry::Vec3 grid{i % n + 0.5 - n / 2, i / n % n + 0.5 - n / 2, i / n / n + 0.5 - n / 2};
    const auto p = a.center + step * grid;
    if (a.label(p) == meshing::Domain::inside && a.size(p) != b.size(p)) return true;
  }
  return false;
}

/// Where edges as long as wanted cannot tell the two sides of a gap apart, the mesh is made again with shorter ones in
/// the gaps; the first error where that does not help either.
meshing::RawMesh make_here(const cli::Session& session, const meshing::MeshCase& mesh_case,
                           const meshing::Domain& domain) {
  try {
    return level_zero(session, domain, mesh_case.seed);
  } catch (const Error& first) {
    if (mesh_case.combination.region.empty()) throw Error(mesh_case.where + ": " + first.what());
    for (const double factor : {3.0, 1.5}) {
      auto finer_case = mesh_case;
      finer_case.combination.gap_factor = factor;
      try {
        const auto finer = meshing::domain_of(finer_case);
        if (!differ_in_sizes(domain, finer)) continue;
        auto raw = level_zero(session, finer, mesh_case.seed);
        session.warn(
            fmt::format("{}: two surfaces are nearer to each other than edges of the wanted sizes can follow: "
                        "edges in the gaps are at most {:g} times as long as these are wide",
                        mesh_case.where, factor));
        return raw;
      } catch (const Error&) {
        continue;
      }
    }
    throw Error(mesh_case.where + ": " + first.what());
  }
}

/// Rank 0 makes the mesh while the others wait. Collective.
mesh::BlockMesh make_with_cgal(const cli::Session& session, const meshing::MeshCase& mesh_case) {
  const auto& comm = session.comm();
  meshing::Domain domain;
  par::agree(comm, [&] {
    domain = meshing::domain_of(mesh_case);
    if (!comm.is_first()) return;
    for (const auto& surface : domain.triangulations)
      if (const auto warning = geometry::self_intersection_warning(surface); !warning.empty()) session.warn(warning);
  });
  meshing::RawMesh raw;
  par::agree(comm, [&] {
    if (comm.is_first()) raw = make_here(session, mesh_case, domain);
  });
  auto block = meshing::to_block_mesh(comm, domain, raw);
  block.info.provenance = meshing::describe(mesh_case);
  return block;
}

/// What the mesh is like. Collective.
nlohmann::json report_on(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<std::int64_t> n_faces(mesh.info.patches.size(), 0);
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
    for (const auto slot : mesh.cell_to_cell[static_cast<std::size_t>(c)])
      if (slot < 0) ++n_faces[static_cast<std::size_t>(mesh::slot_to_patch(slot))];
  }
  comm.sum_in_place(n_faces);
  nlohmann::json patches;
  for (std::size_t p = 0; p < n_faces.size(); ++p) patches[mesh.info.patches[p].name] = {{"faces", n_faces[p]}};
  return {{"cells", mesh.info.n_global_cells},
          {"nodes", mesh.info.n_global_nodes},
          {"min_mean_ratio", comm.min(worst)},
          {"patches", patches}};
}

cli::ExitCode make_mesh(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  require_consistent(options);
  std::vector<std::string> inputs;
  if (!options.case_file.empty()) {
    session.check_input(options.case_file);
    inputs.push_back(options.case_file);
  }
  session.check_output(options.output, inputs, options.force);

  mesh::BlockMesh block;
  if (options.shape == "kuhn-cube") {
    block = assemble::kuhn_cube(comm, options.n);
    block.info.provenance = fmt::format("pamr-mesh: shape kuhn-cube, n {}", options.n);
  } else {
    meshing::MeshCase mesh_case;
    const auto text = options.case_file.empty() ? std::string() : cli::read_text(comm, options.case_file);
    par::agree(comm, [&] {  // it may read surface files
      mesh_case = options.shape.empty() ? meshing::read_case(text, options.case_file)
                                        : meshing::case_of_shape(options.shape, options.size);
    });
    block = make_with_cgal(session, mesh_case);
  }
  const auto destination = meshing::block_destinations(comm, block);
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  const auto ears = meshing::find_wall_ears(comm, mesh);
  mesh = meshing::open_wall_ears(comm, std::move(mesh), ears);
  validate::require_valid(comm, mesh, "the new mesh");
  io::write_native(comm, options.output, mesh);

  auto report = report_on(comm, mesh);
  report["split_edges"] = ears.edge.size();
  report["split_faces"] = ears.face.size();
  session.write_report(report);
  session.summary(fmt::format("{} cells, {} nodes, smallest mean ratio {:.3f} -> {}", mesh.info.n_global_cells,
                              mesh.info.n_global_nodes, report["min_mean_ratio"].get<double>(), options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-mesh", "Makes a level-0 mesh of tetrahedra.",
       "pamr-mesh --shape kuhn-cube --n 8 -o cube.hdf\n  pamr-mesh --shape sphere-in-box --size 0.28 -o sphere.hdf"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return make_mesh(session, options); });
}
