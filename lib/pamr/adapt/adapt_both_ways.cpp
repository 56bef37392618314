// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt_both_ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/refine_closed.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/coarsen/coarsen.hpp"
#include "pamr/coarsen/gather_siblings.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/integrals.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

using Flags = std::vector<std::int8_t>;

bool has_flag(std::span<const std::int8_t> flags, int sign) {
  return std::any_of(flags.begin(), flags.end(), [sign](std::int8_t flag) { return sign * flag > 0; });
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
  refine::require_integrals(comm, mesh, options.integrals);
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

CoarseningReport count_all(const par::Comm& comm, const coarsen::Asked& asked, const coarsen::Outcome& outcome,
                           CoarseningReport report) {
  std::array<std::int64_t, 3> sums{asked.n_flagged, asked.n_without_parent, asked.n_in_octets};
  comm.sum_in_place(sums);
  report.cells_flagged = sums[0];
  report.cells_without_parent = sums[1];
  report.cells_without_siblings = sums[0] - sums[1] - sums[2];
  static_cast<coarsen::Outcome&>(report) = outcome;
  return report;
}

coarsen::FieldRules rules_of(const AdaptOptions& options) {
  coarsen::FieldRules rules{{}, options.refinement.integrals};
  if (!options.refinement.marks_field.empty()) rules.left_out.push_back(options.refinement.marks_field);
  if (options.refinement.parent_field) rules.left_out.emplace_back(mesh::parent_field);
  return rules;
}

/// What was taken back.
struct TakenBack {
  std::optional<mesh::DistMesh> mesh;  ///< nothing if that is nothing
  std::vector<std::uint8_t> flags;     ///< of its cells: 1 to split
  std::vector<coarsen::Merged> merged;
  CoarseningReport report;
  std::optional<KnownClosure> closure;  ///< of that mesh with these flags, if anything is to be split
};

/// Takes back what neither the closure of the remaining splits nor refining needs. What refining needs shows when the
/// coarse mesh is closed: nodes of the old mesh that are marked there stay, and it is settled again with them, until
/// there is none. Each of them is needed by what remains for certain, so the result is the same as if all had been
/// settled at once.
TakenBack take_back(const par::Comm& comm, const mesh::DistMesh& mesh, const Flags& flags, const AdaptOptions& options,
                    CoarseningReport report, StepTimer& timer) {
  const auto borders = mesh::find_borders(comm, mesh);
  auto [octets, asked] = coarsen::find_octets(mesh, flags);
  timer.lap("preprocessing");
  const bool any_split = comm.any(has_flag(flags, 1));
  std::vector<LocalId> needed;
  for (;;) {
    const auto settled =
        coarsen::settle_octets(comm, mesh, borders, octets, flags, needed, options.refinement.shape_floor);
    TakenBack taken{{}, {}, {}, count_all(comm, asked, settled.outcome, report), {}};
    taken.report.cells_between = mesh.info.n_global_cells;
    timer.lap("coarsen");
    if (!comm.any(!settled.groups.empty())) return taken;
    auto coarse = coarsen::take_back(comm, mesh, settled, flags);
    timer.lap("coarsen");
    if (any_split) {
      const auto requests = refine::requests_of_flags(limit_depth(coarse.mesh, coarse.flags).flags);
      auto coarse_borders = mesh::find_borders(comm, coarse.mesh);
      auto closure = refine::close(comm, coarse.mesh, coarse_borders, requests, options.refinement);
      const auto more = coarsen::find_needed_nodes(settled, coarse, closure.marks);
      timer.lap("close");
      if (comm.any(!more.empty())) {
        needed.insert(needed.end(), more.begin(), more.end());
        continue;
      }
      taken.closure = KnownClosure{std::move(coarse_borders), std::move(closure)};
    }
    coarsen::carry_fields(comm, mesh, settled.groups, coarse.places, coarse.old_node, rules_of(options), coarse.mesh);
    taken.merged = coarsen::find_merged(mesh, settled.groups, coarse.places, coarse.mesh);
    taken.report.cells_between = coarse.mesh.info.n_global_cells;
    taken.mesh = std::move(coarse.mesh);
    taken.flags = std::move(coarse.flags);
    timer.lap("coarsen");
    return taken;
  }
}

/// The options with all that is said of integrals in one place.
AdaptOptions with_integrals(AdaptOptions options) {
  auto& all = options.refinement.integrals;
  all.insert(all.end(), options.integrals.begin(), options.integrals.end());
  return options;
}

/// The mesh is complete as it is: nothing is to be split or put onto a surface.
RefineResult as_it_is(mesh::DistMesh mesh, const refine::Options& options) {
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
                  const AdaptOptions& given) {
  const auto options = with_integrals(given);
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto signs = checked(comm, mesh, flags, options.refinement);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](const mesh::DistMesh& from, std::span<const std::uint8_t> split) {
    return refine(comm, from, split, options.refinement);
  };
  if (!comm.any(has_flag(signs, -1)))
    return as_one(refined(mesh, splits_of(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  CoarseningReport report;
  const auto gathered = gather(comm, mesh, signs, report);
  timer.lap("balance");
  auto taken = take_back(comm, gathered ? *gathered : mesh, signs, options, report, timer);
  if (!taken.mesh)
    return as_one(refined(gathered ? *gathered : mesh, splits_of(signs)), taken.report, {}, sizes, timer,
                  comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, *taken.mesh).empty());
  const bool has_more = comm.any(has_flag(signs, 1) || is_off_surface(*taken.mesh));
  auto result = has_more ? refined(*taken.mesh, taken.flags) : as_it_is(*std::move(taken.mesh), options.refinement);
  return as_one(std::move(result), taken.report, std::move(taken.merged), sizes, timer, comm.traffic() - before);
}

AdaptResult adapt(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& given) {
  const auto options = with_integrals(given);
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto signs = checked(comm, mesh, flags, options.refinement);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](mesh::DistMesh&& from, std::span<const std::uint8_t> split) {
    return refine(comm, std::move(from), split, Options{options.refinement, options.balancing});
  };
  if (!comm.any(has_flag(signs, -1)))
    return as_one(refined(std::move(mesh), splits_of(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  CoarseningReport report;
  if (auto gathered = gather(comm, mesh, signs, report)) mesh = *std::move(gathered);
  timer.lap("balance");
  auto taken = take_back(comm, mesh, signs, options, report, timer);
  if (!taken.mesh)
    return as_one(refined(std::move(mesh), splits_of(signs)), taken.report, {}, sizes, timer, comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, *taken.mesh).empty());
  mesh = {};
  const bool has_more = comm.size() > 1 || has_flag(signs, 1) || is_off_surface(*taken.mesh);
  auto result = has_more ? refine_closed(comm, *std::move(taken.mesh), taken.flags, std::move(taken.closure),
                                         {options.refinement, options.balancing})
                         : as_it_is(*std::move(taken.mesh), options.refinement);
  return as_one(std::move(result), taken.report, std::move(taken.merged), sizes, timer, comm.traffic() - before);
}

std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go) {
  std::vector<std::int8_t> flags;
  flags.reserve(marks.size());
  for (std::size_t c = 0; c < marks.size(); ++c)
    flags.push_back(static_cast<std::int8_t>(marks[c] != 0 ? 1 : may_go[c] != 0 ? -1 : 0));
  return flags;
}

MeshSize size_after(const par::Comm& comm, mesh::DistMesh& mesh, std::span<const std::uint8_t> marks,
                    std::span<const std::uint8_t> may_go, const refine::Options& refinement) {
  AdaptOptions options;
  options.refinement = refinement;
  options.refinement.project = false;  // where nodes go has no part in it
  options.refinement.parent_field = false;
  auto of_nodes = std::exchange(mesh.node_fields, {});
  auto of_cells = std::exchange(mesh.cell_fields, {});
  const auto report = adapt(comm, std::as_const(mesh), signed_flags(marks, may_go), options).report;
  mesh.node_fields = std::move(of_nodes);
  mesh.cell_fields = std::move(of_cells);
  return {report.cells_out, report.nodes_out};
}

}  // namespace pamr::adapt
