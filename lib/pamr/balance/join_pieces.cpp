// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/join_pieces.hpp"

#include <algorithm>
#include <iterator>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/mesh/rank_border.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::balance {

namespace {

/// A cell where it lies.
struct Source {
  std::uint32_t piece = 0;
  LocalId cell = 0;
};

/// The cells of all pieces that are here from now on, in ascending global order.
std::vector<Source> merge_order(Rank here, const std::vector<Piece>& pieces) {
  const auto id = [&](Source s) { return pieces[s.piece].mesh.cell_global[at(s.cell)]; };
  const auto before = [&](Source a, Source b) { return id(a) < id(b); };
  std::vector<Source> stayed, arrived, order;
  for (std::uint32_t p = 0; p < pieces.size(); ++p)
    for (LocalId c = 0; c < pieces[p].mesh.n_cells(); ++c)
      if (pieces[p].is_on(here, c)) (p == 0 ? stayed : arrived).push_back({p, c});
  if (arrived.empty()) return stayed;
  std::sort(arrived.begin(), arrived.end(), before);
  order.reserve(stayed.size() + arrived.size());
  std::merge(stayed.begin(), stayed.end(), arrived.begin(), arrived.end(), std::back_inserter(order), before);
  return order;
}

/// Nodes that other pieces may hold too: those of faces that are not between two cells of the piece.
std::vector<std::uint8_t> find_outer_nodes(Rank here, const Piece& piece) {
  const auto& mesh = piece.mesh;
  std::vector<std::uint8_t> is_outer(at(mesh.n_nodes()), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (!piece.is_on(here, c)) continue;
    for (std::size_t f = 0; f < 4; ++f) {
      const auto next = mesh.cell_to_cell[at(c)][f];
      if (mesh.is_own(next) && piece.is_on(here, next)) continue;
      for (const auto corner : mesh::tet::face_to_corner[f]) is_outer[at(mesh.cell_to_node[at(c)][at(corner)])] = 1;
    }
  }
  return is_outer;
}

/// Numbers the nodes of the pieces in order of first use.
class NodeJoiner {
 public:
  NodeJoiner(Rank here, const std::vector<Piece>& pieces) : pieces_(pieces), map_(0, 0, 0) {
    GlobalId min = 0, max = 0;
    std::size_t n_outer = 0;
    for (const auto& piece : pieces) {
      to_new_.emplace_back(at(piece.mesh.n_nodes()), invalid_local);
      is_outer_.push_back(find_outer_nodes(here, piece));
      for (std::size_t n = 0; n < is_outer_.back().size(); ++n) {
        if (is_outer_.back()[n] == 0) continue;
        const auto id = piece.mesh.node_global[n];
        min = n_outer == 0 ? id : std::min(min, id);
        max = n_outer == 0 ? id : std::max(max, id);
        ++n_outer;
      }
    }
    map_ = mesh::IdMap(min, max, n_outer);
  }
  LocalId number(Source cell, LocalId node) {
    auto& here = to_new_[cell.piece][at(node)];
    if (here != invalid_local) return here;
    const auto next = static_cast<LocalId>(source_.size());
    here = is_outer_[cell.piece][at(node)] == 0
               ? next
               : map_.find_or_insert(pieces_[cell.piece].mesh.node_global[at(node)], next);
    if (here == next) source_.push_back({cell.piece, node});
    return here;
  }
  /// Where each new node is found first.
  const std::vector<Source>& sources() const { return source_; }

