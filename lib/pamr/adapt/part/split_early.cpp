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

/// What look-ahead splits are made with.
struct Setting {
  const par::Comm& comm;
  const refine::Options& options;
  StepTimer& timer;
};

/// How far look-ahead splits are.
struct State {
  Closed start;            ///< the input
  Report report;           ///< of the first closing and the passes
  bool cut_faces_conform;  ///< of the closure that is known
  std::int64_t n_kept;     ///< families, at the last closing
  Coverage coverage{};
  MeshPart part{};
  mesh::Borders borders{};  ///< of the part
  bool is_whole = false;    ///< the part is the whole mesh
};

State start_with(Closed closed) {
  auto report = closed.report;
  report.closure = closed.closure.report;
  const auto n_kept = std::exchange(report.closure.families_kept, 0);
  report.closure.families_rebuilt = 0;  // of the first closing only marks and plans are of use
  const bool cut_faces_conform = closed.closure.cut_faces_conform;
  return {std::move(closed), std::move(report), cut_faces_conform, n_kept};
}

const mesh::DistMesh& input(const State& state) { return state.start.mesh.get(); }

WholeCells whole_cells(const State& state) { return {state.start.requests, state.start.closure}; }

WholeMesh whole(const State& state) { return {input(state), state.start.borders, whole_cells(state)}; }

void use(const Setting& with, State& state, MeshPart part) {
  state.part = std::move(part);
  state.borders = mesh::find_borders(with.comm, state.part.mesh);
}

/// A copy of the input with room for what has become of the part.
mesh::DistMesh copy_of_input(const State& state) {
  const auto n_more = state.part.mesh.node_position.size() - state.part.whole_node.size();
  return copy_with_room(input(state), at(input(state).n_cells()) + state.part.whole_cell.size(),
                        at(input(state).n_nodes()) + n_more);
}

void put_back_into(const Setting& with, State& state, mesh::DistMesh mesh, bool with_whole_cells) {
  auto joined =
      put_back(with.comm, {std::move(mesh), whole_cells(state)}, state.part, state.coverage, with_whole_cells);
  state.part = {};
  state.part.whole_cell = std::move(joined.whole_cell);
  state.part.requests = std::move(joined.requests);
  state.part.known = std::move(joined.known);
  state.part.mesh = std::move(joined.mesh);
  state.borders = mesh::find_borders(with.comm, state.part.mesh);
}

/// From here on the part is the whole mesh.
void take_whole(const Setting& with, State& state) {
  put_back_into(with, state, copy_of_input(state), true);
  state.is_whole = true;
}

/// Keeps the cells that passes may have taken away, for what has to be asked of them at the end.
void put_back_at_last(const Setting& with, State& state) {
  auto held = held_of(state.coverage);
  auto members = widen(with.comm, whole(state), {}, held);
  const bool is_lent = state.start.mesh.is_lent();
  auto mesh = is_lent ? copy_of_input(state) : std::move(state.start.mesh).take();
  state.start.before = InputCells{std::move(members.mesh), false, std::move(members.whole_cell)};
  put_back_into(with, state, std::move(mesh), is_lent);
}

void begin(const Setting& with, State& state) {
  state.coverage.of_cell.assign(at(input(state).n_cells()), Coverage::outside);
  if (!state.cut_faces_conform || with.comm.any(has_nodes_off_surface(input(state)))) {
    take_whole(with, state);
    return;
  }
  std::vector<LocalId> seeds;
  for (const auto& family : state.start.closure.rebuilt)
    if (family.is_early) seeds.push_back(family.first);
  spread(with.comm, whole(state), seeds, n_layers, state.coverage);
  use(with, state, widen(with.comm, whole(state), state.part, state.coverage));
}

