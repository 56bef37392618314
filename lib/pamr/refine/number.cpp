// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/number.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <span>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/local_size.hpp"
#include "pamr/mesh/offsets.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::refine {

namespace {

/// What each old cell brings forth: nodes that it is the lowest cell of, and children.
struct Counts {
  std::vector<std::uint8_t> nodes;
  std::vector<std::uint8_t> cells;
};

void make_rows(const Closure& closure, Numbering& numbering) {
  LocalId n_rows = 0;
  reserve_array(numbering.row, closure.marks.size());
  for (const auto marks : closure.marks) {
    numbering.row.push_back(marks != 0 ? n_rows : -1);
    n_rows += marks != 0 ? 1 : 0;
  }
  reserve_array(numbering.ends, 6 * at(n_rows));  // more than there will be
  std::array<LocalId, 6> empty{};
  empty.fill(invalid_local);
  assign_array(numbering.edge_to_node, at(n_rows), empty);
}

/// Patches of the boundary met at the ends of an arc, and of faces inside within it; those of a border edge are completed
/// by the other ranks.
class EdgePatches {
 public:
  void add(LocalId slot) {
    if (slot >= 0) return;
    const int patch = mesh::slot_to_patch(slot);
    (count_ == 0 ? patch_[0] : patch_[1]) = patch;
    ++count_;
  }
  void add_inside(int patch) { mesh::add_patch(inside_, patch); }
  bool is_complete() const { return count_ == 2 || inside_[0] >= 0; }
  mesh::PatchList all() const {
    auto list = inside_;
    for (int i = 0; i < (count_ == 2 ? 2 : 0); ++i) mesh::add_patch(list, patch_[at(i)]);
    return list;
  }
  void merge(const EdgePatches& other) {
    for (int i = 0; i < other.count_ && count_ < 2; ++i) {
      patch_[at(count_)] = other.patch_[at(i)];
      ++count_;
    }
    for (const int patch : other.inside_) mesh::add_patch(inside_, patch);
  }

 private:
  std::array<int, 2> patch_{-1, -1};
  int count_ = 0;
  mesh::PatchList inside_{-1, -1, -1, -1};
};

/// A border edge on its way over the ranks that share it: the lowest cell that anyone has at it, and its patches.
struct SharedEdge {
  GlobalId lowest = std::numeric_limits<GlobalId>::max();
  int edge = 0;  ///< of the lowest cell
  EdgePatches patches;
};

class NodeMaker {
 public:
  NodeMaker(const mesh::DistMesh& mesh, const Closure& closure, Numbering& numbering)
      : mesh_(mesh), closure_(closure), numbering_(numbering), inner_(mesh) {
    const auto& patches = mesh.info.patches;
    has_surfaces_inside_ = !inner_.is_empty() && std::any_of(patches.begin(), patches.end(),
                                                             [](const auto& patch) { return patch.surface >= 0; });
  }

  LocalId make(LocalId cell, int edge) {
    const auto& nodes = mesh_.cell_to_node[at(cell)];
    const auto [p, q] = mesh::tet::edge_to_corner[at(edge)];
    numbering_.ends.push_back({nodes[at(p)], nodes[at(q)]});
    return narrow<LocalId>(static_cast<std::int64_t>(mesh_.n_nodes()) +
                           static_cast<std::int64_t>(numbering_.ends.size()) - 1);
  }
  /// Gives the node to all cells of the arc, whose patches are added; `lowest` becomes the first of them.
  void give(LocalId node, mesh::CellEdge arc, mesh::CellEdge& lowest, EdgePatches& patches) {
    lowest = arc;
    const auto ends = mesh::walk_ring(mesh_, arc.cell, arc.edge, [&](LocalId c, int e) {
      set(node, c, e);
      if (c < lowest.cell) lowest = {c, e};
      if (has_surfaces_inside_) add_inside(c, e, patches);
    });
    if (ends.is_closed) return;
    patches.add(ends.first);
    patches.add(ends.second);
  }
  void note_boundary(LocalId node, const EdgePatches& patches) {
    if (patches.is_complete()) numbering_.boundary.push_back({node - mesh_.n_nodes(), patches.all()});
  }

