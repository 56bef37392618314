// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate_shared.hpp"

#include <bit>
#include <tuple>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"
#include "pamr/validate/validate_cells.hpp"

namespace pamr::validate {

namespace {

/// Cell numbers `begin .. end` of one rank.
struct Run {
  GlobalId begin = 0;
  GlobalId end = 0;
};

std::vector<Run> find_runs(const std::vector<GlobalId>& ids) {
  std::vector<Run> runs;
  for (const auto id : ids) {
    if (runs.empty() || runs.back().end != id) runs.push_back({id, id});
    ++runs.back().end;
  }
  return runs;
}

/// A node as one rank holds it; `local` is its number there.
struct NodeCard {
  GlobalId id = 0;
  std::uint64_t position = 0;
  std::int64_t local = 0;
};

std::uint64_t exact_hash(geometry::Vec3 p) {
  std::uint64_t h = 0;
  for (const auto x : {p.x, p.y, p.z}) h = combine(h, std::bit_cast<std::uint64_t>(x));
  return h;
}

std::vector<char> find_used_nodes(const mesh::DistMesh& mesh) {
  std::vector<char> is_used(mesh.node_global.size(), 0);
  for (const auto& nodes : mesh.cell_to_node)
    for (const auto node : nodes) is_used[static_cast<std::size_t>(node)] = 1;
  return is_used;
}

/// A card and the rank that it came from.
struct HeldNode {
  NodeCard card;
  Rank rank = 0;
};

/// The cards of a block of nodes by number, then by rank.
std::vector<HeldNode> by_number(const par::Received<NodeCard>& cards, const par::BlockRange& block) {
  std::vector<std::size_t> next(static_cast<std::size_t>(block.count()), 0);
  for (const auto& card : cards.item) ++next[static_cast<std::size_t>(card.id - block.begin)];
  std::size_t begin = 0;
  for (auto& entry : next) begin += std::exchange(entry, begin);
  std::vector<HeldNode> held(cards.item.size());
  for (std::size_t r = 0; r < cards.rank.size(); ++r)
    for (const auto& card : cards.from(r))
      held[next[static_cast<std::size_t>(card.id - block.begin)]++] = {card, cards.rank[r]};
  return held;
}

/// Compares what the ranks say of the nodes of this rank's block, and returns to each rank its local numbers of those
/// that others hold too.
par::Mailbox<std::int64_t> compare_nodes(const par::Comm& comm, const par::Received<NodeCard>& cards,
                                         const par::BlockRange& block, Findings& findings) {
  const auto held = by_number(cards, block);
  par::Mailbox<std::int64_t> shared(comm);
  GlobalId next = block.begin;
  const auto report_missing = [&](GlobalId until) {
    if (next < until) findings.add(Invariant::nodes_referenced, next, until - next);
  };
  for (std::size_t begin = 0, end = 0; begin < held.size(); begin = end) {
    const auto id = held[begin].card.id;
    report_missing(id);
    next = id + 1;
    for (; end < held.size() && held[end].card.id == id; ++end) {
      if (end > begin && held[end].rank == held[end - 1].rank) findings.add(Invariant::unique_nodes, id);
      if (held[end].card.position != held[begin].card.position) findings.add(Invariant::shared_nodes_equal, id);
    }
    for (auto i = begin; held[begin].rank != held[end - 1].rank && i < end; ++i)
      shared.add(held[i].rank, held[i].card.local);
  }
  report_missing(block.end);
  return shared;
}

/// Nodes of this rank, by local number, that other ranks hold too.
std::vector<char> check_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto all = mesh.info.node_ids();
  par::Mailbox<NodeCard> post(comm);
  const auto is_used = find_used_nodes(mesh);
  for (std::size_t i = 0; i < mesh.node_global.size(); ++i) {
    const auto id = mesh.node_global[i];
    if (is_used[i] == 0)
      findings.add(Invariant::nodes_referenced, id);
    else
      post.add(par::block_of(id, all, comm.size()),
               {id, exact_hash(mesh.node_position[i]), static_cast<std::int64_t>(i)});
  }
  const auto cards = post.send();
  const auto shared = compare_nodes(comm, cards, par::block_range(all, comm.rank(), comm.size()), findings).send();
  std::vector<char> is_shared(mesh.node_global.size(), 0);
  for (const auto local : shared.item) is_shared[static_cast<std::size_t>(local)] = 1;
  return is_shared;
}

/// Faces whose three nodes other ranks hold too, those between own cells from one of their two sides.
std::vector<mesh::CellFace> find_candidates(const mesh::DistMesh& mesh, const std::vector<char>& is_shared) {
  std::vector<mesh::CellFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(c)];
    const auto n_shared = std::count_if(nodes.begin(), nodes.end(),
                                        [&](LocalId n) { return is_shared[static_cast<std::size_t>(n)] != 0; });
    for (int f = 0; n_shared >= 3 && f < 4; ++f)
      if ((n_shared == 4 || is_shared[static_cast<std::size_t>(nodes[static_cast<std::size_t>(f)])] == 0) &&
          (slot_at(mesh, {c, f}) > c || slot_at(mesh, {c, f}) < 0))
        faces.push_back({c, f});
  }
  return faces;
}

/// The first rank-border face of those shared with higher ranks.
LocalId first_face_to_higher(const mesh::DistMesh& mesh, Rank rank) {
  const auto higher = std::upper_bound(mesh.border_rank.begin(), mesh.border_rank.end(), rank);
  return static_cast<LocalId>(mesh.border_offset[static_cast<std::size_t>(higher - mesh.border_rank.begin())]);
}

