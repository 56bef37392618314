// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/borders.hpp"

#include <algorithm>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/base/insertion_sort.hpp"
#include "pamr/mesh/ring.hpp"

namespace pamr::mesh {

namespace {

constexpr std::uint8_t outer = 1, boundary = 2;

/// Of each node: whether it is one of a rank-border or boundary face (`outer`), and of the latter (`boundary`).
std::vector<std::uint8_t> places_of_nodes(const DistMesh& mesh) {
  std::vector<std::uint8_t> place(mesh.node_global.size(), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[at(c)][at(f)];
      if (mesh.is_own(slot)) continue;
      for (const auto corner : tet::face_to_corner[at(f)])
        place[at(mesh.cell_to_node[at(c)][at(corner)])] |= slot < 0 ? outer | boundary : outer;
    }
  return place;
}

/// Items put together by a number from 0 on: those of number `n` are `item[begin[n] .. begin[n + 1])`, in the order in
/// which they came.
template <class Item>
struct Buckets {
  std::vector<std::size_t> begin;
  std::vector<Item> item;

  std::span<Item> of(std::size_t n) { return std::span(item).subspan(begin[n], begin[n + 1] - begin[n]); }
  std::span<const Item> of(std::size_t n) const { return std::span(item).subspan(begin[n], begin[n + 1] - begin[n]); }
};

/// `for_each(put)` calls `put(number, item)` for all items, twice the same.
template <class Item, class ForEach>
Buckets<Item> deal(std::size_t n_buckets, ForEach&& for_each) {
  Buckets<Item> buckets;
  buckets.begin.assign(n_buckets + 2, 0);  // while they are filled, `begin[n + 1]` is where the next of `n` goes
  for_each([&](std::size_t n, const Item&) { ++buckets.begin[n + 2]; });
  for (std::size_t n = 2; n < buckets.begin.size(); ++n) buckets.begin[n] += buckets.begin[n - 1];
  buckets.item.resize(buckets.begin.back());
  for_each([&](std::size_t n, const Item& item) { buckets.item[buckets.begin[n + 1]++] = item; });
  buckets.begin.pop_back();
  return buckets;
}

/// An edge of a rank-border face: where an arc of cells around it ends. Kept by the smaller of its nodes.
struct ArcEnd {
  LocalId other = 0;  ///< the larger node
  LocalId face = 0;   ///< rank-border face
  CellEdge edge;
};

Buckets<ArcEnd> find_ends(const DistMesh& mesh) {
  return deal<ArcEnd>(at(mesh.n_nodes()), [&](auto&& put) {
    for (std::size_t k = 0; k < mesh.border_face.size(); ++k) {
      const auto face = mesh.border_face[k];
      const auto& nodes = mesh.cell_to_node[at(face.cell)];
      const auto& corner = tet::face_to_corner[at(face.slot)];
      for (std::size_t i = 0; i < 3; ++i) {
        const auto p = corner[i], q = corner[(i + 1) % 3];
        const auto a = nodes[at(p)], b = nodes[at(q)];
        put(at(std::min(a, b)),
            ArcEnd{std::max(a, b), static_cast<LocalId>(k), {face.cell, tet::edge_of[at(p)][at(q)]}});
      }
    }
  });
}

/// The border edges of this rank: `ends[i]` are their nodes, the smaller one first.
struct Edges {
  std::vector<std::array<LocalId, 2>> ends;
  std::vector<std::size_t> arc_offset{0};
  std::vector<CellEdge> arc;
};

/// One cell of each arc of an edge, of which `ends` are all ends at a rank border. Two of them belong to one arc when
/// no arc ends at the boundary; else arcs are walked from end to end.
void add_arcs(const DistMesh& mesh, std::span<const ArcEnd> ends, bool may_end_at_boundary, Edges& edges) {
  if (ends.size() == 2 && !may_end_at_boundary) {
    edges.arc.push_back(ends[0].edge);
    return;
  }
  const auto first = edges.arc.size();
  std::vector<LocalId> seen;
  for (const auto& end : ends) {
    if (std::find(seen.begin(), seen.end(), mesh.n_cells() + end.face) != seen.end()) continue;
    const auto stops = walk_ring(mesh, end.edge.cell, end.edge.edge, [](LocalId, int) {});
    seen.insert(seen.end(), {stops.first, stops.second});
    edges.arc.push_back(end.edge);
  }
  std::sort(edges.arc.begin() + static_cast<std::ptrdiff_t>(first), edges.arc.end(),
            [](const CellEdge& x, const CellEdge& y) { return x.cell < y.cell; });
}

Edges find_edges(const DistMesh& mesh, std::span<const std::uint8_t> place) {
  Edges edges;
  auto ends = find_ends(mesh);
  edges.ends.reserve(ends.item.size() / 2);
  edges.arc.reserve(ends.item.size() / 2);
  edges.arc_offset.reserve(ends.item.size() / 2 + 1);
  for (LocalId node = 0; node < mesh.n_nodes(); ++node) {
    const auto at_node = ends.of(at(node));
    insertion_sort(at_node, [](const ArcEnd& x, const ArcEnd& y) { return x.other < y.other; });
    for (std::size_t begin = 0, end = 0; begin < at_node.size(); begin = end) {
      const auto other = at_node[begin].other;
      while (end < at_node.size() && at_node[end].other == other) ++end;
      add_arcs(mesh, at_node.subspan(begin, end - begin), (place[at(node)] & place[at(other)] & boundary) != 0, edges);
      edges.ends.push_back({node, other});
      edges.arc_offset.push_back(edges.arc.size());
    }
  }
  return edges;
}

/// A slot of the pattern of nodes and the neighbor that it belongs to, both counted from 0.
struct SharedNode {
  std::uint32_t neighbor = 0;
  std::uint32_t slot = 0;
};

/// An edge of this rank whose two nodes a neighbor has too, in slots of that neighbor's; kept by the smaller slot.
struct Candidate {
  std::uint32_t larger_slot = 0;
  LocalId edge = 0;
};

/// Calls `put(smaller slot, candidate)` for every edge and every neighbor that has both nodes.
template <class Put>
void for_each_candidate(const Edges& edges, const Buckets<SharedNode>& shared, Put&& put) {
  for (std::size_t i = 0; i < edges.ends.size(); ++i) {
    const auto a = shared.of(at(edges.ends[i][0])), b = shared.of(at(edges.ends[i][1]));
    for (std::size_t k = 0, l = 0; k < a.size() && l < b.size();) {
      if (a[k].neighbor == b[l].neighbor)
        put(at(std::min(a[k].slot, b[l].slot)), Candidate{std::max(a[k].slot, b[l].slot), static_cast<LocalId>(i)});
      const bool next_a = a[k].neighbor <= b[l].neighbor, next_b = b[l].neighbor <= a[k].neighbor;
      k += next_a ? 1 : 0;
      l += next_b ? 1 : 0;
    }
  }
}

/// Which edges others have too. Two ranks that have an edge share its nodes, and know them by the same slots: each
/// tells the other the pairs of slots that are edges, in order, and both keep what they have in common.
par::Pattern share_edges(const par::Comm& comm, const DistMesh& mesh, const Edges& edges, const par::Pattern& nodes) {
  const auto shared = deal<SharedNode>(at(mesh.n_nodes()), [&](auto&& put) {
    for (std::uint32_t i = 0; i < nodes.rank.size(); ++i)
      for (auto k = nodes.offset[i]; k < nodes.offset[i + 1]; ++k)
        put(at(nodes.item[k]), SharedNode{i, static_cast<std::uint32_t>(k)});
  });
  auto candidates = deal<Candidate>(nodes.n_slots(), [&](auto&& put) { for_each_candidate(edges, shared, put); });
  for (std::size_t slot = 0; slot < nodes.n_slots(); ++slot)
    insertion_sort(candidates.of(slot),
                   [](const Candidate& x, const Candidate& y) { return x.larger_slot < y.larger_slot; });

  using Word = std::uint64_t;  // both slots, counted from the neighbor's first
  std::vector<par::Outgoing<Word>> messages;
  for (std::size_t i = 0; i < nodes.rank.size(); ++i) {
    const auto first = nodes.offset[i];
    auto& words = messages.emplace_back(par::Outgoing<Word>{nodes.rank[i], {}}).item;
    words.reserve(candidates.begin[nodes.offset[i + 1]] - candidates.begin[first]);
    for (auto slot = first; slot < nodes.offset[i + 1]; ++slot)
      for (const auto& candidate : candidates.of(slot))
        words.push_back(static_cast<Word>(slot - first) << 32U | (candidate.larger_slot - first));
  }
  const auto arrived = comm.sparse_exchange(messages);

  par::Pattern pattern;
  for (std::size_t r = 0, i = 0; r < arrived.rank.size(); ++r) {
    while (nodes.rank[i] != arrived.rank[r]) ++i;
    const auto& mine = messages[i].item;
    const auto theirs = arrived.from(r);
    const auto first = candidates.begin[nodes.offset[i]];
    for (std::size_t k = 0, l = 0; k < mine.size() && l < theirs.size();) {
      if (mine[k] == theirs[l]) pattern.item.push_back(candidates.item[first + k].edge);
      const bool next_mine = mine[k] <= theirs[l], next_theirs = theirs[l] <= mine[k];
      k += next_mine ? 1 : 0;
      l += next_theirs ? 1 : 0;
    }
    if (pattern.item.size() == pattern.offset.back()) continue;
    pattern.rank.push_back(nodes.rank[i]);
    pattern.offset.push_back(pattern.item.size());
  }
  return pattern;
}

par::Pattern share_nodes(const par::Comm& comm, const DistMesh& mesh, std::span<const std::uint8_t> place) {
  std::vector<LocalId> node;
  std::vector<par::SharedKey> key;
  for (LocalId n = 0; n < mesh.n_nodes(); ++n)
    if (place[at(n)] != 0) {
      node.push_back(n);
      key.push_back({mesh.node_global[at(n)], -1, -1});
    }
  auto pattern = par::find_shared(comm, key);
  for (auto& item : pattern.item) item = node[at(item)];
  return pattern;
}

}  // namespace

Borders find_borders(const par::Comm& comm, const DistMesh& mesh) {
  Borders borders;
  if (comm.size() == 1) return borders;
  const auto place = places_of_nodes(mesh);
  borders.nodes = share_nodes(comm, mesh, place);
  auto edges = find_edges(mesh, place);
  borders.edges = share_edges(comm, mesh, edges, borders.nodes);
  borders.arc_offset = std::move(edges.arc_offset);
  borders.arc = std::move(edges.arc);

  borders.faces.rank = mesh.border_rank;
  borders.faces.offset = mesh.border_offset;
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k) borders.faces.item.push_back(static_cast<LocalId>(k));
  return borders;
}

}  // namespace pamr::mesh