/// Widens the part around these of its cells, which have open faces. False: there were none on any rank.
bool widen_around(const Setting& with, State& state, const std::vector<LocalId>& cells) {
  if (!with.comm.any(!cells.empty())) return false;
  std::vector<LocalId> seeds;
  for (const auto c : cells) seeds.push_back(state.part.whole_cell[at(c)]);
  spread(with.comm, whole(state), seeds, n_layers, state.coverage);
  use(with, state, widen(with.comm, whole(state), state.part, state.coverage));
  return true;
}

refine::Closure close_for(const Setting& with, State& state, std::span<const std::uint8_t> requests,
                          const refine::Carried& carried) {
  auto closure = refine::close(with.comm, state.part.mesh, state.borders, {requests, &carried}, with.options);
  state.report.closure.rounds += closure.report.rounds;
  state.report.closure.sweeps += closure.report.sweeps;
  return closure;
}

/// A pass over the part. If that is the whole mesh, flat patches may have to be looked for again.
Closed begin_pass(const Setting& with, const State& state) {
  if (state.is_whole) return open_pass(with.comm, std::as_const(state.part.mesh), state.borders, with.options);
  return {std::as_const(state.part.mesh), {}, state.start.info, state.start.surfaces, state.borders, {}, {}, {}, {}};
}

/// Cells with open faces that a pass would change.
std::vector<LocalId> touched_at_the_end(const State& state, const refine::Closure& closure) {
  auto cells = open_cells(state.part);
  std::erase_if(cells,
                [&](LocalId c) { return closure.marks[at(c)] == 0 && closure.action[at(c)] == refine::Action::split; });
  return cells;
}

/// Nothing where the whole mesh has to be split for an error to be described by its numbers; on all ranks alike.
std::optional<Split> try_to_split(const Setting& with, const State& state, Closed& pass) {
  try {
    return split_pass(with.comm, pass, with.timer);
  } catch (const Error&) {
    if (state.is_whole) throw;
    return {};
  }
}

/// Goes on with what a pass made.
void keep(const Setting& with, State& state, Closed pass, Split made) {
  const refine::NumberedMesh old{state.part.mesh, pass.closure, made.numbering};
  MeshPart part;
  part.whole_cell = cells_they_came_from(made.numbering, state.part.whole_cell);
  part.requests = refine::remaining_requests(old, state.part.requests);
  const bool has_moved = !std::equal(state.part.mesh.node_position.begin(), state.part.mesh.node_position.end(),
                                     made.fine.node_position.begin());
  if (state.cut_faces_conform && pass.closure.cut_faces_conform)
    part.known = refine::carry_over(old, state.part.known, has_moved);
  auto origin = origins_of_pass(with.comm.rank(), old, made.fine.cell_to_node, state.part.whole_cell);
  auto without_parent = with.options;
  without_parent.parent_field = false;
  auto result = transfer_pass(std::move(pass), std::move(made), without_parent);
  part.mesh = std::move(result.mesh);
  if (with.options.parent_field)  // made anew at the end
    std::erase_if(part.mesh.cell_fields, [](const auto& field) { return field.name == mesh::parent_field; });
  part.mesh.cell_origin = std::move(origin);
  part.whole_node = std::move(state.part.whole_node);
  part.is_cut = state.part.is_cut;
  part.has_face = std::move(state.part.has_face);
  add_to_report(result.report, state.report);
  with.timer.lap("transfer");
  use(with, state, std::move(part));
  with.timer.lap("preprocessing");
}

/// False: the part had to be widened first.
bool split(const Setting& with, State& state, refine::Closure closure) {
  refine::find_states(state.part.mesh, with.options, closure);
  if (state.is_whole) {
    require_depth(with.comm, state.part.mesh, closure);
  } else if (with.comm.any(is_too_deep(state.part.mesh, closure))) {  // which is said by the numbers of the whole mesh
    take_whole(with, state);
    return false;
  }
  auto pass = begin_pass(with, state);
  pass.closure = std::move(closure);
  pass.report.closure = pass.closure.report;
  auto made = try_to_split(with, state, pass);
  if (!made) {
    take_whole(with, state);
    return false;
  }
  if (!state.is_whole && made->certificate.back_off_rounds > 0) {  // nodes may go back at cells that are not here
    take_whole(with, state);
    return false;
  }
  const bool is_off = made->certificate.n_off_surface > 0 || made->certificate.n_off_facets > 0;
  keep(with, state, std::move(pass), std::move(*made));
  if (is_off && !state.is_whole) take_whole(with, state);
  return true;
}