  /// Nodes of marked edges inside this rank's part, by ascending lowest cell.
  void make_inner(Counts& counts) {
    constexpr LocalId ahead = 16;
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
      if (c + ahead < mesh_.n_cells() && closure_.marks[at(c + ahead)] != 0) prefetch_behind(c + ahead);
      for (unsigned marks = closure_.marks[at(c)]; marks != 0; marks &= marks - 1) {
        const int e = std::countr_zero(marks);
        if (numbering_.midpoint(c, e) != invalid_local) continue;
        const auto node = make(c, e);
        ++counts.nodes[at(c)];
        EdgePatches patches;
        if (has_surfaces_inside_) {
          mesh::CellEdge lowest;
          give(node, {c, e}, lowest, patches);
        } else {
          const auto ends = mesh::walk_ring(mesh_, c, e, [&](LocalId cell, int edge) { set(node, cell, edge); });
          if (ends.is_closed) continue;
          patches.add(ends.first);
          patches.add(ends.second);
        }
        note_boundary(node, patches);
      }
    }
  }

 private:
  void set(LocalId node, LocalId cell, int edge) {
    numbering_.edge_to_node[at(numbering_.row[at(cell)])][at(edge)] = node;
  }
  /// Those with a surface of the two faces of a cell at an edge.
  void add_inside(LocalId cell, int edge, EdgePatches& patches) const {
    if (inner_.word(cell) == 0) return;
    for (const int slot : mesh::tet::edge_to_corner[at(mesh::tet::opposite_edge(edge))])
      if (const int patch = inner_.of({cell, slot}); patch >= 0 && mesh_.info.patches[at(patch)].surface >= 0)
        patches.add_inside(patch);
  }
  /// The cells at the faces, which walks from there come to first.
  void prefetch_behind(LocalId cell) const {
    for (const auto slot : mesh_.cell_to_cell[at(cell)]) {
      const auto next = at(mesh_.is_own(slot) ? slot : cell);
      prefetch(&mesh_.cell_to_node[next]);
      prefetch(&mesh_.cell_to_cell[next]);
      prefetch(&numbering_.row[next]);
    }
  }

  const mesh::DistMesh& mesh_;
  const Closure& closure_;
  Numbering& numbering_;
  mesh::InnerPatches inner_;
  bool has_surfaces_inside_ = false;
};

bool is_marked(const Closure& closure, const mesh::Borders& borders, std::size_t edge) {
  const auto arc = borders.arcs(edge).front();
  return (closure.marks[at(arc.cell)] >> arc.edge & 1) != 0;
}

/// The part of the pattern of border edges that is marked.
par::Pattern marked_edges(const mesh::Borders& borders, const Closure& closure) {
  const auto& edge = borders.edges.item;
  return par::restricted(
      borders.edges, [&](std::size_t k) { return is_marked(closure, borders, at(edge[k])) ? edge[k] : invalid_local; });
}

/// Nodes of marked border edges. Returns what is known of every border edge on all its ranks; entry i of `node` is the
/// local id of its node.
std::vector<SharedEdge> make_shared(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                    const par::Pattern& marked, const Closure& closure, NodeMaker& maker,
                                    std::vector<LocalId>& node) {
  std::vector<SharedEdge> shared(borders.n_edges());
  node.assign(borders.n_edges(), invalid_local);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (!is_marked(closure, borders, i)) continue;
    node[i] = maker.make(borders.arcs(i).front().cell, borders.arcs(i).front().edge);
    for (const auto arc : borders.arcs(i)) {
      mesh::CellEdge lowest;
      maker.give(node[i], arc, lowest, shared[i].patches);
      const auto global = mesh.cell_global[at(lowest.cell)];
      if (global < shared[i].lowest) {
        shared[i].lowest = global;
        shared[i].edge = lowest.edge;
      }
    }
  }
  par::fold_shared(par::Exchange(comm, marked), shared, [](SharedEdge& mine, const SharedEdge& theirs) {
    if (theirs.lowest < mine.lowest) {
      mine.lowest = theirs.lowest;
      mine.edge = theirs.edge;
    }
    mine.patches.merge(theirs.patches);
  });
  for (std::size_t i = 0; i < shared.size(); ++i)
    if (node[i] != invalid_local) maker.note_boundary(node[i], shared[i].patches);
  return shared;
}

