// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/close.hpp"

#include <algorithm>
#include <array>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/cut_faces.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/policy.hpp"
#include "pamr/refine/propagation.hpp"

namespace pamr::refine {

namespace {

/// Settles this rank, sends the neighbors which border edges are marked, and so on until nobody has news. Counts the
/// exchanges and this rank's sweeps.
void settle_all(const par::Comm& comm, const mesh::Borders& borders, Propagation& propagation, ClosureReport& report) {
  const par::Exchange exchange(comm, borders.edges);
  std::vector<std::uint8_t> is_marked(borders.n_edges(), 0);
  for (bool news = true; news;) {
    report.sweeps += propagation.settle();
    for (std::size_t i = 0; i < borders.n_edges(); ++i)
      for (const auto arc : borders.arcs(i))
        if (propagation.is_marked(arc.cell, arc.edge)) is_marked[i] = 1;
    par::fold_flags(exchange, is_marked);
    ++report.rounds;
    bool changed = false;
    for (std::size_t i = 0; i < borders.n_edges(); ++i)
      for (const auto arc : borders.arcs(i))
        if (is_marked[i] != 0 && !propagation.is_marked(arc.cell, arc.edge)) {
          propagation.mark(arc.cell, arc.edge);
          changed = true;
        }
    news = comm.any(changed);
  }
}

/// How families are split anew.
struct Plans {
  std::vector<RebuiltFamily> rebuilt;   ///< ascending
  std::vector<LocalId> impossible;      ///< first members of those that cannot be taken back
  std::vector<mesh::CellEdge> implied;  ///< marks that are missing
  bool has_early = false;
};

/// Plans of families that hold as long as their members have these marks.
struct KnownPlans {
  std::vector<EdgeMask> marks;
  std::vector<RebuiltFamily> plans;  ///< ascending
};

bool has_same_marks(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, const KnownPlans& known,
                    LocalId first) {
  const auto begin = marks.begin() + first;
  return std::equal(begin, begin + mesh.lineage[at(first)].family_size(), known.marks.begin() + first,
                    [](EdgeMask a, EdgeMask b) { return ((a ^ b) & all_edges) == 0; });
}

Plans plan_families(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, const std::vector<LocalId>& touched,
                    const KnownPlans& known, double shape_floor) {
  constexpr std::size_t ahead = 8;
  auto next = known.plans.begin();
  Plans plans;
  reserve_array(plans.rebuilt, touched.size());
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (i + 2 * ahead < touched.size()) prefetch(&mesh.cell_to_node[at(touched[i + 2 * ahead])]);
    if (i + ahead < touched.size())  // two members have most of the nodes
      for (int member = 0; member < 2; ++member)
        for (const auto node : mesh.cell_to_node[at(touched[i + ahead] + member)])
          prefetch(&mesh.node_position[at(node)]);
    while (next != known.plans.end() && next->first < touched[i]) ++next;
    if (next != known.plans.end() && next->first == touched[i] && has_same_marks(mesh, marks, known, touched[i])) {
      plans.rebuilt.push_back(*next);
      plans.has_early = plans.has_early || next->is_early;
      continue;
    }
    const auto [plan, implied] = plan_family(mesh, view_family(mesh, marks, touched[i]), shape_floor);
    if (plan.state == 0)
      plans.impossible.push_back(touched[i]);
    else
      plans.rebuilt.push_back(plan);
    plans.implied.insert(plans.implied.end(), implied.begin(), implied.end());
    plans.has_early = plans.has_early || plan.is_early;
  }
  return plans;
}

/// Marks what requests and plans imply until neither implies more. Collective.
Plans settle_plans(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                   const Options& options, KnownPlans known, Propagation& propagation, ClosureReport& report) {
  for (;;) {
    settle_all(comm, borders, propagation, report);
    const auto& marks = propagation.marks_and_more();
    auto plans = plan_families(mesh, marks, propagation.touched_families(), known, options.shape_floor);
    if (!comm.any(!plans.implied.empty())) return plans;
    known = {marks, std::move(plans.rebuilt)};
    for (const auto edge : plans.implied) propagation.mark(edge.cell, edge.edge);
  }
}

std::int64_t count_retained_and_marked(const mesh::DistMesh& mesh, const std::vector<std::uint8_t>& retained,
                                       const std::vector<EdgeMask>& marks) {
  std::int64_t n = 0;
  if (retained.empty()) return n;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (retained[at(c)] != 0 && mesh.lineage[at(c)].child() == 0) {
      unsigned any = 0;
      for (int child = 0; child < mesh.lineage[at(c)].family_size(); ++child) any |= marks[at(c + child)];
      n += any != 0 ? 1 : 0;
    }
  return n;
}

}  // namespace

Closure close(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders, const Wanted& wanted,
              const Options& options) {
  const auto requests = wanted.requests;
  PAMR_EXPECTS(requests.size() == at(mesh.n_cells()));
  Closure closure;
  const bool is_removable = options.quality_control == QualityControl::removable;
  std::vector<std::uint8_t> retained;
  bool retains_any = false;  // on some rank
  // All unpaired families are retained before anything is marked, those that no mark would reach as well: families
  // beside them are retained for them, and which of these are met first would depend on the partition.
  if (is_removable && !mesh.info.cut_faces_conform) {
    const auto unpaired = find_unpaired_families(comm, mesh, borders);
    retains_any = comm.any(!unpaired.empty());
    if (retains_any) retain_families(comm, mesh, borders, unpaired, retained);
  }
  const Carried nothing;
  for (;;) {
    const auto& start = retains_any || wanted.carried == nullptr ? nothing : *wanted.carried;
    Propagation propagation(mesh, requests, retained, options, start);
    auto plans = settle_plans(comm, mesh, borders, options, {start.marks, start.plans}, propagation, closure.report);
    closure.marks = std::move(propagation).take_marks();
    closure.rebuilt = std::move(plans.rebuilt);
    closure.has_early = plans.has_early;
    if (!comm.any(!plans.impossible.empty())) break;
    retains_any = true;
    retain_families(comm, mesh, borders, plans.impossible, retained);
  }
  closure.has_early = comm.any(closure.has_early);
  // With no family retained none is split while it is whole; what is made at a cut face is a whole family on both
  // sides.
  closure.cut_faces_conform = is_removable && !retains_any;
  const auto n_marked = std::count_if(requests.begin(), requests.end(),
                                      [](auto request) { return static_cast<Request>(request) == Request::split; });
  std::array<std::int64_t, 3> sum{n_marked, count_retained_and_marked(mesh, retained, closure.marks),
                                  static_cast<std::int64_t>(closure.rebuilt.size())};
  comm.sum_in_place(sum);
  closure.report.n_marked = sum[0];
  closure.report.families_kept = sum[1];
  closure.report.families_rebuilt = sum[2];
  closure.report.sweeps = static_cast<int>(comm.max(std::int64_t{closure.report.sweeps}));
  decide_actions(mesh, closure);
  return closure;
}

}  // namespace pamr::refine