/// The splits that have to go before: those of the early families. False if a family would have to be kept and broken
/// for it: then there is no such pass, and children are closed as they are, under the floor or not. So each early
/// pass splits all its early families, and there is an end to them.
bool make_pass(const Setting& with, State& state) {
  for (;;) {
    const auto early = refine::requests_of_early(state.part.requests, state.part.known.plans);
    auto closure = close_for(with, state, early, {});
    with.timer.lap("close");
    if (state.is_whole) {
      if (closure.report.families_kept > 0) return false;
    } else if (!closure.cut_faces_conform) {
      take_whole(with, state);
      continue;
    } else if (widen_around(with, state, touched_at_the_end(state, closure))) {
      continue;
    }
    if (split(with, state, std::move(closure))) return true;
  }
}

/// Cells with open faces that have other marks than in the whole mesh.
std::vector<LocalId> changed_at_the_end(const State& state, const refine::Closure& closure) {
  auto cells = open_cells(state.part);
  std::erase_if(cells, [&](LocalId c) {
    return closure.marks[at(c)] == state.start.closure.marks[at(state.part.whole_cell[at(c)])];
  });
  return cells;
}

/// Closes what a pass left open. True if there are early families again.
bool close_part(const Setting& with, State& state) {
  for (;;) {
    auto closure = close_for(with, state, state.part.requests, state.part.known);
    if (!state.is_whole && !closure.cut_faces_conform) {
      take_whole(with, state);
      state.part.known = {};  // with families kept all is to be found anew
      continue;
    }
    if (!state.is_whole && widen_around(with, state, changed_at_the_end(state, closure))) continue;
    state.part.known = {std::move(closure.marks), std::move(closure.rebuilt)};
    state.cut_faces_conform = closure.cut_faces_conform;
    state.n_kept = closure.report.families_kept;
    with.timer.lap("close");
    return closure.has_early;
  }
}

Closed finish(const Setting& with, State state) {
  auto closed = begin_pass(with, state);
  auto& closure = closed.closure;
  closure.marks = std::move(state.part.known.marks);
  closure.rebuilt = std::move(state.part.known.plans);
  closure.cut_faces_conform = state.cut_faces_conform;
  refine::decide_actions(state.part.mesh, closure);
  refine::find_states(state.part.mesh, with.options, closure);
  require_depth(with.comm, state.part.mesh, closure);
  state.report.closure.families_rebuilt += with.comm.sum(std::ssize(closure.rebuilt));
  state.report.closure.families_kept += state.n_kept;
  state.report.neighbors_closing = std::ssize(state.borders.nodes.rank);
  closure.report = state.report.closure;
  closed.report = std::move(state.report);
  closed.requests = std::move(state.part.requests);
  closed.input_cell = std::move(state.part.whole_cell);
  closed.mesh = std::move(state.part.mesh);
  if (state.is_whole) state.start.mesh.drop_links();
  closed.before = state.is_whole ? InputCells{std::move(state.start.mesh), true, {}} : std::move(state.start.before);
  with.timer.lap("close");
  return closed;
}

}  // namespace

Closed split_early(const par::Comm& comm, Closed closed, const refine::Options& options, StepTimer& timer) {
  if (!closed.closure.has_early) return closed;
  const Setting with{comm, options, timer};
  auto state = start_with(std::move(closed));
  begin(with, state);
  bool has_early = true;
  while (has_early && make_pass(with, state)) has_early = close_part(with, state);
  if (!state.is_whole) put_back_at_last(with, state);
  return finish(with, std::move(state));
}

}  // namespace pamr::adapt
