// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/balance/partition.hpp"
#include "pamr/balance/weighted_blocks.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

constexpr const char* rank_field = "rank";

struct Options {
  std::string input, output, weights = "refine", marks = "refine", method = "scotch", quality_control = "removable";
  Rank n_parts = 0;
  int format = io::newest_format;
  bool force = false, asks_marks = false;  ///< also by what only marks need
  double shape_floor = refine::default_shape_floor;
};

void declare(cli::CommandLine& line, Options& options) {
  line.option("MESH", options.input, "mesh to read").required();
  line.option("-o,--output", options.output, "mesh to write: the same with the integer cell field 'rank'").required();
  line.option("-p,--parts", options.n_parts, "number of parts; need not be that of the processes")
      .required()
      .range(1, 1 << 20);
  line.option("--weights", options.weights,
              "what a cell weighs: the exact number of cells that it becomes when the marked cells are refined (1 "
              "each where the mesh has no marks), 8 where it is marked and else 1, 1 each, or the values of a cell "
              "field")
      .type_name("refine|8/1|uniform|FIELD")
      .show_default();
  line.option("--method", options.method,
              "few faces between parts (scotch), pieces of a space-filling curve (curve) or runs of cells in file "
              "order (blocks)")
      .one_of({"scotch", "curve", "blocks"})
      .show_default();
  auto marks =
      line.option("--marks", options.marks,
                  "of --weights refine and 8/1: integer cell field of marks, -1 may be coarsened, 0 keep, 1 split");
  marks.show_default();
  auto quality_control = line.option("--quality-control", options.quality_control,
                                     "of --weights refine: the refinement that is predicted");
  quality_control.one_of(refine::quality_control_list()).show_default();
  auto floor = line.option("--shape-floor", options.shape_floor, "the same option of that refinement");
  floor.type_name("TAU").range(0.0, 1.0).show_default();
  line.option("--format", options.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.flag("--force", options.force, cli::force_help);
  line.after_reading([=, &options] {
    const bool predicts = options.weights == "refine";
    cli::CommandLine::refuse_ignored(marks, predicts || options.weights == "8/1", "--weights refine or 8/1");
    cli::CommandLine::refuse_ignored(quality_control, predicts, "--weights refine");
    cli::CommandLine::refuse_ignored(floor, predicts, "--weights refine");
    cli::CommandLine::refuse_ignored(floor, options.quality_control == "removable", "--quality-control removable");
    options.asks_marks = marks.is_given() || quality_control.is_given() || floor.is_given();
  });
}

/// A mesh without marks that are not asked for has cells of one weight.
std::string weights_of(const mesh::DistMesh& mesh, const Options& options) {
  const bool has_none =
      options.weights == "refine" && !options.asks_marks && mesh.find_cell_field(options.marks) == nullptr;
  return has_none ? "uniform" : options.weights;
}

/// `weights`: as `weights_of` gives them. Collective.
std::vector<std::int64_t> weigh(const par::Comm& comm, const mesh::DistMesh& mesh, const Options& options,
                                const std::string& weights) {
  if (weights == "refine") {
    refine::Options refinement;
    refinement.quality_control = refine::quality_control_named(options.quality_control);
    refinement.shape_floor = options.shape_floor;
    const auto flags = adapt::splits_of(adapt::signed_flags_from_field(comm, mesh, options.marks));
    const auto children = adapt::Forecaster(comm, mesh, refinement).forecast(flags).children;
    return {children.begin(), children.end()};
  }
  if (weights == "8/1") {
    const auto flags = adapt::splits_of(adapt::signed_flags_from_field(comm, mesh, options.marks));
    std::vector<std::int64_t> weight(flags.size());
    std::transform(flags.begin(), flags.end(), weight.begin(), [](std::uint8_t flag) { return flag != 0 ? 8 : 1; });
    return weight;
  }
  if (weights == "uniform") return std::vector<std::int64_t>(at(mesh.n_cells()), 1);
  return balance::weights_from_field(comm, mesh, weights);
}

/// Writes (replaces) the cell field `rank`.
void set_ranks(mesh::DistMesh& mesh, const std::vector<Rank>& part) {
  std::erase_if(mesh.cell_fields, [](const mesh::CellField& field) { return field.name == rank_field; });
  mesh.cell_fields.push_back(
      {rank_field, "", 1, mesh::StorageType::int64, std::vector<std::int64_t>(part.begin(), part.end())});
}

cli::ExitCode run(cli::Session& session, const Options& options) {
  session.check_input(options.input);
  session.check_native_output(options.output, options.force);

  const auto& comm = session.comm();
  session.step("reading " + options.input);
  auto mesh = assemble::assemble(
      comm, io::read_native(comm, options.input,
                            {.build_surfaces = options.weights == "refine", .remark = session.remarks()}));
  validate::require_valid(comm, mesh, options.input);
  with_file_name(options.input, [&] {
    mesh::require_replaceable(comm, mesh,
                              {rank_field, "the numbers of the parts", 0, std::numeric_limits<Rank>::max()});
  });
  const auto weights = weights_of(mesh, options);
  const auto weight = with_file_name(options.input, [&] { return weigh(comm, mesh, options, weights); });
  const auto method = balance::method_named(options.method);
  if (const auto line = balance::what_stands_in(method); !line.empty()) session.note(line);
  session.step(fmt::format("dividing {} cells into {} parts", mesh.info.n_global_cells, options.n_parts));
  const std::vector<std::int64_t> ones(weight.size(), 1);
  const auto runs = balance::weighted_blocks(comm, mesh, ones, options.n_parts);
  const auto before = balance::measure(comm, mesh, weight, runs, options.n_parts);
  // a partition that is kept in a file may take its time: every cell and every family is a vertex
  const auto partition = balance::partition(comm, mesh, weight, options.n_parts,
                                            {.method = method, .keep_below = 0, .vertices_per_part = 0});
  const auto& after = partition.quality;

  session.step("writing " + options.output);
  set_ranks(mesh, partition.part);
  io::write_native(comm, options.output, mesh, {.format = options.format, .remark = session.remarks()});
  session.write_report({{"cells", mesh.info.n_global_cells},
                        {"parts", options.n_parts},
                        {"method", balance::name_of(options.n_parts == 1 ? balance::Method::none : partition.method)},
                        {"weights", weights},
                        {"edge_cut", after.edge_cut},
                        {"edge_cut_before", before.edge_cut},
                        {"imbalance_before", before.imbalance},
                        {"imbalance_after", after.imbalance},
                        {"neighbors_max", after.max_neighbors},
                        {"neighbors_mean", after.mean_neighbors},
                        {"neighbors_max_before", before.max_neighbors},
                        {"neighbors_mean_before", before.mean_neighbors},
                        {"empty_parts", after.empty_parts}});
  session.summary(fmt::format(
      "{} cells in {} parts: {} faces between parts, imbalance {:.4f} (runs of equal length: "
      "{}, {:.4f}), at most {} neighbors a part{} -> {}",
      mesh.info.n_global_cells, options.n_parts, after.edge_cut, after.imbalance, before.edge_cut, before.imbalance,
      after.max_neighbors, after.empty_parts > 0 ? fmt::format(", {} empty", after.empty_parts) : std::string(),
      options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-partition", "Divides a mesh into parts of equal weight with few faces between them.",
       "pamr-mesh --shape kuhn-cube --n 8 -o a.hdf && pamr-partition a.hdf -o b.hdf -p 4"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
