// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/propagation.hpp"

#include <bit>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/policy.hpp"

namespace pamr::refine {

namespace {}  // namespace

Propagation::Propagation(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                         std::span<const std::uint8_t> kept, QualityControl policy)
    : mesh_(mesh), kept_(kept), policy_(policy) {
  assign_array(marks_, at(mesh.n_cells()), EdgeMask{0});
  reserve_array(waiting_, at(mesh.n_cells()));  // more than ever wait
  start_from_flags(flags);
}

bool Propagation::is_removable(LocalId cell) const {
  return policy_ == QualityControl::removable && mesh_.lineage[at(cell)].is_removable() &&
         (kept_.empty() || kept_[at(cell)] == 0);
}

/// Flagged cells get all their marks first; then only faces between a flagged and another cell are looked at: every
/// edge with both kinds of cells in its arc has such a face.
void Propagation::start_from_flags(std::span<const std::uint8_t> flags) {
  const auto is_full = [&](LocalId c) { return flags[at(c)] != 0 && !is_removable(c); };
  for (LocalId c = 0; c < mesh_.n_cells(); ++c)
    if (is_full(c)) marks_[at(c)] = all_edges;
  constexpr LocalId ahead = 16;
  for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
    if (c + ahead < mesh_.n_cells() && flags[at(c + ahead)] != 0) prefetch_behind(c + ahead);
    if (flags[at(c)] == 0) continue;
    if (!is_full(c)) {
      const auto lineage = mesh_.lineage[at(c)];
      make_red(c - lineage.child(), state_of_family(lineage));
      continue;
    }
    for (int f = 0; f < 4; ++f) {
      const auto next = mesh_.cell_to_cell[at(c)][at(f)];
      if (!mesh_.is_own(next) || (marks_[at(next)] & all_edges) == all_edges) continue;
      for (int e = 0; e < 6; ++e)
        if ((mesh::tet::face_edge_mask[at(f)] >> e & 1) != 0) {
          const auto [p, q] = mesh::tet::edge_to_corner[at(e)];
          const auto& mine = mesh_.cell_to_node[at(c)];
          const auto& theirs = mesh_.cell_to_node[at(next)];
          const int there =
              mesh::tet::edge_of[at(mesh::slot_of(theirs, mine[at(p)]))][at(mesh::slot_of(theirs, mine[at(q)]))];
          mark(next, there);
        }
    }
  }
}

namespace {

/// Edges of a member on which marks still have a consequence when the parent is red: those of the split face.
EdgeMask edges_of_split_face(mesh::Lineage lineage) {
  return lineage.kind() == mesh::FamilyKind::face ? mesh::tet::face_edge_mask[at(lineage.index())] : EdgeMask{0};
}

}  // namespace

void Propagation::set_mark(LocalId cell, int edge) {
  auto& marks = marks_[at(cell)];
  const auto bit = static_cast<EdgeMask>(1U << edge);
  if ((marks & bit) != 0) return;
  marks = static_cast<EdgeMask>(marks | bit);
  auto waiter = cell;
  if (is_removable(cell)) {  // a family waits as one, by its first member
    const auto lineage = mesh_.lineage[at(cell)];
    waiter -= lineage.child();
    if ((marks_[at(waiter)] & family_is_red) != 0 && (edges_of_split_face(lineage) & bit) == 0) return;
  } else if ((marks & all_edges) == all_edges) {
    return;
  }
  if ((marks_[at(waiter)] & waiting) != 0) return;
  marks_[at(waiter)] = static_cast<EdgeMask>(marks_[at(waiter)] | waiting);
  waiting_.push_back(waiter);
}

void Propagation::mark(LocalId cell, int edge) {
  if (is_marked(cell, edge)) return;
  mesh::walk_ring(mesh_, cell, edge, [this](LocalId c, int e) { set_mark(c, e); });
}

void Propagation::add_marks(LocalId cell, EdgeMask wanted) {
  for (unsigned rest = wanted & ~static_cast<unsigned>(marks_[at(cell)]); rest != 0; rest &= rest - 1)
    mark(cell, std::countr_zero(rest));
}

