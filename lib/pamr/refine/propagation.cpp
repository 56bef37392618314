// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/propagation.hpp"

#include <bit>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/cell_shape.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/policy.hpp"

namespace pamr::refine {

Propagation::Propagation(const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
                         std::span<const std::uint8_t> retained, const Options& options, const Carried& carried)
    : mesh_(mesh), level0_(mesh), retained_(retained), options_(options) {
  assign_array(marks_, at(mesh.n_cells()), EdgeMask{0});
  reserve_array(waiting_, at(mesh.n_cells()));  // more than ever wait
  if (carried.marks.empty())
    start(requests);
  else
    start_from(carried, requests);
}

bool Propagation::is_removable(LocalId cell) const {
  return options_.quality_control == QualityControl::removable && mesh_.lineage[at(cell)].is_removable() &&
         (retained_.empty() || retained_[at(cell)] == 0);
}

/// Flagged cells get all their marks first; then only faces between a flagged and another cell are looked at: every
/// edge with both kinds of cells in its arc has such a face.
void Propagation::start(std::span<const std::uint8_t> requests) {
  const auto is_full = [&](LocalId c) { return asks_for(requests[at(c)], Request::split) && !is_removable(c); };
  for (LocalId c = 0; c < mesh_.n_cells(); ++c)
    if (is_full(c)) marks_[at(c)] = all_edges;
  constexpr LocalId ahead = 16;
  for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
    if (c + ahead < mesh_.n_cells() && requests[at(c + ahead)] != 0) prefetch_behind(c + ahead);
    if (requests[at(c)] == 0) continue;
    if (is_full(c)) {
      for (int f = 0; f < 4; ++f) mark_across(c, f);
    } else {
      start_family(c, requests[at(c)]);
    }
  }
}

void Propagation::start_family(LocalId cell, std::uint8_t request) {
  if (!is_removable(cell)) return;
  const auto lineage = mesh_.lineage[at(cell)];
  if (asks_for(request, Request::split))
    make_red(cell - lineage.child(), lineage.state());
  else
    wait(cell - lineage.child());
}

/// The cells that were there before have settled; the new ones get the marks on their border, and what is asked of
/// them.
void Propagation::start_from(const Carried& carried, std::span<const std::uint8_t> requests) {
  for (LocalId c = 0; c < mesh_.n_cells(); ++c)
    if (!carried.is_new(c)) marks_[at(c)] = carried.marks[at(c)];
  for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
    if (!carried.is_new(c)) continue;
    for (int f = 0; f < 4; ++f)
      if (const auto next = mesh_.cell_to_cell[at(c)][at(f)]; mesh_.is_own(next) && !carried.is_new(next))
        mark_from_behind(c, f);
  }
  for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
    if (!carried.is_new(c) || requests[at(c)] == 0) continue;
    if (asks_for(requests[at(c)], Request::split) && !is_removable(c))
      add_marks(c, all_edges);
    else
      start_family(c, requests[at(c)]);
  }
}

/// Marks the edges of a cell's face that are marked in the own cell behind it.
void Propagation::mark_from_behind(LocalId cell, int face) {
  const auto next = mesh_.cell_to_cell[at(cell)][at(face)];
  const unsigned marks = marks_[at(next)] & all_edges;
  if (marks == 0) return;
  const auto& mine = mesh_.cell_to_node[at(cell)];
  const auto& theirs = mesh_.cell_to_node[at(next)];
  for (int e = 0; e < 6; ++e)
    if ((mesh::tet::face_edge_mask[at(face)] >> e & 1) != 0) {
      const auto [p, q] = mesh::tet::edge_to_corner[at(e)];
      const int there =
          mesh::tet::edge_of[at(mesh::slot_of(theirs, mine[at(p)]))][at(mesh::slot_of(theirs, mine[at(q)]))];
      if ((marks >> there & 1U) != 0) mark(cell, e);
    }
}

/// Marks the edges of a cell's face in the cell behind it.
void Propagation::mark_across(LocalId cell, int face) {
  const auto next = mesh_.cell_to_cell[at(cell)][at(face)];
  if (!mesh_.is_own(next) || (marks_[at(next)] & all_edges) == all_edges) return;
  const auto& mine = mesh_.cell_to_node[at(cell)];
  const auto& theirs = mesh_.cell_to_node[at(next)];
  for (int e = 0; e < 6; ++e)
    if ((mesh::tet::face_edge_mask[at(face)] >> e & 1) != 0) {
      const auto [p, q] = mesh::tet::edge_to_corner[at(e)];
      mark(next, mesh::tet::edge_of[at(mesh::slot_of(theirs, mine[at(p)]))][at(mesh::slot_of(theirs, mine[at(q)]))]);
    }
}

void Propagation::wait(LocalId cell) {
  auto& marks = marks_[at(cell)];
  if ((marks & waiting) != 0) return;
  marks = static_cast<EdgeMask>(marks | waiting);
  waiting_.push_back(cell);
}

void Propagation::set_mark(LocalId cell, int edge) {
  auto& marks = marks_[at(cell)];
  const auto bit = static_cast<EdgeMask>(1U << edge);
  if ((marks & bit) != 0) return;
  marks = static_cast<EdgeMask>(marks | bit);
  if (is_removable(cell)) {  // a family waits as one, by its first member, and no more when its parent is red
    const auto first = cell - mesh_.lineage[at(cell)].child();
    if ((marks_[at(first)] & family_is_red) == 0) wait(first);
  } else if ((marks & all_edges) != all_edges) {
    wait(cell);
  }
}

void Propagation::mark(LocalId cell, int edge) {
  if (is_marked(cell, edge)) return;
  mesh::walk_ring(mesh_, cell, edge, [this](LocalId c, int e) { set_mark(c, e); });
}

