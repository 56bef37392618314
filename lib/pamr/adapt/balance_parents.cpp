// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/balance_parents.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/closure_bytes.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/balance/price.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/refine/requests.hpp"

namespace pamr::adapt {

namespace {

std::vector<std::int64_t> exact_weights(const refine::Closure& closure) {
  const auto counts = refine::count_children(closure);
  std::vector<std::int64_t> weight(counts.size());
  for (std::size_t c = 0; c < counts.size(); ++c) weight[c] = counts[c];
  return weight;
}

}  // namespace

Balancing balancing_named(std::string_view method, std::string_view weights) {
  Balancing balancing;
  balancing.how.method = balance::method_named(method);
  if (balancing.how.method == balance::Method::best) balancing.how.keep_below = 1.05;
  if (weights == "8/1") {
    balancing.weights = Weights::eight_to_one;
  } else if (weights == "uniform") {
    balancing.weights = Weights::uniform;
  } else if (weights != "exact") {
    balancing.weights = Weights::field;
    balancing.field = weights;
  }
  return balancing;
}

std::vector<std::int64_t> cell_weights(const par::Comm& comm, const mesh::DistMesh& mesh,
                                       std::span<const std::uint8_t> requests, const refine::Closure& closure,
                                       const Balancing& balancing) {
  switch (balancing.weights) {
    case Weights::exact:
      return exact_weights(closure);
    case Weights::field:
      return balance::weights_from_field(comm, mesh, balancing.field);
    default:
      std::vector<std::int64_t> weight(at(mesh.n_cells()), 1);
      if (balancing.weights == Weights::eight_to_one)
        for (std::size_t c = 0; c < weight.size(); ++c)
          weight[c] = refine::asks_for(requests[c], refine::Request::split) ? 8 : 1;
      return weight;
  }
}

Balanced balance_parents(const par::Comm& comm, Parents parents, std::span<const std::uint8_t> requests,
                         const Options& options, StepTimer& timer) {
  const auto& balancing = options.balancing;
  const auto start = wall_seconds();
  Balanced balanced{std::move(parents), {}};
  auto& [mesh, borders, closure] = balanced.parents;
  auto& report = balanced.report;
  report.is_measured = true;
  const auto counts = refine::count_children(closure);
  report.before = balance::measure_ranks(comm, mesh, std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
  report.after = report.before;
  const bool is_exact = balancing.weights == Weights::exact;
  if (is_exact && (comm.size() == 1 || balance::meets(report.before, balancing.how))) return balanced;
  const auto weight = cell_weights(comm, mesh, requests, closure, balancing);
  if (balancing.how.method == balance::Method::none || comm.size() == 1) return balanced;
  const auto wanted = balance::partition(comm, mesh, weight, comm.size(), balancing.how);
  report.method = wanted.method;
  report.after =
      is_exact ? wanted.quality : balance::measure(comm, mesh, exact_weights(closure), wanted.part, comm.size());
  report.moved_cells = comm.sum(static_cast<std::int64_t>(wanted.part.size()) -
                                std::count(wanted.part.begin(), wanted.part.end(), comm.rank()));
  timer.lap("balance");
  const auto middle = wall_seconds();
  report.partition_seconds = middle - start;
  if (report.moved_cells == 0) return balanced;
  auto bytes = closure_to_bytes(closure);
  const bool cut_faces_conform = closure.cut_faces_conform;
  const auto of_closure = closure.report;
  {
    const auto of_old_mesh = std::pair(std::move(borders), std::move(closure));
  }  // the cells on their way need its room
  mesh = balance::migrate(comm, std::move(mesh), wanted.part, &bytes);
  closure = closure_from_bytes(mesh, bytes, options.refinement, of_closure);
  closure.cut_faces_conform = cut_faces_conform;
  borders = mesh::find_borders(comm, mesh);
  report.migrate_seconds = wall_seconds() - middle;
  timer.lap("migrate");
  return balanced;
}

}  // namespace pamr::adapt
