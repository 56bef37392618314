// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt_both_ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/coarsen/coarsen.hpp"
#include "pamr/coarsen/gather_siblings.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

using Flags = std::vector<std::int8_t>;

bool has_flag(std::span<const std::int8_t> flags, int sign) {
  return std::any_of(flags.begin(), flags.end(), [sign](std::int8_t flag) { return sign * flag > 0; });
}

std::vector<std::uint8_t> to_split(std::span<const std::int8_t> flags) {
  std::vector<std::uint8_t> split;
  split.reserve(flags.size());
  for (const auto flag : flags) split.push_back(flag > 0 ? 1 : 0);
  return split;
}

/// Flags of -1, 0 and 1.
Flags checked(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> flags,
              const refine::Options& options) {
  refine::require_sound(options);
  par::agree(comm, [&] {
    if (flags.size() != at(mesh.n_cells()))
      throw Error(fmt::format("adapt: expected one flag for each of the {} cells of rank {}, found {}", mesh.n_cells(),
                              comm.rank(), flags.size()));
    if (has_flag(flags, -1) && options.quality_control != refine::QualityControl::removable)
      throw Error("adapt: expected the quality control 'removable' for coarsening (flags below 0), found another one");
  });
  Flags signs(flags.begin(), flags.end());
  for (auto& flag : signs) flag = static_cast<std::int8_t>(flag > 0 ? 1 : flag < 0 ? coarsen::may_go : 0);
  return signs;
}

/// The mesh with all siblings on one rank, and its flags; nothing if they are already. Collective.
std::optional<mesh::DistMesh> gather(const par::Comm& comm, const mesh::DistMesh& mesh, Flags& flags,
                                     CoarseningReport& report) {
  const auto destination = coarsen::gather_siblings(comm, mesh, flags);
  if (!comm.any(!destination.empty())) return {};
  const auto n_stay = std::count(destination.begin(), destination.end(), comm.rank());
  report.cells_moved = comm.sum(std::ssize(destination) - n_stay);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(flags.size());
  for (const auto flag : flags) bytes.push_back(static_cast<std::uint8_t>(flag));
  auto gathered = balance::migrate(comm, mesh, destination, &bytes);
  flags.clear();
  for (const auto byte : bytes) flags.push_back(static_cast<std::int8_t>(byte));
  return gathered;
}

CoarseningReport make_report(const par::Comm& comm, const coarsen::Asked& asked, const coarsen::Outcome& outcome,
                             CoarseningReport report) {
  std::array<std::int64_t, 3> sums{asked.n_flagged, asked.n_without_parent, asked.n_in_octets};
  comm.sum_in_place(sums);
  report.cells_flagged = sums[0];
  report.cells_without_parent = sums[1];
  report.cells_without_siblings = sums[0] - sums[1] - sums[2];
  report.octets_gone = outcome.octets_gone;
  report.octets_needed = outcome.octets_needed;
  report.octets_kept = outcome.octets_kept;
  report.families_closed = outcome.families_closed;
  report.families_kept = outcome.families_kept;
  report.rounds = outcome.rounds;
  return report;
}

coarsen::FieldRules rules_of(const AdaptOptions& options) {
  coarsen::FieldRules rules{{}, options.integrals};
  if (!options.refinement.marks_field.empty()) rules.left_out.push_back(options.refinement.marks_field);
  if (options.refinement.parent_field) rules.left_out.emplace_back(mesh::parent_field);
  return rules;
}

/// What was taken back; no mesh if that is nothing.
struct TakenBack {
  std::optional<coarsen::Coarsened> coarse;
  CoarseningReport report;
};

TakenBack take_back(const par::Comm& comm, const mesh::DistMesh& mesh, const Flags& flags, const AdaptOptions& options,
                    CoarseningReport report, StepTimer& timer) {
  const auto borders = mesh::find_borders(comm, mesh);
  auto [octets, asked] = coarsen::find_octets(mesh, flags);
  timer.lap("preprocessing");
  std::vector<refine::EdgeMask> marks;
  if (comm.any(!octets.empty()) && comm.any(has_flag(flags, 1))) {
    const auto limited = limit_depth(mesh, to_split(flags));
    marks = refine::close(comm, mesh, borders, refine::requests_of_flags(limited.flags), options.refinement).marks;
  }
  timer.lap("close");
  const auto settled =
      coarsen::settle_octets(comm, mesh, borders, std::move(octets), marks, options.refinement.shape_floor);
  TakenBack taken{{}, make_report(comm, asked, settled.outcome, report)};
  taken.report.cells_between = mesh.info.n_global_cells;
  if (comm.any(!settled.groups.empty())) {
    taken.coarse = coarsen::take_back(comm, mesh, settled, flags, rules_of(options));
    taken.report.cells_between = taken.coarse->mesh.info.n_global_cells;
  }
  timer.lap("coarsen");
  return taken;
}

