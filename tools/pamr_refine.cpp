// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "adapt/flat_patches.hpp"
#include "cli/run_tool.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/adapt/level0.hpp"
#include "pamr/adapt/read_for_refinement.hpp"
#include "pamr/adapt/refine_report.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/version.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/check/shape_bound.hpp"
#include "pamr/check/wall_shapes.hpp"
#include "pamr/curved/level0_shapes.hpp"
#include "pamr/curved/make_level0_map.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/refine/cell_shape.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/integrals.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string input, output, marks = "refine", quality_control = "removable", balance = "auto", weights = "exact",
                             order = "auto";
  double shape_floor = refine::default_shape_floor;
  std::string bend = "walls";
  bool floors = false;
  int format = io::newest_format;
  std::vector<std::string> integrals;
  bool no_project = false, dry_run = false, force = false, each_rank = false;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("MESH", options.input, "mesh to read, with a cell field of marks").required();
  auto output = line.option("-o,--output", options.output, "refined mesh to write");
  auto force = line.flag("--force", options.force, cli::force_help);
  line.option("--marks", options.marks, "integer cell field: -1 may be coarsened, 0 keep, 1 split; not in the result")
      .show_default();
  line.group("Shapes of cells", "pamr-refine marked.hdf -o fine.hdf --shape-floor 0.35");
  line.option("--quality-control", options.quality_control, "what happens to a closure cell that has to be refined")
      .one_of(refine::quality_control_list())
      .show_default();
  auto floor = line.option("--shape-floor", options.shape_floor,
                           "of removable: smallest mean ratio of closure cells, as far as 1:8 reaches it; 0: none");
  floor.type_name("TAU").range(0.0, 1.0).show_default();
  auto bend =
      line.option("--bend", options.bend,
                  "inner edges of level 0 that may bend for better shapes, when it is split for the first time");
  bend.one_of(refine::bend_list()).show_default();
  line.flag("--no-project", options.no_project, "leave new boundary nodes in the middle of their edges");
  line.group("Ranks and order", "mpirun -n 4 pamr-refine marked.hdf -o fine.hdf --balance scotch --order keep");
  line.option("--balance", options.balance, "how cells are spread over the ranks before they are split")
      .one_of({"auto", "scotch", "curve", "blocks", "none"})
      .show_default();
  auto weights = line.option(
      "--weights", options.weights,
      "what a cell weighs then: the exact number of cells that it becomes, 8 where marked, 1, or a cell field");
  weights.type_name("exact|8/1|uniform|FIELD").show_default();
  line.option("--order", options.order, "put cells and nodes along a space-filling curve first (auto: where it pays)")
      .one_of({"auto", "keep", "curve"})
      .show_default();
  line.group("Result and report", "pamr-refine marked.hdf --dry-run --floors");
  line.option("--integral", options.integrals,
              "cell field whose sum of value times volume is kept at curved walls too; may be repeated")
      .type_name("FIELD");
  auto dry_run = line.flag("--dry-run", options.dry_run, "print the exact size of the result, split nothing");
  auto floors = line.flag("--floors", options.floors, "with --dry-run: the size under other shape floors as well");
  auto format = line.option("--format", options.format, cli::format_help);
  format.range(io::oldest_format, io::newest_format).show_default();
  auto each_rank = line.flag("--each-rank", options.each_rank, "the report lists every rank's share of each step too");
  each_rank.excludes(dry_run);
  line.after_reading([=, &options] {
    cli::CommandLine::refuse_ignored(weights, options.balance != "none", "a --balance other than none");
    cli::CommandLine::refuse_ignored(bend, !options.no_project || options.bend == "none", "no --no-project");
    cli::CommandLine::refuse_ignored(floor, options.quality_control == "removable", "--quality-control removable");
    cli::CommandLine::refuse_ignored(floors, options.quality_control == "removable", "--quality-control removable");
    cli::CommandLine::refuse_ignored(format, output.is_given(), "--output");
    cli::CommandLine::refuse_ignored(force, output.is_given(), "--output");
    if (options.floors && !dry_run.is_given()) cli::CommandLine::refuse_without("--dry-run (beside --floors)");
    if (!output.is_given() && !dry_run.is_given()) cli::CommandLine::refuse_without("--output (or --dry-run)");
  });
}

