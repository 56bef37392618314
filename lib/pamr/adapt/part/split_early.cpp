// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/split_early.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/part/mesh_part.hpp"
#include "pamr/adapt/part/open_parents.hpp"
#include "pamr/adapt/part/put_back.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/refine/carried.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/requests.hpp"

namespace pamr::adapt {

namespace {

/// Faces from the early families to the end of the part, and by how many it grows: few passes go farther.
constexpr int n_layers = 6;

/// Adds what one pass did to what is known of those before it.
void add_to_report(const Report& pass, Report& sum) {
  sum.closure.families_rebuilt += pass.closure.families_rebuilt;
  sum.closure.families_kept += pass.closure.families_kept;
  ++sum.closure.early_passes;
  sum.certificate.n_moved += pass.certificate.n_moved;
  sum.certificate.n_cells_checked += pass.certificate.n_cells_checked;
  sum.certificate.back_off_rounds += pass.certificate.back_off_rounds;
  sum.certificate.untangling_rounds += pass.certificate.untangling_rounds;
}

/// This rank's input cell that each cell of a pass came from. `before`: those of its old cells.
std::vector<LocalId> cells_they_came_from(const refine::Numbering& numbering, std::span<const LocalId> before) {
  std::vector<LocalId> from(at(numbering.first_child.back()));
  for (std::size_t c = 0; c + 1 < numbering.first_child.size(); ++c)
    std::fill(from.begin() + numbering.first_child[c], from.begin() + numbering.first_child[c + 1], before[c]);
  return from;
}

bool has_nodes_off_surface(const mesh::DistMesh& mesh) {
  const auto* field = mesh.find_node_field(mesh::off_surface_field);
  if (field == nullptr || field->holds_integers()) return false;
  return std::any_of(field->real().begin(), field->real().end(), [](double distance) { return distance > 0; });
}

class EarlyPasses {
 public:
  EarlyPasses(const par::Comm& comm, Closed closed, const refine::Options& options, StepTimer& timer)
      : comm_(comm),
        start_(std::move(closed)),
        options_(options),
        timer_(timer),
        report_(start_.report),
        cut_faces_conform_(start_.closure.cut_faces_conform) {
    report_.closure = start_.closure.report;
    n_kept_ = std::exchange(report_.closure.families_kept, 0);
    report_.closure.families_rebuilt = 0;  // of the first closing only marks and plans are of use
  }

  Closed run() && {
    begin();
    bool has_early = true;
    while (has_early && make_pass()) has_early = close_part();
    if (!is_whole_) put_back_at_last();
    return std::move(*this).finish();
  }

 private:
  const mesh::DistMesh& input() const { return start_.mesh.get(); }
  WholeCells whole_cells() const { return {start_.requests, start_.closure}; }
  WholeMesh whole() const { return {input(), start_.borders, whole_cells()}; }

  void begin() {
    coverage_.of_cell.assign(at(input().n_cells()), Coverage::outside);
    if (!cut_faces_conform_ || comm_.any(has_nodes_off_surface(input()))) {
      take_whole();
      return;
    }
    std::vector<LocalId> seeds;
    for (const auto& family : start_.closure.rebuilt)
      if (family.is_early) seeds.push_back(family.first);
    spread(comm_, whole(), seeds, n_layers, coverage_);
    use(widen(comm_, whole(), part_, coverage_));
  }

  void use(MeshPart part) {
    part_ = std::move(part);
    borders_ = mesh::find_borders(comm_, part_.mesh);
  }

  /// A copy of the input with room for what has become of the part.
  mesh::DistMesh copy_of_input() const {
    const auto n_more = part_.mesh.node_position.size() - part_.whole_node.size();
    return copy_with_room(input(), at(input().n_cells()) + part_.whole_cell.size(), at(input().n_nodes()) + n_more);
  }

  /// From here on the part is the whole mesh.
  void take_whole() {
    put_back_into(copy_of_input(), true);
    is_whole_ = true;
  }

