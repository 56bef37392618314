// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/run_tool.hpp"
#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/balance/expected_work.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mark/criteria.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string input, output, marks = "refine", quality_control = "removable";
  std::optional<std::int64_t> max_cells;
  std::vector<mark::Given> given;  ///< criteria and limits, in the order of the command line
  int format = io::newest_format;
  bool all = false, coarsen_rest = false, fill = false, force = false;
  double shape_floor = refine::default_shape_floor;
};

struct OptionHelp {
  const char* name;
  const char* type;
  const char* text;
};
/// An entry without a type begins a group of --help: its heading and its example.
constexpr std::array<OptionHelp, 26> criteria_help{{
    {"Criteria of places", nullptr, "pamr-mark a.hdf -o b.hdf --patch wall --layers 2 --box 0,0,0,1,1,1"},
    {"--crossing-sphere", "X,Y,Z,R", "cells whose least corner distance from (X,Y,Z) is below R and greatest above"},
    {"--centroid-shell", "X,Y,Z,R,W", "cells whose centroid is nearer than W to the sphere of radius R"},
    {"--box", "X0,Y0,Z0,X1,Y1,Z1", "cells whose centroid lies in the closed box"},
    {"--patch", "NAME", "cells with a face on this boundary patch, or on these: \"face_*\""},
    {"--layers", "N", "of --patch: N layers of cells, those on the patch and then those sharing a node (default 1)"},
    {"Criteria of fields", nullptr, "pamr-mark flow.hdf -o b.hdf --field density --above 1.5"},
    {"--field", "NAME", "cells by a field (nodal fields: mean of the corners), with --above or --below"},
    {"--above", "V", "of --field: where it is above V"},
    {"--below", "V", "of --field: where it is below V"},
    {"--size-over", "FIELD", "cells larger than --ratio times the length that this field gives"},
    {"--ratio", "A", "of --size-over: size / length > A"},
    {"--recovered-error", "FIELD", "cells by the error of this nodal field's gradient, with one of the next three"},
    {"--theta", "T", "of --recovered-error: squared error > T * squared norm / cells"},
    {"--target", "EPS", "of --recovered-error: the same with T = EPS^2, a relative error"},
    {"--bulk", "FRACTION", "of --recovered-error: the fewest cells that carry this part of the squared error"},
    {"--bulk-of", "FIELD[:FRACTION]",
     "the fewest cells that carry this part (0.3) of the sum of a field (an error estimate)"},
    {"Coarsening", nullptr, "pamr-mark flow.hdf -o b.hdf --field density --above 1.5 --coarsen-below 1.2 --keep-for 2"},
    {"--coarsen-below", "V",
     "of a criterion with a value: cells that would not meet it with V in its place may be coarsened, if no other "
     "needs them"},
    {"--min-level", "L", "cells of level L and below are not coarsened (default 0)"},
    {"--keep-for", "N",
     "cells that may be coarsened stay the first N times in a row that they are marked so (default 0)"},
    {"Limits", nullptr, "pamr-mark flow.hdf -o b.hdf --all --max-level 3 --only-where density:above:1.1"},
    {"--size", "cbrt|longest-edge", "size of a cell: cube root of its volume (default) or longest edge"},
    {"--max-level", "L", "limit: only cells whose base cell has a level below L, so that none becomes finer than L"},
    {"--only-where", "FIELD:above:V", "limit: only cells where this field is above (or below) V"},
    {"--error", "FIELD[:TIMES]",
     "of --only-where: by more than TIMES (3) times this field, the standard error of the other"},
}};