/// Fills what is counted cell by cell.
void assess_cells(const par::Comm& comm, const mesh::DistMesh& mesh, double shape_floor, adapt::Measured& measured) {
  std::array<std::int64_t, 2> n{};
  const double least = refine::equal_cubes * refine::cubed(shape_floor);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    n[0] += geometry::is_positive(p[0], p[1], p[2], p[3]) ? 0 : 1;
    n[1] += refine::cube_of_shape * refine::shape(p) < least ? 1 : 0;
  }
  comm.sum_in_place(n);
  measured.inverted_cells = n[0];
  measured.cells_below_floor = n[1];
}

void warn_too_deep(const cli::Session& session, std::int64_t n) {
  if (n > 0) session.warn(adapt::too_deep_text(n));
}

/// Families that could not be undone make bad cells; a lower floor asks for fewer closures that never were.
void warn_kept(const cli::Session& session, std::int64_t n, const refine::Options& options) {
  if (n == 0 || options.quality_control != refine::QualityControl::removable || options.shape_floor == 0) return;
  session.warn(
      fmt::format("{}, which makes bad "
                  "cells: try a --shape-floor below {}, or a finer mesh at curved walls",
                  counted(n, "family of closure cells could not be undone and was split as it is",
                          "families of closure cells could not be undone and were split as they are"),
                  options.shape_floor));
}

/// Says where cells at walls are worse than straight ones could be.
void warn_lost_shapes(const cli::Session& session, const check::WallShapes& before, const check::WallShapes& after) {
  if (after.n_below == 0) return;
  const auto p = after.where;
  session.warn(
      fmt::format("{} a mean ratio under {:.3g}, the smallest {:.3g} near ({:.6g}, {:.6g}, {:.6g}), "
                  "where {:.3g} was the smallest before: walls or sharp edges are too coarse there for how they curve, "
                  "and the next levels lose more; make level 0 with shorter edges there",
                  counted(after.n_below, "cell at walls has", "cells at walls have"),
                  check::limit_of_lost_shape(before), after.smallest, p.x, p.y, p.z, before.smallest));
}

/// What was marked, and what went.
std::string marked_text(std::int64_t marked, const adapt::CoarseningReport& coarsening) {
  if (coarsening.cells_flagged == 0) return fmt::format("{} marked", marked);
  return fmt::format("{} marked, {} may be coarsened: {} octets coarsened", marked, coarsening.cells_flagged,
                     coarsening.octets_gone);
}

void warn_nothing_goes(const cli::Session& session, const adapt::CoarseningReport& report) {
  if (const auto text = adapt::nothing_coarsened_text(report); !text.empty()) session.warn(text);
}