  void put_back_into(mesh::DistMesh mesh, bool with_whole_cells) {
    auto joined = put_back(comm_, std::move(mesh), whole_cells(), part_, coverage_, with_whole_cells);
    part_ = {};
    part_.whole_cell = std::move(joined.whole_cell);
    part_.requests = std::move(joined.requests);
    part_.known = std::move(joined.known);
    part_.mesh = std::move(joined.mesh);
    borders_ = mesh::find_borders(comm_, part_.mesh);
  }

  /// Keeps the cells that passes may have taken away, for what has to be asked of them at the end.
  void put_back_at_last() {
    auto held = held_of(coverage_);
    auto members = widen(comm_, whole(), {}, held);
    const bool is_lent = start_.mesh.is_lent();
    auto mesh = is_lent ? copy_of_input() : std::move(start_.mesh).take();
    start_.before = InputCells{std::move(members.mesh), false, std::move(members.whole_cell)};
    put_back_into(std::move(mesh), is_lent);
  }

  /// Widens the part around these of its cells, which have open faces. False: there were none on any rank.
  bool widen_around(const std::vector<LocalId>& cells) {
    if (!comm_.any(!cells.empty())) return false;
    std::vector<LocalId> seeds;
    for (const auto c : cells) seeds.push_back(part_.whole_cell[at(c)]);
    spread(comm_, whole(), seeds, n_layers, coverage_);
    use(widen(comm_, whole(), part_, coverage_));
    return true;
  }

  refine::Closure close(std::span<const std::uint8_t> requests, const refine::Carried& carried) {
    auto closure = refine::close(comm_, part_.mesh, borders_, requests, options_, carried);
    report_.closure.rounds += closure.report.rounds;
    report_.closure.sweeps += closure.report.sweeps;
    return closure;
  }

  /// A pass over the part. If that is the whole mesh, flat patches may have to be looked for again.
  Closed open() {
    if (is_whole_) return open_pass(comm_, std::as_const(part_.mesh), borders_, options_);
    return {std::as_const(part_.mesh), {}, start_.info, start_.surfaces, borders_, {}, {}, {}, {}};
  }

  /// The splits that have to go before: those of the early families. False if a family would have to be kept and broken
  /// for it: then there is no such pass, and children are closed as they are, under the floor or not. So each early
  /// pass splits all its early families, and there is an end to them.
  bool make_pass() {
    for (;;) {
      const auto early = refine::requests_of_early(part_.requests, part_.known.plans);
      auto closure = close(early, {});
      timer_.lap("close");
      if (is_whole_) {
        if (closure.report.families_kept > 0) return false;
      } else if (!closure.cut_faces_conform) {
        take_whole();
        continue;
      } else if (widen_around(touched_at_the_end(closure))) {
        continue;
      }
      if (split(std::move(closure))) return true;
    }
  }

  /// Cells with open faces that a pass would change.
  std::vector<LocalId> touched_at_the_end(const refine::Closure& closure) const {
    auto cells = open_cells(part_);
    std::erase_if(
        cells, [&](LocalId c) { return closure.marks[at(c)] == 0 && closure.action[at(c)] == refine::Action::split; });
    return cells;
  }

  /// False: the part had to be widened first.
  bool split(refine::Closure closure) {
    refine::find_states(part_.mesh, options_, closure);
    if (is_whole_) {
      require_depth(comm_, part_.mesh, closure);
    } else if (comm_.any(is_too_deep(part_.mesh, closure))) {  // which is said by the numbers of the whole mesh
      take_whole();
      return false;
    }
    auto pass = open();
    pass.closure = std::move(closure);
    pass.report.closure = pass.closure.report;
    auto made = try_to_split(pass);
    if (!made) {
      take_whole();
      return false;
    }
    if (comm_.any(made->reaches_open)) {
      widen_around(open_cells(part_));
      return false;
    }
    const bool is_off = made->certificate.n_off_surface > 0 || made->certificate.n_off_facets > 0;
    keep(std::move(pass), std::move(*made));
    if (is_off && !is_whole_) take_whole();
    return true;
  }

  /// Nothing where the whole mesh has to be split for an error to be described by its numbers; on all ranks alike.
  std::optional<Split> try_to_split(const Closed& pass) {
    try {
      return split_pass(comm_, pass, timer_, open_nodes(part_));
    } catch (const Error&) {
      if (is_whole_) throw;
      return {};
    }
  }

