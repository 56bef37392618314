// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/piece.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"

namespace pamr::balance {

namespace {

struct Header {
  std::int64_t n_cells = 0, n_nodes = 0, n_ghosts = 0, n_cell_bytes = 0, n_origins = 0;
};

/// Calls `visit(array, n)` for every array of a piece and the number of values it has to have. The widest come first,
/// so that each lies well in the buffer.
template <class P, class Visit>
void for_each_array(P& piece, const Header& header, Visit visit) {
  auto& mesh = piece.mesh;
  const auto n_cells = at(header.n_cells), n_nodes = at(header.n_nodes), n_ghosts = at(header.n_ghosts);
  visit(mesh.cell_global, n_cells);
  visit(mesh.node_global, n_nodes);
  visit(mesh.node_position, n_nodes);
  visit(mesh.ghost_global, n_ghosts);
  visit(mesh.cell_origin, at(header.n_origins));
  visit(mesh.cell_to_node, n_cells);
  visit(mesh.cell_to_cell, n_cells);
  visit(mesh.lineage, n_cells);
  visit(piece.ghost_to, n_ghosts);
  visit(piece.cell_byte, at(header.n_cell_bytes));
}

}  // namespace

PieceCutter::PieceCutter(const mesh::DistMesh& mesh, std::span<const Rank> destination, std::span<const Rank> ghost_to,
                         std::span<const std::uint8_t> cell_byte)
    : mesh_(&mesh),
      destination_(destination),
      ghost_to_(ghost_to),
      cell_byte_(cell_byte),
      cell_to_piece_(at(mesh.n_cells()), invalid_local),
      node_to_piece_(at(mesh.n_nodes()), invalid_local) {}

void PieceCutter::cut_neighbors(std::span<const LocalId> cells, Piece& piece) {
  auto& out = piece.mesh;
  for (std::size_t i = 0; i < cells.size(); ++i) cell_to_piece_[at(cells[i])] = static_cast<LocalId>(i);
  const auto n = static_cast<LocalId>(cells.size());
  const auto add_ghost = [&](GlobalId global, Rank to) {
    out.ghost_global.push_back(global);
    piece.ghost_to.push_back(to);
    return narrow<LocalId>(n + static_cast<std::int64_t>(out.ghost_global.size()) - 1);
  };
  out.cell_to_cell.reserve(cells.size());
  for (const auto cell : cells) {
    auto& slots = out.cell_to_cell.emplace_back(mesh_->cell_to_cell[at(cell)]);
    for (auto& slot : slots) {
      if (slot < 0) continue;
      if (mesh_->is_ghost(slot)) {
        const auto k = at(slot - mesh_->n_cells());
        slot = add_ghost(mesh_->ghost_global[k], ghost_to_[k]);
      } else {
        const auto here = cell_to_piece_[at(slot)];
        slot = here != invalid_local ? here : add_ghost(mesh_->cell_global[at(slot)], destination_[at(slot)]);
      }
    }
  }
  for (const auto cell : cells) cell_to_piece_[at(cell)] = invalid_local;
}

void PieceCutter::cut_nodes(std::span<const LocalId> cells, Piece& piece, std::vector<LocalId>& nodes) {
  auto& out = piece.mesh;
  const auto first = nodes.size();
  out.cell_to_node.reserve(cells.size());
  for (const auto cell : cells) {
    auto& corners = out.cell_to_node.emplace_back(mesh_->cell_to_node[at(cell)]);
    for (auto& node : corners) {
      auto& here = node_to_piece_[at(node)];
      if (here == invalid_local) {
        here = static_cast<LocalId>(nodes.size() - first);
        nodes.push_back(node);
      }
      node = here;
    }
  }
  out.node_global.reserve(nodes.size() - first);
  out.node_position.reserve(nodes.size() - first);
  for (const auto node : std::span<const LocalId>(nodes).subspan(first)) {
    out.node_global.push_back(mesh_->node_global[at(node)]);
    out.node_position.push_back(mesh_->node_position[at(node)]);
    node_to_piece_[at(node)] = invalid_local;
  }
}

Piece PieceCutter::cut(std::span<const LocalId> cells, std::vector<LocalId>& nodes) {
  Piece piece;
  cut_neighbors(cells, piece);
  cut_nodes(cells, piece, nodes);
  auto& out = piece.mesh;
  out.cell_global.reserve(cells.size());
  out.lineage.reserve(cells.size());
  for (const auto cell : cells) {
    out.cell_global.push_back(mesh_->cell_global[at(cell)]);
    out.lineage.push_back(mesh_->lineage[at(cell)]);
    if (!mesh_->cell_origin.empty()) out.cell_origin.push_back(mesh_->cell_origin[at(cell)]);
    if (!cell_byte_.empty()) piece.cell_byte.push_back(cell_byte_[at(cell)]);
  }
  return piece;
}

std::vector<std::byte> pack(const Piece& piece) {
  const Header header{piece.mesh.n_cells(), piece.mesh.n_nodes(), std::ssize(piece.ghost_to),
                      std::ssize(piece.cell_byte), std::ssize(piece.mesh.cell_origin)};
  std::size_t size = sizeof header;
  for_each_array(piece, header, [&]<class T>(const std::vector<T>& values, std::size_t n) {
    PAMR_EXPECTS(values.size() == n);
    size += n * sizeof(T);
  });
  std::vector<std::byte> bytes(size);
  auto* to = bytes.data();
  const auto append = [&](const void* from, std::size_t n) {
    if (n > 0) std::memcpy(to, from, n);
    to += n;
  };
  append(&header, sizeof header);
  for_each_array(piece, header,
                 [&]<class T>(const std::vector<T>& values, std::size_t n) { append(values.data(), n * sizeof(T)); });
  return bytes;
}

Piece unpack(std::span<const std::byte> bytes) {
  Piece piece;
  const auto* from = bytes.data();
  const auto take = [&](void* to, std::size_t n) {
    PAMR_EXPECTS(n <= at(bytes.data() + bytes.size() - from));
    if (n > 0) std::memcpy(to, from, n);
    from += n;
  };
  Header header;
  take(&header, sizeof header);
  for_each_array(piece, header, [&]<class T>(std::vector<T>& values, std::size_t n) {
    values.resize(n);
    take(values.data(), n * sizeof(T));
  });
  return piece;
}

}  // namespace pamr::balance