std::string place_text(geometry::Vec3 p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

/// Notes and warnings about the map of level 0 that was made for coarse walls.
void tell_of_map(const cli::Session& session, const curved::Level0Report& level0) {
  if (level0.n_moved > 0)
    session.note(
        fmt::format("{} nodes of level 0 lay up to {:.3g} off their walls, which are coarse, and were put onto them",
                    level0.n_moved, level0.farthest_moved));
  if (!level0.trouble.empty()) {
    session.warn(level0.trouble + ": cells there may lose shape from level to level");
    return;
  }
  if (level0.n_bent_cells == 0) return;
  const auto& shapes = level0.shapes;
  session.note(fmt::format(
      "map of level 0: mean ratio of its Jacobian in {} bent cells proved to be at least {:.4g}, smallest near "
      "{}; curved walls, which the proof leaves out, make it {:.4g} at 20 points of each cell",
      level0.n_bent_cells, shapes.mean_ratio.value, place_text(shapes.mean_ratio.where), level0.smallest));
  session.note(fmt::format("splitting these cells into eight alone: mean ratio at least {:.4g}, smallest near {}",
                           shapes.all_splits.value, place_text(shapes.all_splits.where)));
}

/// What later levels can make of the shapes, also in the report. Collective.
check::ShapeBound bound_shapes(const cli::Session& session, const adapt::ReadyMesh& ready, double shape_floor,
                               nlohmann::json& report) {
  const auto& mesh = ready.mesh.get();
  auto bound = check::shape_bound(session.comm(), mesh, shape_floor);
  if (mesh::has_level0(mesh)) {
    const bool is_new = ready.level0.n_bent_cells > 0;
    const auto shapes = is_new ? ready.level0.shapes : curved::level0_shapes(session.comm(), *mesh.info.level0);
    report["level0"]["shapes"] = adapt::to_json(shapes);
    bound.of_uniform_levels = std::min(bound.of_uniform_levels, shapes.all_splits.value);
    bound.of_all_levels = std::min(bound.of_all_levels, shapes.all_splits.value);
  }
  report["uniform_shape_bound"] = bound.of_uniform_levels;
  return bound;
}

constexpr std::array<double, 6> floors_to_compare{0, 0.3, 0.35, 0.4, 0.45, 0.5};

cli::ExitCode report_forecast(cli::Session& session, const mesh::DistMesh& input, std::span<const std::int8_t> flags,
                              const refine::Options& options, bool show_floors) {
  const auto& comm = session.comm();
  const auto ready = adapt::with_level0_map(comm, input, flags, options);  // made once for all floors
  tell_of_map(session, ready.level0);
  const auto& mesh = ready.mesh.get();
  const adapt::Forecaster forecaster(comm, mesh, options);
  const auto forecast = forecaster.forecast(flags);
  const auto nodes = forecaster.nodes(forecast);
  const auto marked = forecast.report.n_marked;
  const bool coarsens = forecast.coarsening.cells_flagged > 0;
  warn_too_deep(session, forecast.marked_too_deep);
  // what is there now (the process, the old mesh) and, at the peak, the plan of the split and the new mesh: at rest 48
  // bytes a cell and 32 a node
  const double nodes_per_cell = static_cast<double>(nodes) / static_cast<double>(forecast.cells);
  const double here = static_cast<double>(peak_resident_bytes()) + 40.0 * static_cast<double>(mesh.n_cells()) +
                      static_cast<double>(forecast.cells_on_this_rank) * (48 + 32 * nodes_per_cell);
  const auto largest = comm.max(static_cast<std::int64_t>(here));
  nlohmann::json report{{"cells_in", mesh.info.n_global_cells},
                        {"nodes_in", mesh.info.n_global_nodes},
                        {"marked", marked},
                        {"marked_too_deep", forecast.marked_too_deep},
                        {"cells_out", forecast.cells},
                        {"nodes_out", nodes},
                        {"largest_rank_bytes", largest}};
  std::string shapes;
  if (show_floors) {
    for (const double floor : floors_to_compare) {
      auto how = options;
      how.shape_floor = floor;
      const auto cells = adapt::Forecaster(comm, mesh, how).forecast(flags).cells;
      report["floors"].push_back({{"shape_floor", floor}, {"cells", cells}});
      shapes += fmt::format("; floor {}: {} cells", floor, cells);
    }
  }
  if (coarsens) {
    report["coarsening"] = to_json(forecast.coarsening);
    warn_nothing_goes(session, forecast.coarsening);
  } else {
    const auto bound = bound_shapes(session, ready, options.shape_floor, report);
    if (show_floors) shapes += fmt::format("; splitting into eight alone: mean ratio {:.4f}", bound.of_uniform_levels);
    if (options.quality_control == refine::QualityControl::removable) {
      report["shape_bound"] = bound.of_all_levels;
      shapes += fmt::format("; mean ratio at least {:.4f} at every level ({}where cells are straight{})",
                            bound.of_all_levels, mesh::has_level0(mesh) ? "proved " : "",
                            mesh::has_level0(mesh) ? ", estimated from three levels near coarse walls" : "");
    }
  }
  session.write_report(report);
  session.summary(fmt::format("{} {}: {} cells, {} nodes after refinement, about {:.0f} MB on the largest rank{}",
                              coarsens ? fmt::format("{} cells", mesh.info.n_global_cells)
                                       : fmt::format("{} of {} cells", marked, mesh.info.n_global_cells),
                              coarsens ? fmt::format("({})", marked_text(marked, forecast.coarsening)) : "marked",
                              forecast.cells, nodes, 1e-6 * static_cast<double>(largest), shapes));
  return cli::ExitCode::done;
}

std::string below_text(const Options& options, std::int64_t n_below) {
  if (options.quality_control != "removable" || n_below == 0) return {};
  return fmt::format(", {} cells under {}", n_below, options.shape_floor);
}

/// A part of the summary for meshes in which the default floor adds many cells. In most meshes it adds 3 to 6 %.
std::string cost_text(double share, double lower_floor) {
  if (share <= (lower_floor > 0 ? 0.05 : 0.25)) return {};
  return fmt::format(", some {:.0f} % more cells than with --shape-floor {}", 100 * share, lower_floor);
}

/// What of the command decides on the result.
void add_provenance(const Options& options, std::string& provenance) {
  const auto floor = options.quality_control == "removable" && options.shape_floor != refine::default_shape_floor
                         ? fmt::format(" --shape-floor {}", options.shape_floor)
                         : std::string();
  const auto placing = options.no_project        ? std::string(" --no-project")
                       : options.bend != "walls" ? " --bend " + options.bend
                                                 : std::string();
  provenance +=
      fmt::format("{}pamr-refine {} --quality-control {}{}{}{}", provenance.empty() ? "" : "\n", version(),
                  options.quality_control, floor, placing, options.order == "auto" ? "" : " --order " + options.order);
}

/// The marks, of a mesh in which the numbers of the parents replace no data. Collective.
std::vector<std::int8_t> read_flags(const par::Comm& comm, const mesh::DistMesh& mesh, const Options& options) {
  using Number = std::numeric_limits<std::int64_t>;
  mesh::require_replaceable(comm, mesh,
                            {mesh::parent_field, "the numbers of the parents", Number::min(), Number::max()});
  return adapt::signed_flags_from_field(comm, mesh, options.marks);
}

/// The fields that the refinement would ask for. Collective.
void require_named_fields(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Options& options,
                          const adapt::Balancing& balancing) {
  refine::require_integrals(comm, mesh, options.integrals);
  if (balancing.weights == adapt::Weights::field) balance::weights_from_field(comm, mesh, balancing.field);
}

/// Adapts the mesh; notes and warnings about the map of level 0 come first. Collective.
adapt::Result adapt_telling(const cli::Session& session, mesh::DistMesh mesh, std::span<const std::int8_t> flags,
                            adapt::Options options, StepTimer& timer) {
  auto ready = adapt::with_level0_map(session.comm(), std::move(mesh), flags, options.refinement);
  tell_of_map(session, ready.level0);
  timer.lap("preprocessing");
  options.compares_floors = session.wants_report() || !session.options().quiet;
  return adapt::adapt_ready(session.comm(), std::move(ready), flags, options);
}

cli::ExitCode work(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  if (options.each_rank && !session.wants_report()) throw Error("--each-rank: expected --json beside it, found none");
  session.check_input(options.input);
  if (!options.dry_run || !options.output.empty()) session.check_native_output(options.output, options.force);

  StepTimer timer([&] { return comm.traffic(); });
  const auto read_before = adapt::bytes_read_so_far();
  const auto balancing = adapt::balancing_named(options.balance, options.weights);
  if (const auto line = balance::what_stands_in(balancing.how.method); !line.empty()) session.note(line);
  session.step("reading " + options.input);
  auto mesh = adapt::read_for_refinement(comm, options.input,
                                         {.marks_field = options.marks,
                                          .ordering = adapt::ordering_named(options.order),
                                          .balancing = balancing,
                                          .build_surfaces = !options.no_project,
                                          .remark = session.remarks()},
                                         timer);
  adapt::Measured measured;
  measured.bytes_read = adapt::bytes_read_so_far() - read_before;
  const auto flags = with_file_name(options.input, [&] { return read_flags(comm, mesh, options); });
  const refine::Options how{.quality_control = refine::quality_control_named(options.quality_control),
                            .shape_floor = options.shape_floor,
                            .project = !options.no_project,
                            .bend = refine::bend_named(options.bend),
                            .parent_field = true,
                            .marks_field = options.marks,
                            .integrals = options.integrals};
  session.step(fmt::format("refining {} cells", mesh.info.n_global_cells));
  if (options.dry_run) {
    with_file_name(options.input, [&] { require_named_fields(comm, mesh, how, balancing); });
    return report_forecast(session, mesh, flags, how, options.floors);
  }
  if (!options.no_project) tools::keep_flat_patches(session, mesh);

  const auto walls_before = options.no_project ? check::WallShapes() : check::wall_shapes(comm, mesh, 0);
  auto result = with_file_name(options.input, [&] {
    return adapt_telling(session, std::move(mesh), flags, {how, balancing}, timer);
  });
  timer.skip();
  session.step(fmt::format("checking {} cells", result.mesh.info.n_global_cells));
  assess_cells(comm, result.mesh, options.shape_floor, measured);
  const auto walls_after = options.no_project
                               ? check::WallShapes()
                               : check::wall_shapes(comm, result.mesh, check::limit_of_lost_shape(walls_before));
  measured.fingerprint = mesh::fingerprint(comm, result.mesh);
  measured.cells_here = result.mesh.n_cells();
  measured.lists_ranks = options.each_rank;
  measured.bytes_at_rest = mesh::bytes_at_rest(result.mesh);
  timer.lap(adapt::Measured::check_step);
  add_provenance(options, result.mesh.info.provenance);
  session.step(fmt::format("writing {} cells to {}", result.mesh.info.n_global_cells, options.output));
  io::write_native(comm, options.output, result.mesh,
                   {.fingerprint = measured.fingerprint, .format = options.format, .remark = session.remarks()});
  timer.lap("write");

  if (const auto warning = mesh::warning_of_periodic(result.mesh.info.patches); !warning.empty()) session.warn(warning);
  warn_too_deep(session, result.report.marked_too_deep);
  warn_kept(session, result.report.closure.families_kept, how);
  if (options.quality_control == "removable" && options.shape_floor > 0)
    warn_lost_shapes(session, walls_before, walls_after);
  if (result.report.closure.n_marked == 0 && result.coarsening.cells_flagged == 0)
    session.warn(fmt::format("nothing is marked in the field '{}': the output is the input mesh", options.marks));
  warn_nothing_goes(session, result.coarsening);
  if (session.wants_report()) {  // more than a hundred reductions
    measured.steps = merge_steps(timer.steps(), result.report.steps);
    auto report = adapt::make_report(comm, result.report, measured);
    report["coarsening"] = to_json(result.coarsening);
    report["walls"] = {{"min_mean_ratio_before", walls_before.smallest},
                       {"min_mean_ratio", walls_after.smallest},
                       {"cells_that_lost_shape", walls_after.n_below}};
    session.write_report(report);
  }
  session.summary(fmt::format("{} cells ({}) -> {} cells, {} nodes, {} off their surface{}{}: {}",
                              result.report.cells_in, marked_text(result.report.closure.n_marked, result.coarsening),
                              result.report.cells_out, result.report.nodes_out, result.report.certificate.n_off_surface,
                              below_text(options, measured.cells_below_floor),
                              cost_text(result.report.floor_cost, result.report.lower_floor), options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-refine", "Refines a mesh once where its cells are marked, and coarsens it where cells may be coarsened.",
       "mpirun -n 4 pamr-refine level0.hdf -o level1.hdf --json level1.json"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return work(session, options); });
}