  /// Goes on with what a pass made.
  void keep(Closed pass, Split made) {
    const refine::NumberedMesh old{part_.mesh, pass.closure, made.numbering};
    MeshPart part;
    part.whole_cell = cells_they_came_from(made.numbering, part_.whole_cell);
    part.requests = refine::remaining_requests(old, part_.requests);
    const bool has_moved =
        !std::equal(part_.mesh.node_position.begin(), part_.mesh.node_position.end(), made.fine.node_position.begin());
    if (cut_faces_conform_ && pass.closure.cut_faces_conform)
      part.known = refine::carry_over(old, part_.known, has_moved);
    auto origin = origins_of_pass(comm_.rank(), old, made.fine.cell_to_node, part_.whole_cell);
    auto without_parent = options_;
    without_parent.parent_field = false;
    auto result = transfer_pass(std::move(pass), std::move(made), without_parent);
    part.mesh = std::move(result.mesh);
    if (options_.parent_field)  // made anew at the end
      std::erase_if(part.mesh.cell_fields, [](const auto& field) { return field.name == mesh::parent_field; });
    part.mesh.cell_origin = std::move(origin);
    part.whole_node = std::move(part_.whole_node);
    part.is_cut = part_.is_cut;
    part.has_face = std::move(part_.has_face);
    add_to_report(result.report, report_);
    timer_.lap("transfer");
    use(std::move(part));
    timer_.lap("preprocessing");
  }

  /// Closes what a pass left open. True if there are early families again.
  bool close_part() {
    for (;;) {
      auto closure = close(part_.requests, part_.known);
      if (!is_whole_ && !closure.cut_faces_conform) {
        take_whole();
        part_.known = {};  // with families kept all is to be found anew
        continue;
      }
      if (!is_whole_ && widen_around(changed_at_the_end(closure))) continue;
      part_.known = {std::move(closure.marks), std::move(closure.rebuilt)};
      cut_faces_conform_ = closure.cut_faces_conform;
      n_kept_ = closure.report.families_kept;
      timer_.lap("close");
      return closure.has_early;
    }
  }

  /// Cells with open faces that have other marks than in the whole mesh.
  std::vector<LocalId> changed_at_the_end(const refine::Closure& closure) const {
    auto cells = open_cells(part_);
    std::erase_if(cells,
                  [&](LocalId c) { return closure.marks[at(c)] == start_.closure.marks[at(part_.whole_cell[at(c)])]; });
    return cells;
  }

  Closed finish() && {
    auto closed = open();
    auto& closure = closed.closure;
    closure.marks = std::move(part_.known.marks);
    closure.rebuilt = std::move(part_.known.plans);
    closure.cut_faces_conform = cut_faces_conform_;
    refine::decide_actions(part_.mesh, closure);
    refine::find_states(part_.mesh, options_, closure);
    require_depth(comm_, part_.mesh, closure);
    report_.closure.families_rebuilt += comm_.sum(std::ssize(closure.rebuilt));
    report_.closure.families_kept += n_kept_;
    report_.neighbors_closing = std::ssize(borders_.nodes.rank);
    closure.report = report_.closure;
    closed.report = std::move(report_);
    closed.requests = std::move(part_.requests);
    closed.input_cell = std::move(part_.whole_cell);
    closed.mesh = std::move(part_.mesh);
    if (is_whole_) start_.mesh.drop_links();
    closed.before = is_whole_ ? InputCells{std::move(start_.mesh), true, {}} : std::move(start_.before);
    timer_.lap("close");
    return closed;
  }

  const par::Comm& comm_;
  Closed start_;  ///< the input
  const refine::Options& options_;
  StepTimer& timer_;
  Report report_;           ///< of the first closing and the passes
  bool cut_faces_conform_;  ///< of the closure that is known
  std::int64_t n_kept_ = 0;
  Coverage coverage_;
  MeshPart part_;
  mesh::Borders borders_;
  bool is_whole_ = false;
};

}  // namespace

Closed split_early(const par::Comm& comm, Closed closed, const refine::Options& options, StepTimer& timer) {
  if (!closed.closure.has_early) return closed;
  return EarlyPasses(comm, std::move(closed), options, timer).run();
}

}  // namespace pamr::adapt