void declare(cli::CommandLine& line, Options& options) {
  line.option("MESH", options.input, "mesh to read").required();
  line.option("-o,--output", options.output, "mesh to write: the same with the cell field of marks").required();
  line.listed_flag("--all", options.all, "every cell");
  line.listed_flag("--coarsen-rest", options.coarsen_rest, "cells that meet no criterion may be coarsened");
  line.option("--marks", options.marks, "name of the cell field to write").show_default();
  line.option("--format", options.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.flag("--force", options.force, cli::force_help);
  for (const auto& help : criteria_help) {
    if (help.type == nullptr)
      line.group(help.name, help.text);
    else
      line.listed_option(help.name, help.text).type_name(help.type);
  }
  line.option(
          "--max-cells", options.max_cells,
          "limit: cells in falling order of the criterion while the refined (and coarsened) mesh has at most N cells")
      .type_name("N")
      .positive();
  line.flag("--fill", options.fill,
            "with --max-cells and --coarsen-below: loosen the criteria too, until the mesh has N cells");
  line.option("--quality-control", options.quality_control, "of the refinement whose size is predicted")
      .one_of(refine::quality_control_list())
      .show_default();
  auto floor = line.option("--shape-floor", options.shape_floor, "the same option of that refinement");
  floor.type_name("TAU").range(0.0, 1.0).show_default();
  line.after_reading([&line, &options, floor] {
    cli::CommandLine::refuse_ignored(floor, options.quality_control == "removable", "--quality-control removable");
    for (auto& [name, value] : line.listed()) options.given.push_back({name, value});
  });
}

/// What is marked in the end, and what it gives.
struct Marked {
  std::vector<std::uint8_t> marks, may_go;
  std::vector<std::uint8_t> work;  ///< of the refinement
  std::int64_t cells_after = 0, nodes_after = 0;
  std::int64_t too_fine = 0;  ///< cells of `--max-level` and deeper that closing the marks splits all the same
  double factor = 1;          ///< by which `--max-cells` has made values stricter
};

/// Whether `--max-cells` refines the worst and coarsens the best.
bool moves_thresholds(const mark::Request& request) {
  return std::any_of(request.criteria.begin(), request.criteria.end(),
                     [](const auto& criterion) { return criterion.coarsen_below.has_value(); });
}

/// Forecasts of flags for one mesh. The last trial that fits is kept: most often it is that of what is chosen.
class Forecasts {
 public:
  Forecasts(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Options& refinement)
      : comm_(&comm), forecaster_(comm, mesh, refinement) {}

  /// The number of cells. Collective.
  std::int64_t try_out(std::vector<std::int8_t> flags, std::int64_t max_cells) {
    auto forecast = forecaster_.forecast(flags);
    const auto cells = forecast.cells;
    if (cells <= max_cells) last_ = {std::move(flags), std::move(forecast)};
    return cells;
  }

  /// Collective.
  adapt::Forecast of(const std::vector<std::int8_t>& flags) {
    if (!comm_->all(last_ && last_->first == flags)) return forecaster_.forecast(flags);
    return std::exchange(last_, std::nullopt).value().second;
  }

  const adapt::Forecaster& forecaster() const { return forecaster_; }

 private:
  const par::Comm* comm_;
  adapt::Forecaster forecaster_;
  std::optional<std::pair<std::vector<std::int8_t>, adapt::Forecast>> last_;
};

/// The wanted cells and those that may be coarsened, within `max_cells`. Collective.
Marked choose_both_ways(const par::Comm& comm, const mesh::DistMesh& mesh, const mark::Request& request,
                        const mark::Applied& applied, mark::KnownErrors known, const Options& options,
                        Forecasts& forecasts) {
  const auto size = [&](std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go) {
    std::vector<std::uint8_t> goes(may_go.begin(), may_go.end());
    if (request.keep_for > 0) mark::keep_in_trial(comm, mesh, options.marks, request.keep_for, goes);
    return forecasts.try_out(adapt::signed_flags(marks, goes), *options.max_cells);
  };
  auto choice = mark::choose_within_budget(
      comm, mesh, request, applied,
      {.max_cells = *options.max_cells, .fill = options.fill, .predicted_cells = size, .known = std::move(known)});
  return {std::move(choice.marks), std::move(choice.may_go), {}, 0, 0, 0, choice.factor};
}

/// The wanted cells, or as many of them as `max_cells` allows for. Collective.
Marked choose_marks(const par::Comm& comm, mesh::DistMesh& mesh, const mark::Request& request,
                    const mark::Applied& applied, mark::KnownErrors known, const Options& options,
                    const refine::Options& refinement) {
  Marked marked{mark::marks_of(applied.indicator), applied.may_go, {}, 0, 0, 0, 1};
  Forecasts forecasts(comm, mesh, refinement);
  const bool both_ways = options.max_cells && moves_thresholds(request);
  if (both_ways) marked = choose_both_ways(comm, mesh, request, applied, std::move(known), options, forecasts);
  if (request.keep_for > 0) mark::keep_for_a_while(comm, mesh, options.marks, request.keep_for, marked.may_go);
  if (options.max_cells && !both_ways)
    marked.marks = mark::marks_within_budget(
        comm, mesh, applied.indicator, *options.max_cells, [&](std::span<const std::uint8_t> some) {
          return forecasts.try_out(adapt::signed_flags(some, marked.may_go), *options.max_cells);
        });
  auto forecast = forecasts.of(adapt::signed_flags(marked.marks));
  marked.work = forecasts.forecaster().work(forecast);
  if (request.max_level)
    marked.too_fine = comm.sum(
        adapt::count_splits_from_level(forecast.mesh ? *forecast.mesh : mesh, forecast.closure, *request.max_level));
  const auto flags = adapt::signed_flags(marked.marks, marked.may_go);
  if (comm.any(adapt::has_sign(flags, -1))) forecast = forecasts.of(flags);
  marked.cells_after = forecast.cells;
  marked.nodes_after = forecasts.forecaster().nodes(forecast);
  return marked;
}

/// A place outside of the mesh marks nothing, which may be a misprint; not where it is to let all cells be coarsened.
void warn_of_empty_places(const cli::Session& session, const mark::Request& request, const mark::Applied& applied) {
  if (request.coarsens()) return;
  for (std::size_t i = 0; i < request.criteria.size(); ++i) {
    const auto& [text, rule, coarsen_below] = request.criteria[i];
    const bool is_place = std::holds_alternative<mark::CrossingSphere>(rule) ||
                          std::holds_alternative<mark::CentroidShell>(rule) || std::holds_alternative<mark::Box>(rule);
    if (is_place && applied.cells_of_criterion[i] == 0) session.warn("no cell meets the criterion " + text);
  }
}

/// Where the mesh gets more cells than are allowed, or fewer than are to fill it, and where nothing is marked. `waits`:
/// cells may be coarsened, and `--keep-for` keeps them.
void warn_of_limits(const cli::Session& session, const Options& options, const nlohmann::json& report, bool waits) {
  const auto count = [&](const char* name) { return report[name].get<std::int64_t>(); };
  const auto most = options.max_cells.value_or(std::numeric_limits<std::int64_t>::max()), after = count("cells_after");
  const bool nothing_changes = count("marked") == 0 && count("may_go") == 0;
  if (after > most)
    session.warn(nothing_changes ? fmt::format("nothing is marked: the mesh has {} cells already, more than "
                                               "--max-cells {}",
                                               count("cells"), most)
                                 : fmt::format("{} cells after refinement are more than --max-cells {}: coarsening "
                                               "once takes no more; mark again after it",
                                               after, most));
  else if (nothing_changes && (count("wanted") > 0 || !waits))
    session.warn(count("wanted") > 0 ? "nothing is marked: not one of the cells that are wanted fits into --max-cells"
                                     : "nothing is marked: no cell meets a criterion and every limit");
  if (options.fill && static_cast<double>(after) < mark::smallest_part_of_budget * static_cast<double>(most))
    session.warn(
        fmt::format("--fill: {} cells after refinement are fewer than --max-cells {}: looser values mark no "
                    "more that fit",
                    after, most));
}

/// Refuses to replace fields that hold something else. Collective.
void require_own_fields(const par::Comm& comm, const mesh::DistMesh& mesh, const Options& options) {
  for (const std::string_view taken : {mesh::region_field, mesh::inner_patch_field, mesh::parent_field,
                                       mesh::level_field, mesh::level0_cell_field, mesh::level0_key_field})
    if (options.marks == taken)
      throw Error(fmt::format("--marks: expected a name that means nothing else in a mesh, found '{}'", taken));
  mesh::require_replaceable(comm, mesh, {options.marks, "--marks", -1, 1});
  mesh::require_replaceable(
      comm, mesh, {balance::work_field(options.marks), "the work of the --marks", 0, 255, balance::work_type});
}

cli::ExitCode run(cli::Session& session, const Options& options) {
  const auto request = mark::read_request(options.given);
  session.check_input(options.input);
  session.check_native_output(options.output, options.force);

  const auto& comm = session.comm();
  session.step("reading " + options.input);
  auto mesh = assemble::assemble(comm, io::read_native(comm, options.input, {.remark = session.remarks()}));
  validate::require_valid(comm, mesh, options.input);
  with_file_name(options.input, [&] { require_own_fields(comm, mesh, options); });
  session.step(fmt::format("marking {} cells", mesh.info.n_global_cells));
  refine::Options refinement;
  refinement.quality_control = refine::quality_control_named(options.quality_control);
  refinement.shape_floor = options.shape_floor;
  mark::KnownErrors known;
  auto applied = with_file_name(options.input, [&] { return mark::apply(comm, mesh, request, known); });
  const auto too_deep = comm.sum(mark::keep_below_level(mesh, mesh::max_level, applied.indicator));
  const auto n_wanted = mark::count_marked(comm, mark::marks_of(applied.indicator));
  if (options.fill && !(options.max_cells && moves_thresholds(request)))
    throw Error("--fill: expected --max-cells and a criterion with --coarsen-below, found none");
  const bool waits = request.keep_for > 0 && mark::count_marked(comm, applied.may_go) > 0;
  const auto [marks, may_go, work, cells_after, nodes_after, too_fine, factor] = with_file_name(
      options.input, [&] { return choose_marks(comm, mesh, request, applied, std::move(known), options, refinement); });
  const auto n_marked = mark::count_marked(comm, marks);

  session.step("writing " + options.output);
  std::int64_t n_may_go = 0;
  for (std::size_t c = 0; c < marks.size(); ++c) n_may_go += marks[c] == 0 && may_go[c] != 0 ? 1 : 0;
  n_may_go = comm.sum(n_may_go);
  mark::set_marks(mesh, marks, options.marks, may_go);
  balance::set_work(mesh, options.marks, work);
  io::write_native(comm, options.output, mesh, {.format = options.format, .remark = session.remarks()});
  nlohmann::json report{{"cells", mesh.info.n_global_cells},
                        {"nodes", mesh.info.n_global_nodes},
                        {"wanted", n_wanted},
                        {"marked", n_marked},
                        {"marked_too_deep", too_deep},
                        {"split_beyond_max_level", too_fine},
                        {"may_go", n_may_go},
                        {"values_times", factor},
                        {"cells_after", cells_after},
                        {"nodes_after", nodes_after},
                        {"marks", options.marks},
                        {"quality_control", options.quality_control},
                        {"shape_floor", options.shape_floor}};
  report["criteria"] = nlohmann::json::array();
  for (std::size_t i = 0; i < request.criteria.size(); ++i)
    report["criteria"].push_back({{"criterion", request.criteria[i].text}, {"cells", applied.cells_of_criterion[i]}});
  session.write_report(report);
  if (too_deep > 0) session.warn(adapt::too_deep_text(too_deep));
  if (too_fine > 0)
    session.warn(
        fmt::format("closing the marks splits {} cells of level {} or deeper: families of closure cells that "
                    "cannot be undone stand beside them",
                    too_fine, *request.max_level));
  warn_of_limits(session, options, report, waits);
  if (n_wanted > 0) warn_of_empty_places(session, request, applied);
  session.summary(fmt::format("{} of {} cells marked{}{}; {} cells and {} nodes after refinement -> {}", n_marked,
                              mesh.info.n_global_cells,
                              n_wanted > n_marked ? fmt::format(" (of {} wanted)", n_wanted) : std::string(),
                              request.coarsens() ? fmt::format(", {} may be coarsened", n_may_go) : std::string(),
                              cells_after, nodes_after, options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return pamr::cli::run_tool(
      argc, argv,
      {"pamr-mark",
       "Marks cells to be refined: those that meet any criterion and every limit; and cells that may be coarsened.",
       "pamr-mesh --shape kuhn-cube --n 4 -o a.hdf && pamr-mark a.hdf -o b.hdf --crossing-sphere 0,0,0,0.6 --patch "
       "xmin"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