/// Has what a waiting cell's rule reads fetched from memory: first the cell, later what is round it.
void Propagation::prefetch_cell(LocalId cell) const {
  prefetch(&mesh_.cell_to_node[at(cell)]);
  prefetch(&mesh_.cell_to_cell[at(cell)]);
  prefetch(&mesh_.lineage[at(cell)]);
}

void Propagation::prefetch_round(LocalId cell) const {
  const int size = is_removable(cell) ? mesh_.lineage[at(cell)].family_size() : 1;
  for (auto member = cell; member < cell + size; ++member) {
    for (const auto node : mesh_.cell_to_node[at(member)]) prefetch(&mesh_.node_position[at(node)]);
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

void Propagation::settle() {
  constexpr std::size_t ahead = 20;
  std::vector<LocalId> batch;
  reserve_array(batch, marks_.size());
  while (!waiting_.empty()) {
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
      if (i + ahead < batch.size()) prefetch_round(batch[i + ahead]);
      apply_rule(batch[i]);
    }
  }
}

void Propagation::apply_rule(LocalId cell) {
  auto& marks = marks_[at(cell)];
  marks = static_cast<EdgeMask>(marks & ~waiting);
  if (is_removable(cell))
    apply_family_rule(cell);
  else
    add_marks(cell, required_marks(mesh_, cell, static_cast<EdgeMask>(marks & all_edges), policy_));
}

/// A red parent: all its edges are marked. Those that have a midpoint already are no edges any more.
void Propagation::make_red(LocalId first, int state) {
  auto& flag = marks_[at(first)];
  if ((flag & family_is_red) != 0) return;
  flag = static_cast<EdgeMask>(flag | family_is_red);
  for (int child = 0; child < split_pattern[at(state)].n_children; ++child)
    add_marks(first + child, edges_of_parent[at(state)][at(child)]);
}

geometry::TetPoints Propagation::parent_corners(LocalId first, int state) const {
  geometry::TetPoints corner;
  for (int code = 0; code < 4; ++code) {
    const auto [member, slot] = node_places[at(state)][at(code)];
    corner[at(code)] = mesh_.point(mesh_.cell_to_node[at(first + member)][at(slot)]);
  }
  return corner;
}

/// What a mark on a member means: on an edge of the parent, the parent's marks grow to a legal set; on a part of one,
/// the parent is red, and the parts of its split face obey the face rule as the children there will.
void Propagation::apply_family_rule(LocalId first) {
  const int state = state_of_family(mesh_.lineage[at(first)]);
  const auto& pattern = split_pattern[at(state)];
  const auto face_edges = edges_of_split_face(mesh_.lineage[at(first)]);
  unsigned meaning = pattern.mask;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto marks = static_cast<EdgeMask>(marks_[at(first + child)] & all_edges);
    add_marks(first + child, legal_mask[marks & face_edges]);
    meaning |= marks_for_parent[at(state)][at(child)][marks];
  }
  if ((marks_[at(first)] & family_is_red) != 0) return;
  const bool is_red = (meaning & beyond_parent) != 0;
  const unsigned parent_marks = meaning & all_edges;
  const auto legal = legal_mask[parent_marks];
  if (!is_red && legal == pattern.mask) return;
  if (is_red || legal == all_edges || closes_badly(parent_corners(first, state), legal)) {
    make_red(first, state);
    return;
  }
  for (int child = 0; child < pattern.n_children; ++child)
    for (int e = 0; e < 6; ++e) {
      const auto edge = family_edge(state, child, e);
      if (edge.role == EdgeRole::parent && (legal >> edge.parent_edge & 1) != 0) mark(first + child, e);
    }
}

std::vector<LocalId> Propagation::hit_families() const {
  std::vector<LocalId> hit;
  if (policy_ != QualityControl::removable) return hit;
  for (LocalId c = 0; c < mesh_.n_cells();) {
    const int size = is_removable(c) ? mesh_.lineage[at(c)].family_size() : 1;
    if (size > 1) {
      unsigned any = 0;
      for (int child = 0; child < size; ++child) any |= marks_[at(c + child)];
      if (any != 0) hit.push_back(c);
    }
    c += size;
  }
  return hit;
}

std::vector<EdgeMask> Propagation::take_marks() && {
  for (auto& marks : marks_) marks = static_cast<EdgeMask>(marks & all_edges);
  return std::move(marks_);
}

}  // namespace pamr::refine
