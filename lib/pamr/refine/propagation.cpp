// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/propagation.hpp"

#include <bit>

#include "pamr/mesh/ring.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/policy.hpp"

namespace pamr::refine {

namespace {
constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

Propagation::Propagation(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                         std::span<const std::uint8_t> kept, QualityControl policy)
    : mesh_(mesh), kept_(kept), policy_(policy), marks_(at(mesh.n_cells()), 0) {
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
  for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
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

void Propagation::set_mark(LocalId cell, int edge) {
  auto& marks = marks_[at(cell)];
  const auto bit = static_cast<EdgeMask>(1U << edge);
  if ((marks & bit) != 0) return;
  marks = static_cast<EdgeMask>(marks | bit);
  // a family waits as one, by its first member
  const auto waiter = is_removable(cell) ? cell - mesh_.lineage[at(cell)].child() : cell;
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

/// Has what a waiting cell's rule reads fetched from memory: first its nodes, later their positions.
void Propagation::prefetch_cell(LocalId cell) const {
  __builtin_prefetch(&mesh_.cell_to_node[at(cell)]);
  __builtin_prefetch(&mesh_.cell_to_cell[at(cell)]);
  __builtin_prefetch(&mesh_.lineage[at(cell)]);
}

void Propagation::prefetch_points(LocalId cell) const {
  if (!is_removable(cell)) {
    for (const auto node : mesh_.cell_to_node[at(cell)]) __builtin_prefetch(&mesh_.node_position[at(node)]);
    return;
  }
  for (int child = 0; child < mesh_.lineage[at(cell)].family_size(); ++child)
    for (const auto next : mesh_.cell_to_cell[at(cell + child)])
      if (mesh_.is_own(next)) {
        __builtin_prefetch(&mesh_.cell_to_node[at(next)]);
        __builtin_prefetch(&mesh_.cell_to_cell[at(next)]);
      }
}

void Propagation::settle() {
  constexpr std::size_t ahead = 20;
  std::vector<LocalId> batch;
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
      if (i + ahead < batch.size()) prefetch_points(batch[i + ahead]);
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
  for (int child = 0; child < split_pattern[at(state)].n_children; ++child)
    for (int slot = 0; slot < 4; ++slot) {
      const int code = split_pattern[at(state)].child_to_node[at(child)][at(slot)];
      if (code < 4) corner[at(code)] = mesh_.point(mesh_.cell_to_node[at(first + child)][at(slot)]);
    }
  return corner;
}

/// What a mark on a member means: on an edge of the parent, the parent's marks grow to a legal set; on a part of one,
/// the parent is red, and the parts of its split face obey the face rule as the children there will.
void Propagation::apply_family_rule(LocalId first) {
  const int state = state_of_family(mesh_.lineage[at(first)]);
  const auto& pattern = split_pattern[at(state)];
  unsigned parent_marks = pattern.mask;
  bool is_red = (marks_[at(first)] & family_is_red) != 0;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto marks = static_cast<EdgeMask>(marks_[at(first + child)] & all_edges);
    if (pattern.kind == mesh::FamilyKind::face) {
      const auto on_face = static_cast<EdgeMask>(marks & mesh::tet::face_edge_mask[at(pattern.index)]);
      if (std::popcount(on_face) == 2) add_marks(first + child, mesh::tet::face_edge_mask[at(pattern.index)]);
    }
    const auto of_parent = edges_of_parent[at(state)][at(child)];
    is_red = is_red || (marks & ~of_parent) != 0;
    for (unsigned rest = marks & of_parent; rest != 0; rest &= rest - 1)
      parent_marks |= 1U << family_edge(state, child, std::countr_zero(rest)).parent_edge;
  }
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
