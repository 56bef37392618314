// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt_both_ways.hpp"

#include <array>
#include <optional>
#include <utility>

#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/refine_closed.hpp"
#include "pamr/adapt/take_back.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/refine/integrals.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

/// What was taken back, with fields.
struct Carried {
  std::optional<mesh::DistMesh> mesh;  ///< nothing if that is nothing
  std::vector<std::uint8_t> flags;     ///< of its cells: 1 to split
  std::vector<coarsen::Merged> merged;
  CoarseningReport report;
  std::optional<KnownClosure> closure;  ///< of that mesh with these flags, if anything is to be split
};

Carried carried(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> signs,
                const refine::Options& options, StepTimer& timer) {
  auto taken = take_back(comm, mesh, mesh::find_borders(comm, mesh), signs, options, timer);
  if (!taken.coarse) return {{}, {}, {}, taken.report, {}};
  carry_fields(comm, mesh, options, taken);
  auto& coarse = *taken.coarse;
  Carried result{{}, {}, {}, taken.report, std::move(taken.closure)};
  result.merged = coarsen::find_merged(mesh, taken.settled.groups, coarse.places, coarse.mesh);
  result.mesh = std::move(coarse.mesh);
  result.flags = std::move(coarse.flags);
  timer.lap("coarsen");
  return result;
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
  auto signs = checked_signs(comm, mesh, flags, options.refinement);
  refine::require_integrals(comm, mesh, options.refinement.integrals);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](const mesh::DistMesh& from, std::span<const std::uint8_t> split) {
    return refine(comm, from, split, options.refinement);
  };
  if (!comm.any(has_sign(signs, -1)))
    return as_one(refined(mesh, splits_of(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  const auto gathering = find_gathering(comm, mesh, signs);
  std::optional<mesh::DistMesh> gathered;
  if (gathering.cells_moved > 0) gathered = gather(comm, mesh, gathering, signs);
  timer.lap("balance");
  auto taken = carried(comm, gathered ? *gathered : mesh, signs, options.refinement, timer);
  taken.report.cells_moved = gathering.cells_moved;
  if (!taken.mesh)
    return as_one(refined(gathered ? *gathered : mesh, splits_of(signs)), taken.report, {}, sizes, timer,
                  comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, *taken.mesh).empty());
  const bool has_more = comm.any(has_sign(signs, 1) || is_off_surface(*taken.mesh));
  auto result = has_more ? refined(*taken.mesh, taken.flags) : as_it_is(*std::move(taken.mesh), options.refinement);
  return as_one(std::move(result), taken.report, std::move(taken.merged), sizes, timer, comm.traffic() - before);
}

AdaptResult adapt(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& given) {
  const auto options = with_integrals(given);
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto signs = checked_signs(comm, mesh, flags, options.refinement);
  refine::require_integrals(comm, mesh, options.refinement.integrals);
  const std::array<GlobalId, 2> sizes{mesh.info.n_global_cells, mesh.info.n_global_nodes};
  const auto refined = [&](mesh::DistMesh&& from, std::span<const std::uint8_t> split) {
    return refine(comm, std::move(from), split, Options{options.refinement, options.balancing});
  };
  if (!comm.any(has_sign(signs, -1)))
    return as_one(refined(std::move(mesh), splits_of(signs)), {}, {}, sizes, timer, comm.traffic() - before);
  const auto gathering = find_gathering(comm, mesh, signs);
  if (gathering.cells_moved > 0) mesh = gather(comm, std::move(mesh), gathering, signs);
  timer.lap("balance");
  auto taken = carried(comm, mesh, signs, options.refinement, timer);
  taken.report.cells_moved = gathering.cells_moved;
  if (!taken.mesh)
    return as_one(refined(std::move(mesh), splits_of(signs)), taken.report, {}, sizes, timer, comm.traffic() - before);
  PAMR_ENSURES_AUDIT(validate::validate(comm, *taken.mesh).empty());
  mesh = {};
  const bool has_more = comm.size() > 1 || has_sign(signs, 1) || is_off_surface(*taken.mesh);
  auto result = has_more ? refine_closed(comm, *std::move(taken.mesh), taken.flags, std::move(taken.closure),
                                         {options.refinement, options.balancing})
                         : as_it_is(*std::move(taken.mesh), options.refinement);
  return as_one(std::move(result), taken.report, std::move(taken.merged), sizes, timer, comm.traffic() - before);
}

}  // namespace pamr::adapt
