// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/take_back.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/coarsen/gather_siblings.hpp"
#include "pamr/coarsen/octets.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/integrals.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

CoarseningReport count_all(const par::Comm& comm, const coarsen::Asked& asked, const coarsen::Outcome& outcome) {
  std::array<std::int64_t, 3> sums{asked.n_flagged, asked.n_without_parent, asked.n_in_octets};
  comm.sum_in_place(sums);
  CoarseningReport report;
  report.cells_flagged = sums[0];
  report.cells_without_parent = sums[1];
  report.cells_without_siblings = sums[0] - sums[1] - sums[2];
  static_cast<coarsen::Outcome&>(report) = outcome;
  return report;
}

}  // namespace

Gathering find_gathering(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> signs) {
  Gathering where{coarsen::gather_siblings(comm, mesh, signs), 0};
  const auto n_stay = std::count(where.destination.begin(), where.destination.end(), comm.rank());
  where.cells_moved = comm.sum(std::ssize(where.destination) - n_stay);
  return where;
}

mesh::DistMesh gather(const par::Comm& comm, mesh::DistMesh mesh, const Gathering& where,
                      std::vector<std::int8_t>& signs) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(signs.size());
  for (const auto sign : signs) bytes.push_back(static_cast<std::uint8_t>(sign));
  auto gathered = balance::migrate(comm, std::move(mesh), where.destination, &bytes);
  signs.clear();
  for (const auto byte : bytes) signs.push_back(static_cast<std::int8_t>(byte));
  return gathered;
}

CoarseMesh make_coarse_mesh(const par::Comm& comm, const FlaggedMesh& flagged, const refine::Options& options,
                            StepTimer& timer) {
  const auto& [mesh, borders, signs] = flagged;
  auto [octets, asked] = coarsen::find_octets(mesh, signs);
  timer.lap("preprocessing");
  const bool any_split = comm.any(has_sign(signs, 1));
  std::vector<LocalId> needed;
  for (;;) {
    CoarseMesh coarse;
    coarse.settled = coarsen::settle_octets(comm, mesh, borders, octets, {signs, needed, options.shape_floor});
    coarse.report = count_all(comm, asked, coarse.settled.outcome);
    coarse.report.cells_between = mesh.info.n_global_cells;
    timer.lap("coarsen");
    if (!comm.any(!coarse.settled.groups.empty())) return coarse;
    auto& made = coarse.made.emplace(coarsen::take_back(comm, mesh, coarse.settled, signs));
    coarse.report.cells_between = made.mesh.info.n_global_cells;
    timer.lap("coarsen");
    if (!any_split) return coarse;
    const auto requests = refine::requests_of_flags(limit_depth(made.mesh, made.flags).flags);
    auto coarse_borders = mesh::find_borders(comm, made.mesh);
    auto closure = refine::close(comm, made.mesh, coarse_borders, {requests}, options);
    const auto more = coarsen::find_needed_nodes(coarse.settled, made, closure.marks);
    timer.lap("close");
    if (!comm.any(!more.empty())) {
      coarse.closure = KnownClosure{std::move(coarse_borders), std::move(closure)};
      return coarse;
    }
    needed.insert(needed.end(), more.begin(), more.end());
  }
}

void carry_fields(const par::Comm& comm, const mesh::DistMesh& old, const refine::Options& options,
                  CoarseMesh& coarse) {
  coarsen::FieldRules rules{{}, options.integrals};
  if (!options.marks_field.empty()) rules.left_out.push_back(options.marks_field);
  if (options.parent_field) rules.left_out.emplace_back(mesh::parent_field);
  coarsen::carry_fields(comm, old, coarse.settled.groups, rules, *coarse.made);
}

TakenBack take_back(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags,
                    const refine::Options& options, StepTimer& timer) {
  auto signs = checked_signs(comm, mesh.get(), flags, options);
  refine::require_integrals(comm, mesh.get(), options.integrals);
  if (!comm.any(has_sign(signs, -1))) return {std::move(mesh), splits_of(signs), {}, false, {}, {}};
  const auto gathering = find_gathering(comm, mesh.get(), signs);
  if (gathering.cells_moved > 0) mesh = gather(comm, std::move(mesh).take(), gathering, signs);
  timer.lap("balance");
  const auto& old = mesh.get();
  auto coarse = make_coarse_mesh(comm, {old, mesh::find_borders(comm, old), signs}, options, timer);
  coarse.report.cells_moved = gathering.cells_moved;
  if (!coarse.made) return {std::move(mesh), splits_of(signs), {}, false, coarse.report, {}};
  carry_fields(comm, old, options, coarse);
  auto& made = *coarse.made;
  auto merged = coarsen::find_merged(old, coarse.settled.groups, made);
  timer.lap("coarsen");
  PAMR_ENSURES_AUDIT(validate::validate(comm, made.mesh).empty());
  return {std::move(made.mesh), std::move(made.flags), std::move(coarse.closure), true,
          coarse.report,        std::move(merged)};
}

}  // namespace pamr::adapt