/// The mesh is complete as it is: nothing is to be split or put onto a surface.
RefineResult complete(mesh::DistMesh mesh, const refine::Options& options) {
  RefineResult result{std::move(mesh), {}};
  auto& origin = result.mesh.cell_origin;
  if (options.parent_field)
    result.mesh.cell_fields.push_back(
        {mesh::parent_field, "", 1, mesh::StorageType::int64, std::vector<std::int64_t>(origin.begin(), origin.end())});
  origin = {};
  result.report.cells_out = result.mesh.info.n_global_cells;
  result.report.nodes_out = result.mesh.info.n_global_nodes;
  return result;
}

bool is_off_surface(const mesh::DistMesh& mesh) { return mesh.find_node_field(mesh::off_surface_field) != nullptr; }

AdaptResult as_one(RefineResult refined, CoarseningReport coarsening, std::vector<coarsen::Merged> merged,
                   const std::array<GlobalId, 2>& sizes_in, const StepTimer& timer, const Traffic& traffic) {
  AdaptResult result{std::move(refined.mesh), std::move(refined.report), coarsening, std::move(merged)};
  result.report.cells_in = sizes_in[0];
  result.report.nodes_in = sizes_in[1];
  result.report.steps = merge_steps(timer.steps(), result.report.steps);
  result.report.traffic = traffic;
  return result;
}

}  // namespace

AdaptResult adapt(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto signs = checked(comm, mesh, flags, options.refinement);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](const mesh::DistMesh& from, std::span<const std::uint8_t> split) {
    return refine(comm, from, split, options.refinement);
  };
  if (!comm.any(has_flag(signs, -1)))
    return as_one(refined(mesh, to_split(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  CoarseningReport report;
  const auto gathered = gather(comm, mesh, signs, report);
  timer.lap("balance");
  auto [coarse, coarsening] = take_back(comm, gathered ? *gathered : mesh, signs, options, report, timer);
  if (!coarse)
    return as_one(refined(gathered ? *gathered : mesh, to_split(signs)), coarsening, {}, sizes, timer,
                  comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, coarse->mesh).empty());
  const bool has_more = comm.any(has_flag(signs, 1) || is_off_surface(coarse->mesh));
  auto result = has_more ? refined(coarse->mesh, coarse->flags) : complete(std::move(coarse->mesh), options.refinement);
  return as_one(std::move(result), coarsening, std::move(coarse->merged), sizes, timer, comm.traffic() - before);
}

AdaptResult adapt(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto signs = checked(comm, mesh, flags, options.refinement);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](mesh::DistMesh&& from, std::span<const std::uint8_t> split) {
    return refine(comm, std::move(from), split, Options{options.refinement, options.balancing});
  };
  if (!comm.any(has_flag(signs, -1)))
    return as_one(refined(std::move(mesh), to_split(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  CoarseningReport report;
  if (auto gathered = gather(comm, mesh, signs, report)) mesh = *std::move(gathered);
  timer.lap("balance");
  auto [coarse, coarsening] = take_back(comm, mesh, signs, options, report, timer);
  if (!coarse)
    return as_one(refined(std::move(mesh), to_split(signs)), coarsening, {}, sizes, timer, comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, coarse->mesh).empty());
  mesh = {};
  const bool has_more = comm.size() > 1 || has_flag(signs, 1) || is_off_surface(coarse->mesh);
  auto result = has_more ? refined(std::move(coarse->mesh), coarse->flags)
                         : complete(std::move(coarse->mesh), options.refinement);
  return as_one(std::move(result), coarsening, std::move(coarse->merged), sizes, timer, comm.traffic() - before);
}

}  // namespace pamr::adapt