LocalId find_cell(const mesh::DistMesh& mesh, GlobalId global) {
  const auto& ids = mesh.cell_global;
  if (!ids.empty() && ids.back() - ids.front() + 1 == std::ssize(ids))  // a run of numbers
    return global >= ids.front() && global <= ids.back() ? static_cast<LocalId>(global - ids.front()) : invalid_local;
  const auto found = std::lower_bound(mesh.cell_global.begin(), mesh.cell_global.end(), global);
  return found != mesh.cell_global.end() && *found == global ? static_cast<LocalId>(found - mesh.cell_global.begin())
                                                             : invalid_local;
}

void number_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const par::Pattern& marked, const Closure& closure,
                  const std::vector<SharedEdge>& shared, const std::vector<LocalId>& shared_node,
                  const std::vector<GlobalId>& offset, Numbering& numbering) {
  const auto n_old = mesh.n_nodes();
  auto& global = numbering.node_global;
  assign_array(global, numbering.n_new_nodes(), invalid_global);
  // border nodes of which another cell, maybe elsewhere, is the lowest, wait for that cell
  std::vector<mesh::CellFace> owner_of;  // lowest cell and edge of each border node, by new node
  const auto n_shared =
      at(std::count_if(shared_node.begin(), shared_node.end(), [](LocalId n) { return n != invalid_local; }));
  owner_of.resize(n_shared);
  for (std::size_t i = 0; i < shared.size(); ++i)
    if (shared_node[i] != invalid_local)
      owner_of[at(shared_node[i] - n_old)] = {find_cell(mesh, shared[i].lowest), shared[i].edge};
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    GlobalId next = offset[at(c)];
    for (unsigned marks = closure.marks[at(c)]; marks != 0; marks &= marks - 1) {
      const int e = std::countr_zero(marks);
      const auto node = at(numbering.midpoint(c, e) - n_old);
      if (global[node] != invalid_global) continue;
      if (node < n_shared && !(owner_of[node].cell == c && owner_of[node].slot == e)) continue;
      global[node] = next++;
    }
  }
  const auto number_of = [&](LocalId edge) -> GlobalId& { return global[at(shared_node[at(edge)] - n_old)]; };
  par::fold_shared(par::Exchange(comm, marked), number_of, [&](LocalId edge, GlobalId theirs) {
    if (theirs != invalid_global) number_of(edge) = theirs;
  });
}

}  // namespace

Numbering number(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                 const Closure& closure) {
  Numbering numbering;
  numbering.n_old_nodes = mesh.n_nodes();
  make_rows(closure, numbering);
  Counts counts{std::vector<std::uint8_t>(closure.marks.size(), 0), {}};

  NodeMaker maker(mesh, closure, numbering);
  std::vector<LocalId> shared_node;
  const auto marked = marked_edges(borders, closure);
  const auto shared = make_shared(comm, mesh, borders, marked, closure, maker, shared_node);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const auto lowest = shared_node[i] == invalid_local ? invalid_local : find_cell(mesh, shared[i].lowest);
    if (lowest != invalid_local) ++counts.nodes[at(lowest)];
  }
  maker.make_inner(counts);
  std::sort(numbering.boundary.begin(), numbering.boundary.end(),
            [](const BoundaryNode& a, const BoundaryNode& b) { return a.new_node < b.new_node; });
  counts.cells = count_children(closure);
  mesh::require_local_size(comm, std::accumulate(counts.cells.begin(), counts.cells.end(), std::int64_t{0}),
                           "refined mesh");

  const bool in_runs = !mesh::cell_runs(comm, mesh).empty();  // then one exclusive sum does
  const auto node_offset = mesh::cell_offsets(comm, mesh, in_runs, counts.nodes, mesh.info.node_ids().end());
  number_nodes(comm, mesh, marked, closure, shared, shared_node, node_offset, numbering);
  numbering.first_child_global = mesh::cell_offsets(comm, mesh, in_runs, counts.cells, mesh.info.first_id);

  std::int64_t n_nodes = 0, n_cells = 0;
  reserve_array(numbering.first_child, counts.cells.size() + 1);
  for (std::size_t c = 0; c < counts.cells.size(); ++c) {
    numbering.first_child.push_back(narrow<LocalId>(n_cells));
    n_cells += counts.cells[c];
    n_nodes += counts.nodes[c];
  }
  numbering.first_child.push_back(narrow<LocalId>(n_cells));
  numbering.n_global_nodes = mesh.info.n_global_nodes + comm.sum(n_nodes);
  numbering.n_global_cells = comm.sum(n_cells);
  return numbering;
}

}  // namespace pamr::refine
