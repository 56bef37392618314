// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/floor_cost.hpp"
#include "pamr/adapt/level0.hpp"
#include "pamr/adapt/part/open_parents.hpp"
#include "pamr/adapt/part/split_early.hpp"
#include "pamr/adapt/pass.hpp"
#include "pamr/adapt/take_back.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/refine/transfer.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

/// Marks and closes the mesh, after look-ahead splits until it needs none.
Closed close(const par::Comm& comm, TakenBack start, const Options& all_options, StepTimer& timer) {
  const auto& options = all_options.refinement;
  const auto limited = limit_depth(start.mesh.get(), start.flags);
  auto closed =
      close_pass(comm, {std::move(start.mesh), refine::requests_of_flags(limited.flags), std::move(start.closure)},
                 options, timer);
  const auto n_marked = closed.report.closure.n_marked;
  const auto with_lower =
      all_options.compares_floors ? cells_with_lower_floor(comm, closed, options) : std::optional<std::int64_t>();
  timer.lap("close");
  closed = split_early(comm, std::move(closed), options, timer);
  auto& report = closed.report;
  report.closure.n_marked = n_marked;
  report.lower_floor = lower_floor(closed.mesh.get());
  if (with_lower) report.floor_cost = floor_cost(comm, closed, *with_lower);
  std::array<std::int64_t, 2> sums{refine::count_not_split(closed.mesh.get(), closed.requests, closed.closure),
                                   limited.n_left_out};
  comm.sum_in_place(sums);
  report.marked_not_split = sums[0];
  report.marked_too_deep = sums[1];
  return closed;
}

/// Frees what nothing after the closure looks at, so that no room is taken by it and it need not move: the marks, and
/// numbers of parents that the children's replace.
mesh::DistMesh without_replaced_fields(mesh::DistMesh mesh, const Options& options) {
  const auto& integrals = options.refinement.integrals;
  std::erase_if(mesh.cell_fields, [&](const mesh::CellField& field) {
    return !refine::is_inherited(field, options.refinement) && field.name != options.balancing.field &&
           std::find(integrals.begin(), integrals.end(), field.name) == integrals.end();
  });
  return mesh;
}

/// Moves the parents to the ranks where their children shall be.
Closed balance(const par::Comm& comm, Closed closed, const Options& options, StepTimer& timer) {
  auto mesh = without_replaced_fields(std::move(closed.mesh).take(), options);
  closed.info.level0.reset();  // its rows travel: those at hand are freed then
  auto [parents, report] = balance_parents(
      comm, {std::move(mesh), std::move(closed.borders), std::move(closed.closure)}, closed.requests, options, timer);
  timer.lap("balance");
  closed.info.level0 = parents.mesh.info.level0;
  closed.mesh = std::move(parents.mesh);
  closed.borders = std::move(parents.borders);
  closed.closure = std::move(parents.closure);
  closed.report.balance = report;
  return closed;
}

/// Fields and report of the mesh that the last split made.
Result finish(const par::Comm& comm, Closed closed, Split made, const refine::Options& options, StepTimer& timer) {
  closed.mesh.drop_links();  // the children have links of their own, and fields need room
  const auto before = std::exchange(closed.before, {});
  std::vector<OpenParent> open;
  if (before) open = find_open_parents({closed.mesh.get(), closed.closure, made.numbering}, made.fine.cell_to_node);
  auto result = transfer_pass(std::move(closed), std::move(made), options);
  if (before) settle_open_parents(comm, *before, open, options, result.mesh);
  timer.lap("transfer");
  return result;
}

bool has_off_surface_field(const mesh::DistMesh& mesh) {
  return mesh.find_node_field(mesh::off_surface_field) != nullptr;
}

/// Whether a coarser mesh is what was asked for: nothing is to be split, put onto a surface or moved.
bool is_complete(const par::Comm& comm, const TakenBack& taken, bool cells_move) {
  if (!taken.is_coarser || (cells_move && comm.size() > 1)) return false;
  const bool any_split = std::find(taken.flags.begin(), taken.flags.end(), 1) != taken.flags.end();
  return !comm.any(any_split || has_off_surface_field(taken.mesh.get()));
}

Result as_it_is(mesh::DistMesh mesh, const refine::Options& options) {
  Result result{std::move(mesh), {}, {}, {}};
  auto& origin = result.mesh.cell_origin;
  if (options.parent_field)
    result.mesh.cell_fields.push_back(
        {mesh::parent_field, "", 1, mesh::StorageType::int64, std::vector<std::int64_t>(origin.begin(), origin.end())});
  free_array(origin);
  result.report.cells_out = result.mesh.info.n_global_cells;
  result.report.nodes_out = result.mesh.info.n_global_nodes;
  return result;
}

/// Coarsen, close, balance, split, finish.
Result adapt_once(const par::Comm& comm, ReadyMesh ready, bool cells_move, std::span<const std::int8_t> flags,
                  const Options& options, StepTimer& timer) {
  const std::array<GlobalId, 2> sizes{ready.mesh.get().info.n_global_cells, ready.mesh.get().info.n_global_nodes};
  auto taken = take_back(comm, std::move(ready.mesh), flags, options.refinement, timer);
  const auto coarsening = taken.report;
  auto merged = std::exchange(taken.merged, {});
  auto result = [&] {
    if (is_complete(comm, taken, cells_move)) return as_it_is(std::move(taken.mesh).take(), options.refinement);
    auto closed = close(comm, std::move(taken), options, timer);
    if (cells_move) closed = balance(comm, std::move(closed), options, timer);
    auto made = split_pass(comm, closed, timer);
    return finish(comm, std::move(closed), std::move(made), options.refinement, timer);
  }();
  drop_level0_map_of_level0(comm, result.mesh);
  result.report.certificate.n_moved += ready.level0.n_moved;
  result.report.level0 = std::move(ready.level0);
  result.coarsening = coarsening;
  result.merged = std::move(merged);
  result.report.cells_in = sizes[0];
  result.report.nodes_in = sizes[1];
  PAMR_ENSURES_AUDIT(validate::validate(comm, result.mesh).empty());
  return result;
}

}  // namespace

Result adapt(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags, const Options& options) {
  const auto traffic = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  const bool cells_move = !mesh.is_lent();
  auto ready = with_level0_map(comm, std::move(mesh), flags, options.refinement);
  timer.lap("preprocessing");
  auto result = adapt_once(comm, std::move(ready), cells_move, flags, options, timer);
  result.report.steps = timer.steps();
  result.report.traffic = comm.traffic() - traffic;
  return result;
}

Result adapt_ready(const par::Comm& comm, ReadyMesh ready, std::span<const std::int8_t> flags, const Options& options) {
  PAMR_EXPECTS(!ready.mesh.is_lent());
  const auto traffic = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto result = adapt_once(comm, std::move(ready), true, flags, options, timer);
  result.report.steps = timer.steps();
  result.report.traffic = comm.traffic() - traffic;
  return result;
}

Result refine(const par::Comm& comm, GivenMesh mesh, std::span<const std::uint8_t> flags,
              const refine::Options& refinement, const Balancing& balancing) {
  return adapt(comm, std::move(mesh), signed_flags(flags), {refinement, balancing});
}

}  // namespace pamr::adapt
