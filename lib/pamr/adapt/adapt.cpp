// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/adapt.hpp"

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/early_passes.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/open_parents.hpp"
#include "pamr/adapt/pass.hpp"
#include "pamr/adapt/refine_closed.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/refine/integrals.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

/// Closes the mesh, after splitting early families until there are none. `own`: the input, if it may be changed.
Ready make_ready(const par::Comm& comm, const mesh::DistMesh& input, std::span<const std::uint8_t> flags,
                 const refine::Options& options, StepTimer& timer, mesh::DistMesh* own = nullptr,
                 std::optional<KnownClosure> known = {}) {
  checked_signs(comm, input, signed_flags(flags), options);
  refine::require_integrals(comm, input, options.integrals);
  const auto limited = limit_depth(input, flags);
  Ready ready{{}, refine::requests_of_flags(limited.flags), {}, {}, {}};
  ready.closed = close_pass(comm, input, ready.requests, {}, options, timer, std::move(known));
  const auto n_marked = ready.closed.report.closure.n_marked;
  const auto n_cells = input.info.n_global_cells, n_nodes = input.info.n_global_nodes;
  ready = split_all_early(comm, input, std::move(ready), options, timer, own);
  auto& report = ready.closed.report;
  const auto& mesh = ready.mesh ? *ready.mesh : input;
  report.closure.n_marked = n_marked;
  report.cells_in = n_cells;
  report.nodes_in = n_nodes;
  std::array<std::int64_t, 2> sums{refine::count_not_split(mesh, ready.requests, ready.closed.closure),
                                   limited.n_left_out};
  comm.sum_in_place(sums);
  report.marked_not_split = sums[0];
  report.marked_too_deep = sums[1];
  return ready;
}

/// What early passes began with, for what has to be asked of it at the end.
struct Before {
  const mesh::DistMesh* mesh = nullptr;         ///< null: there were none
  const std::vector<LocalId>* cells = nullptr;  ///< those that it has; null: all
};

/// Fields of the last pass. Collective, if there were early ones.
RefineResult transfer_last(const par::Comm& comm, const Before& before, const mesh::DistMesh& parents, Closed closed,
                           Split made, const refine::Options& options) {
  if (before.mesh == nullptr) return transfer_pass(parents, std::move(closed), std::move(made), options);
  const auto open = find_open_parents({parents, closed.closure, made.numbering}, made.fine.cell_to_node);
  auto result = transfer_pass(parents, std::move(closed), std::move(made), options);
  settle_open_parents(comm, *before.mesh, before.cells, open, options, result.mesh);
  return result;
}

Before before_of(const Ready& ready, const mesh::DistMesh* input) {
  if (ready.members) return {&ready.members->mesh, &ready.members->cell};
  return {input, nullptr};
}

RefineResult complete(const par::Comm& comm, RefineResult result, const StepTimer& timer, const Traffic& before) {
  PAMR_ENSURES_AUDIT(validate::validate(comm, result.mesh).empty());
  result.report.steps = timer.steps();
  result.report.traffic = comm.traffic() - before;
  return result;
}

}  // namespace

RefineResult refine(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                    const refine::Options& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto ready = make_ready(comm, mesh, flags, options, timer);
  const auto& parents = ready.mesh ? *ready.mesh : mesh;
  auto made = split_pass(comm, parents, ready.closed, timer);
  const auto input = before_of(ready, ready.mesh ? &mesh : nullptr);
  auto result = transfer_last(comm, input, parents, std::move(ready.closed), std::move(made), options);
  timer.lap("transfer");
  return complete(comm, std::move(result), timer, before);
}

RefineResult refine(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                    const Options& options) {
  return refine_closed(comm, std::move(mesh), flags, {}, options);
}

RefineResult refine_closed(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                           std::optional<KnownClosure> known, const Options& options) {
  const auto before = comm.traffic();
  StepTimer timer([&] { return comm.traffic(); });
  auto ready = make_ready(comm, mesh, flags, options.refinement, timer, &mesh, std::move(known));
  std::optional<mesh::DistMesh> input;
  if (ready.mesh) {
    auto now = *std::exchange(ready.mesh, {});
    if (!ready.members) input = std::move(mesh);
    mesh = std::move(now);
    if (input) input->cell_to_cell = {};
  }
  auto& closed = ready.closed;
  auto [parents, balance] =
      balance_parents(comm, {std::move(mesh), std::move(closed.borders), std::move(closed.closure)}, ready.requests,
                      options.balancing, options.refinement, timer);
  timer.lap("balance");
  closed.borders = std::move(parents.borders);
  closed.closure = std::move(parents.closure);
  closed.report.balance = balance;
  auto made = split_pass(comm, parents.mesh, closed, timer);
  parents.mesh.cell_to_cell = {};  // the children have links of their own, and fields need room
  auto result = transfer_last(comm, before_of(ready, input ? &*input : nullptr), parents.mesh, std::move(closed),
                              std::move(made), options.refinement);
  timer.lap("transfer");
  return complete(comm, std::move(result), timer, before);
}

}  // namespace pamr::adapt