 private:
  const std::vector<Piece>& pieces_;
  mesh::IdMap map_;
  std::vector<std::vector<LocalId>> to_new_;
  std::vector<std::vector<std::uint8_t>> is_outer_;
  std::vector<Source> source_;
};

std::vector<RowRun> runs_of(const std::vector<Source>& order) {
  std::vector<RowRun> runs;
  for (const auto [piece, row] : order)
    if (!runs.empty() && runs.back().piece == piece && runs.back().first + runs.back().n == row)
      ++runs.back().n;
    else
      runs.push_back({piece, row, 1});
  return runs;
}

/// These rows of one array of every piece, which are freed.
template <class Array>
auto gather(std::vector<Piece>& pieces, const std::vector<RowRun>& runs, Array array) {
  std::remove_reference_t<decltype(array(pieces.front()))> all;
  std::vector<decltype(all.data())> from;
  for (auto& piece : pieces) from.push_back(array(piece).data());
  std::size_t n_rows = 0;
  for (const auto& run : runs) n_rows += at(run.n);
  reserve_array(all, n_rows);
  for (const auto& [piece, first, n] : runs) {
    const auto* values = from[piece] + first;
    if (n == 1)
      all.push_back(*values);
    else
      all.insert(all.end(), values, values + n);
  }
  for (auto& piece : pieces) free_array(array(piece));
  return all;
}

LocalId find_cell(const mesh::DistMesh& mesh, GlobalId global) {
  const auto found = std::lower_bound(mesh.cell_global.begin(), mesh.cell_global.end(), global);
  PAMR_ENSURES(found != mesh.cell_global.end() && *found == global);
  return static_cast<LocalId>(found - mesh.cell_global.begin());
}

/// A cell of the first piece that is on another rank from now on.
struct Gone {
  Rank rank = 0;
  GlobalId global = 0;
};

/// New local numbers of the cells of the pieces; of those that are gone -1 - their place in `gone`.
struct NewNumbers {
  std::vector<std::vector<LocalId>> of_cell;
  std::vector<Gone> gone;
};

NewNumbers find_new_numbers(Rank here, const std::vector<Piece>& pieces, const std::vector<Source>& order) {
  NewNumbers numbers;
  for (const auto& piece : pieces) numbers.of_cell.emplace_back(piece.mesh.cell_to_cell.size());
  for (std::size_t c = 0; c < order.size(); ++c)
    numbers.of_cell[order[c].piece][at(order[c].cell)] = static_cast<LocalId>(c);
  const auto& first = pieces.front();
  for (LocalId c = 0; c < std::ssize(first.mesh.cell_to_cell); ++c) {
    if (first.is_on(here, c)) continue;
    numbers.gone.push_back({first.destination[at(c)], first.mesh.cell_global[at(c)]});
    numbers.of_cell.front()[at(c)] = -static_cast<LocalId>(numbers.gone.size());
  }
  return numbers;
}

/// Neighbors of the joined mesh, which has its cells and nodes already. Returns the faces to other ranks.
std::vector<mesh::RemoteFace> join_neighbors(Rank here, const std::vector<Piece>& pieces, const NewNumbers& numbers,
                                             const std::vector<Source>& order, mesh::DistMesh& mesh) {
  std::vector<mesh::RemoteFace> border;
  reserve_array(mesh.cell_to_cell, order.size());
  for (const auto [p, cell] : order) {
    const auto& piece = pieces[p];
    const auto n_piece = static_cast<LocalId>(piece.mesh.cell_to_cell.size());
    auto& slots = mesh.cell_to_cell.emplace_back(piece.mesh.cell_to_cell[at(cell)]);
    for (int f = 0; f < 4; ++f) {
      auto& slot = slots[at(f)];
      if (slot < 0) continue;
      const mesh::CellFace face{static_cast<LocalId>(mesh.cell_to_cell.size() - 1), f};
      if (slot < n_piece) {
        slot = numbers.of_cell[p][at(slot)];
        if (slot >= 0) continue;
        const auto& gone = numbers.gone[at(-1 - slot)];
        border.push_back({face, gone.rank, gone.global});
        continue;
      }
      const auto ghost = at(slot - n_piece);
      const auto global = piece.mesh.ghost_global[ghost];
      if (piece.ghost_to[ghost] == here) {
        slot = find_cell(mesh, global);
        continue;
      }
      border.push_back({face, piece.ghost_to[ghost], global});
    }
  }
  return border;
}

}  // namespace

Joined join_pieces(Rank here, std::vector<Piece> pieces, std::vector<std::uint8_t>& cell_byte) {
  Joined joined;
  auto& [mesh, cells, nodes] = joined;
  const auto order = merge_order(here, pieces);
  narrow<LocalId>(order.size());
  {
    NodeJoiner joiner(here, pieces);
    reserve_array(mesh.cell_to_node, order.size());
    for (const auto cell : order) {
      auto& corners = mesh.cell_to_node.emplace_back(pieces[cell.piece].mesh.cell_to_node[at(cell.cell)]);
      for (auto& node : corners) node = joiner.number(cell, node);
    }
    for (auto& piece : pieces) free_array(piece.mesh.cell_to_node);
    nodes = runs_of(joiner.sources());
  }
  mesh.node_global = gather(
      pieces, nodes, [](Piece & p) -> auto& { return p.mesh.node_global; });
  mesh.node_position = gather(
      pieces, nodes, [](Piece & p) -> auto& { return p.mesh.node_position; });
  cells = runs_of(order);
  const auto numbers = find_new_numbers(here, pieces, order);
  mesh.cell_global = gather(
      pieces, cells, [](Piece & p) -> auto& { return p.mesh.cell_global; });
  mesh.lineage = gather(
      pieces, cells, [](Piece & p) -> auto& { return p.mesh.lineage; });
  if (std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return !p.mesh.cell_origin.empty(); }))
    mesh.cell_origin = gather(
        pieces, cells, [](Piece & p) -> auto& { return p.mesh.cell_origin; });
  cell_byte.clear();
  if (std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return !p.cell_byte.empty(); }))
    cell_byte = gather(
        pieces, cells, [](Piece & p) -> auto& { return p.cell_byte; });
  const auto border = join_neighbors(here, pieces, numbers, order, mesh);
  pieces = {};
  mesh::fill_border(here, mesh, border);
  return joined;
}

}  // namespace pamr::balance
