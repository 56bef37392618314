// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/join_pieces.hpp"

#include <algorithm>
#include <numeric>

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

void add_row(std::vector<RowRun>& runs, std::uint32_t piece, LocalId row) {
  if (!runs.empty() && runs.back().piece == piece && runs.back().first + runs.back().n == row)
    ++runs.back().n;
  else
    runs.push_back({piece, row, 1});
}

/// The cells of all pieces that are here from now on, in ascending global order.
std::vector<RowRun> merge_order(Rank here, const std::vector<Piece>& pieces) {
  const auto id = [&](Source s) { return pieces[s.piece].mesh.cell_global[at(s.cell)]; };
  std::vector<Source> arrived;
  for (std::uint32_t p = 1; p < pieces.size(); ++p)
    for (LocalId c = 0; c < pieces[p].mesh.n_cells(); ++c) arrived.push_back({p, c});
  std::sort(arrived.begin(), arrived.end(), [&](Source a, Source b) { return id(a) < id(b); });
  std::vector<RowRun> order;
  auto next = arrived.begin();
  for (LocalId c = 0; c < pieces.front().mesh.n_cells(); ++c) {
    if (!pieces.front().is_on(here, c)) continue;
    for (; next != arrived.end() && id(*next) < id({0, c}); ++next) add_row(order, next->piece, next->cell);
    add_row(order, 0, c);
  }
  for (; next != arrived.end(); ++next) add_row(order, next->piece, next->cell);
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
      assign_array(to_new_.emplace_back(), at(piece.mesh.n_nodes()), invalid_local);
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
  LocalId number(std::uint32_t piece, LocalId node) {
    auto& here = to_new_[piece][at(node)];
    if (here != invalid_local) return here;
    here = is_outer_[piece][at(node)] == 0 ? n_ : map_.find_or_insert(pieces_[piece].mesh.node_global[at(node)], n_);
    if (here == n_) {
      add_row(source_, piece, node);
      ++n_;
    }
    return here;
  }
  /// Where each new node is found first.
  std::vector<RowRun> take_sources() { return std::move(source_); }

 private:
  const std::vector<Piece>& pieces_;
  mesh::IdMap map_;
  std::vector<std::vector<LocalId>> to_new_;
  std::vector<std::vector<std::uint8_t>> is_outer_;
  std::vector<RowRun> source_;
  LocalId n_ = 0;
};

/// These rows of one array of every piece, which are freed.
template <class Array>
auto gather(std::vector<Piece>& pieces, const std::vector<RowRun>& runs, Array array) {
  std::remove_reference_t<decltype(array(pieces.front()))> all;
  std::vector<decltype(all.data())> from;
  for (auto& piece : pieces) from.push_back(array(piece).data());
  reserve_array(all, count_rows(runs));
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

NewNumbers find_new_numbers(Rank here, const std::vector<Piece>& pieces, const std::vector<RowRun>& order) {
  NewNumbers numbers;
  for (const auto& piece : pieces) assign_array(numbers.of_cell.emplace_back(), piece.mesh.cell_to_cell.size(), 0);
  LocalId next = 0;
  for (const auto& [piece, first, n] : order) {
    const auto begin = numbers.of_cell[piece].begin() + first;
    std::iota(begin, begin + n, next);
    next += n;
  }
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
                                             const std::vector<RowRun>& order, mesh::DistMesh& mesh) {
  std::vector<mesh::RemoteFace> border;
  reserve_array(mesh.cell_to_cell, mesh.cell_global.size());
  for (const auto& run : order) {
    const auto& piece = pieces[run.piece];
    const auto& new_number = numbers.of_cell[run.piece];
    const auto n_piece = static_cast<LocalId>(piece.mesh.cell_to_cell.size());
    const auto end = run.first + run.n;
    const auto shift = static_cast<LocalId>(mesh.cell_to_cell.size()) - run.first;
    for (auto cell = run.first; cell < end; ++cell) {
      auto slots = piece.mesh.cell_to_cell[at(cell)];
      for (int f = 0; f < 4; ++f) {
        auto& slot = slots[at(f)];
        if (slot < 0) continue;
        if (slot >= run.first && slot < end) {
          slot += shift;
          continue;
        }
        const mesh::CellFace face{static_cast<LocalId>(mesh.cell_to_cell.size()), f};
        if (slot < n_piece) {
          slot = new_number[at(slot)];
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
      mesh.cell_to_cell.push_back(slots);
    }
  }
  return border;
}

}  // namespace

std::size_t count_rows(std::span<const RowRun> runs) {
  std::size_t n = 0;
  for (const auto& run : runs) n += at(run.n);
  return n;
}

Joined join_pieces(Rank here, std::vector<Piece> pieces, std::vector<std::uint8_t>& cell_byte) {
  Joined joined;
  auto& [mesh, cells, nodes] = joined;
  cells = merge_order(here, pieces);
  const auto n_cells = count_rows(cells);
  narrow<LocalId>(n_cells);
  {
    NodeJoiner joiner(here, pieces);
    reserve_array(mesh.cell_to_node, n_cells);
    for (const auto& [piece, first, n] : cells)
      for (auto c = first; c < first + n; ++c) {
        auto corners = pieces[piece].mesh.cell_to_node[at(c)];
        for (auto& node : corners) node = joiner.number(piece, node);
        mesh.cell_to_node.push_back(corners);
      }
    for (auto& piece : pieces) free_array(piece.mesh.cell_to_node);
    nodes = joiner.take_sources();
  }
  mesh.node_global = gather(
      pieces, nodes, [](Piece & p) -> auto& { return p.mesh.node_global; });
  mesh.node_position = gather(
      pieces, nodes, [](Piece & p) -> auto& { return p.mesh.node_position; });
  const auto numbers = find_new_numbers(here, pieces, cells);
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
  const auto border = join_neighbors(here, pieces, numbers, cells, mesh);
  pieces = {};
  mesh::fill_border(here, mesh, border);
  return joined;
}

}  // namespace pamr::balance