void Propagation::add_marks(LocalId cell, EdgeMask wanted) {
  for (unsigned rest = wanted & ~static_cast<unsigned>(marks_[at(cell)]); rest != 0; rest &= rest - 1)
    mark(cell, std::countr_zero(rest));
}

/// Has what a waiting cell's rule reads fetched from memory: first the cell, later what is around it.
void Propagation::prefetch_cell(LocalId cell) const {
  prefetch(&mesh_.cell_to_node[at(cell)]);
  prefetch(&mesh_.cell_to_cell[at(cell)]);
  prefetch(&mesh_.lineage[at(cell)]);
}

void Propagation::prefetch_around(LocalId cell) const {
  const int size = is_removable(cell) ? mesh_.lineage[at(cell)].family_size() : 1;
  for (auto member = cell; member < cell + size; ++member) {
    for (const auto node : mesh_.cell_to_node[at(member)]) {
      prefetch(&mesh_.node_position[at(node)]);
      level0_.prefetch_key(node);
    }
    prefetch_behind(member);
  }
}

/// The cells at the faces, which walks from there come to first.
void Propagation::prefetch_behind(LocalId cell) const {
  for (const auto slot : mesh_.cell_to_cell[at(cell)]) {
    const auto next = at(mesh_.is_own(slot) ? slot : cell);
    prefetch(&mesh_.cell_to_node[next]);
    prefetch(&mesh_.cell_to_cell[next]);
    prefetch(&mesh_.lineage[next]);
    prefetch(&marks_[next]);
  }
}

int Propagation::settle() {
  constexpr std::size_t ahead = 20;
  std::vector<LocalId> batch;
  reserve_array(batch, marks_.size());
  int sweeps = 0;
  for (; !waiting_.empty(); ++sweeps) {
    batch.clear();
    if (waiting_.size() > marks_.size() / 64) {
      for (std::size_t c = 0; c < marks_.size(); ++c)
        if ((marks_[c] & waiting) != 0) batch.push_back(static_cast<LocalId>(c));
      waiting_.clear();
    } else {
      batch.swap(waiting_);
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (i + 2 * ahead < batch.size()) prefetch_cell(batch[i + 2 * ahead]);
      if (i + ahead < batch.size()) prefetch_around(batch[i + ahead]);
      apply_rule(batch[i]);
    }
  }
  return sweeps;
}

void Propagation::apply_rule(LocalId cell) {
  auto& marks = marks_[at(cell)];
  marks = static_cast<EdgeMask>(marks & ~waiting);
  if (is_removable(cell))
    apply_family_rule(cell);
  else
    add_marks(cell, required_marks(mesh_, level0_, cell, static_cast<EdgeMask>(marks & all_edges), options_));
}

/// A red parent: all its edges are marked. Those that have a midpoint already are no edges any more.
void Propagation::make_red(LocalId first, int state) {
  auto& flag = marks_[at(first)];
  if ((flag & family_is_red) != 0) return;
  flag = static_cast<EdgeMask>(flag | family_is_red);
  for (int child = 0; child < split_pattern[at(state)].n_children; ++child)
    add_marks(first + child, family_table[at(state)].edges_of_parent[at(child)]);
}

BaseCorners Propagation::parent_corners(LocalId first, int state) const {
  std::array<LocalId, 4> node{};
  for (int code = 0; code < 4; ++code) {
    const auto [member, slot] = family_table[at(state)].node[at(code)];
    node[at(code)] = mesh_.cell_to_node[at(first + member)][at(slot)];
  }
  return base_corners(mesh_, level0_, level0_.row_of(first), node);
}

/// What a mark on a member means: on an edge of the parent, the parent's marks grow until they are good; on a part of
/// one, the parent is red.
void Propagation::apply_family_rule(LocalId first) {
  if ((marks_[at(first)] & family_is_red) != 0) return;
  const int state = mesh_.lineage[at(first)].state();
  const auto& pattern = split_pattern[at(state)];
  unsigned meaning = pattern.mask;
  for (int child = 0; child < pattern.n_children; ++child)
    if (const auto marks = static_cast<EdgeMask>(marks_[at(first + child)] & all_edges); marks != 0)
      meaning |= marks_for_parent(state, child, marks);
  if ((meaning & beyond_parent) != 0) {
    make_red(first, state);
    return;
  }
  const CellShape shape(level0_, parent_corners(first, state), {pattern.mask, pattern.cuts});
  const auto required = shape.closed_marks(static_cast<EdgeMask>(meaning), options_.shape_floor);
  if (required == all_edges) {
    make_red(first, state);
    return;
  }
  const auto& edges = family_table[at(state)].edge;
  for (int child = 0; child < pattern.n_children; ++child)
    for (int e = 0; e < 6; ++e) {
      const auto edge = edges[at(child)][at(e)];
      if (edge.role == EdgeRole::parent && (required >> edge.parent_edge & 1) != 0) mark(first + child, e);
    }
}

std::vector<LocalId> Propagation::touched_families() const {
  std::vector<LocalId> touched;
  if (options_.quality_control != QualityControl::removable) return touched;
  for (LocalId c = 0; c < mesh_.n_cells();) {
    const int size = is_removable(c) ? mesh_.lineage[at(c)].family_size() : 1;
    if (size > 1) {
      unsigned any = 0;
      for (int child = 0; child < size; ++child) any |= marks_[at(c + child)];
      if (any != 0) touched.push_back(c);
    }
    c += size;
  }
  return touched;
}

std::vector<EdgeMask> Propagation::take_marks() && {
  for (auto& marks : marks_) marks = static_cast<EdgeMask>(marks & all_edges);
  return std::move(marks_);
}

}  // namespace pamr::refine