bool has_repeats(std::span<const std::uint64_t> names) {
  const auto shift = 63U - static_cast<unsigned>(std::bit_width(names.size() | 1U));
  std::vector<std::uint64_t> table;
  assign_array(table, std::size_t{1} << (64U - shift), std::uint64_t{0});  // 0: free
  bool has_zero = false;
  for (const auto name : names) {
    if (name == 0 && std::exchange(has_zero, true)) return true;
    if (name == 0) continue;
    auto place = static_cast<std::size_t>(name >> shift);
    for (; table[place] != 0; place = (place + 1) & (table.size() - 1))
      if (table[place] == name) return true;
    table[place] = name;
  }
  return false;
}

/// True when all the faces, those between two ranks named by the lower one alone, have different nodes. With
/// rank-border faces that match on both sides no face is then missed or met twice. By hashes of 64 bits: two that are
/// equal by chance only bring about the full search. `border_matches`: what this rank knows of it. Collective: one
/// sparse exchange of 8 bytes a face.
bool all_differ(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<mesh::CellFace>& faces,
                bool border_matches) {
  par::Mailbox<std::uint64_t> post(comm);
  const auto first_higher = mesh.n_cells() + first_face_to_higher(mesh, comm.rank());
  for (const auto face : faces) {
    const auto slot = slot_at(mesh, face);
    if (mesh.is_ghost(slot) && slot < first_higher) continue;
    const auto name = mesh::face_name(mesh, face);
    post.add(static_cast<Rank>((name & 0xffffffffU) * static_cast<std::uint64_t>(comm.size()) >> 32U), name);
  }
  const auto names = post.send().item;
  return !comm.any(!border_matches || has_repeats(names));
}

/// An edge of boundary faces: in how many, and the smallest cell there.
struct BoundaryEdge {
  GlobalId a = 0, b = 0;
  std::int64_t n_faces = 1;
  GlobalId cell = 0;
};

void merge_equal_edges(std::vector<BoundaryEdge>& edges) {
  std::sort(edges.begin(), edges.end(), [](const BoundaryEdge& x, const BoundaryEdge& y) {
    return std::tie(x.a, x.b, x.cell) < std::tie(y.a, y.b, y.cell);
  });
  std::size_t n = 0;
  for (const auto& edge : edges) {
    if (n > 0 && edges[n - 1].a == edge.a && edges[n - 1].b == edge.b)
      edges[n - 1].n_faces += edge.n_faces;
    else
      edges[n++] = edge;
  }
  edges.resize(n);
}

}  // namespace

void check_unique_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto all = mesh.info.cell_ids();
  par::Mailbox<Run> post(comm);
  for (const auto run : find_runs(mesh.cell_global))
    for (auto begin = run.begin; begin < run.end;) {
      const auto holder = par::block_of(begin, all, comm.size());
      const auto end = std::min(run.end, par::block_range(all, holder, comm.size()).end);
      post.add(holder, {begin, end});
      begin = end;
    }
  auto runs = post.send().item;
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  const auto block = par::block_range(all, comm.rank(), comm.size());
  auto next = block.begin;
  for (const auto run : runs) {
    if (run.begin > next) findings.add(Invariant::unique_cells, next, run.begin - next);
    if (run.begin < next) findings.add(Invariant::unique_cells, run.begin, std::min(next, run.end) - run.begin);
    next = std::max(next, run.end);
  }
  if (next < block.end) findings.add(Invariant::unique_cells, next, block.end - next);
}

void check_shared(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto is_shared = check_nodes(comm, mesh, findings);
  if (comm.size() == 1) return;
  const auto faces = find_candidates(mesh, is_shared);
  if (all_differ(comm, mesh, faces,
                 !findings.has(Invariant::border_matches) && !findings.has(Invariant::neighbors_reciprocal)))
    return;
  std::vector<par::SharedKey> key;
  key.reserve(faces.size());
  for (const auto face : faces) key.push_back(mesh::face_key(mesh, face));
  std::vector<int> n_others(faces.size(), 0);
  for (const auto item : par::find_shared(comm, key).item) ++n_others[static_cast<std::size_t>(item)];
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto face = faces[i];
    if (n_others[i] != (mesh.is_ghost(slot_at(mesh, face)) ? 1 : 0))
      findings.add(Invariant::conforming, number_of(mesh, face.cell));
  }
}

void check_boundary(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  std::vector<BoundaryEdge> edges;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      if (slot_at(mesh, {c, f}) >= 0) continue;
      const auto node = mesh::face_key(mesh, {c, f});
      const auto cell = mesh.cell_global[static_cast<std::size_t>(c)];
      edges.push_back({node[0], node[1], 1, cell});
      edges.push_back({node[0], node[2], 1, cell});
      edges.push_back({node[1], node[2], 1, cell});
    }
  merge_equal_edges(edges);
  par::Mailbox<BoundaryEdge> post(comm);
  for (const auto& edge : edges) {
    const auto hash = combine(static_cast<std::uint64_t>(edge.a), static_cast<std::uint64_t>(edge.b));
    post.add(static_cast<Rank>(hash % static_cast<std::uint64_t>(comm.size())), edge);
  }
  edges = post.send().item;
  merge_equal_edges(edges);
  for (const auto& edge : edges)
    if (edge.n_faces != 2) findings.add(Invariant::boundary_manifold, edge.cell);
}

}  // namespace pamr::validate
