// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/migrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "pamr/balance/join_pieces.hpp"
#include "pamr/balance/move_fields.hpp"
#include "pamr/balance/piece.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/ghost_values.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/rank_border.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::balance {

namespace {

/// Bytes of a cell in a message, without fields: corners, neighbors, number, lineage and its share of the nodes.
constexpr std::size_t bytes_of_cell = 64;

/// Cells that a rank sends at once, the same on every rank: an eighth of an even share, so that messages are small
/// beside the mesh, within limits.
std::size_t cells_of_round(const par::Comm& comm, const mesh::DistMesh& mesh) {
  constexpr GlobalId least = 128, most = GlobalId{1} << 18U;
  return at(std::clamp(mesh.info.n_global_cells / (GlobalId{8} * comm.size()), least, most));
}

void check_destinations(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const Rank> destination,
                        const std::vector<std::uint8_t>* cell_byte) {
  par::agree(comm, [&] {
    const auto require_length = [&](std::size_t n, const char* what) {
      if (n != at(mesh.n_cells()))
        throw Error(fmt::format("migrate: expected one {} for each of the {} cells of rank {}, found {}", what,
                                mesh.n_cells(), comm.rank(), n));
    };
    require_length(destination.size(), "destination");
    if (cell_byte != nullptr) require_length(cell_byte->size(), "byte");
    for (std::size_t c = 0; c < destination.size(); ++c) {
      if (destination[c] < 0 || destination[c] >= comm.size())
        throw Error(fmt::format("migrate: expected a rank below {}, found {} for cell {}", comm.size(), destination[c],
                                mesh.cell_global[c]));
      const auto lineage = mesh.lineage[c];
      if (lineage.is_removable() && destination[c] != destination[c - at(lineage.child())])
        throw Error(fmt::format(
            "migrate: expected the cells of a closure family to go to one rank, found ranks {} and {} for the family "
            "of cell {}",
            destination[c - at(lineage.child())], destination[c], mesh.cell_global[c]));
    }
  });
}

/// Cells and nodes that go from rank to rank; the rows of their fields follow them.
struct Moves {
  RowMoves cells, nodes;
};

/// Sends the departing cells, grouped by target, round after round. Returns the rows that were sent and received, and
/// adds the pieces that arrive.
Moves exchange_pieces(const par::Comm& comm, std::span<const Rank> destination, PieceCutter& cutter,
                      std::vector<LocalId> departing, std::size_t cells_at_once, std::vector<Piece>& pieces) {
  std::stable_sort(departing.begin(), departing.end(),
                   [&](LocalId a, LocalId b) { return destination[at(a)] < destination[at(b)]; });
  Moves moves;
  par::in_rounds(comm, departing.size(), cells_at_once, [&](std::size_t begin, std::size_t end) {
    std::vector<par::Outgoing<std::byte>> messages;
    while (begin < end) {
      const auto to = destination[at(departing[begin])];
      auto last = begin;
      while (last < end && destination[at(departing[last])] == to) ++last;
      const auto cells = std::span<const LocalId>(departing).subspan(begin, last - begin);
      messages.push_back({to, pack(cutter.cut(cells, moves.nodes.sent))});
      moves.cells.to.resize(last, to);
      moves.nodes.to.resize(moves.nodes.sent.size(), to);
      begin = last;
    }
    const auto arrived = comm.sparse_exchange(messages);
    for (std::size_t r = 0; r < arrived.rank.size(); ++r) {
      const auto& piece = pieces.emplace_back(unpack(arrived.from(r)));
      moves.cells.arrived.push_back({arrived.rank[r], piece.mesh.n_cells()});
      moves.nodes.arrived.push_back({arrived.rank[r], piece.mesh.n_nodes()});
    }
  });
  moves.cells.sent = std::move(departing);
  return moves;
}

/// Cells beyond the border are on other ranks now; the rank's own are what they were. The border gets the order in
/// which ranks with other cells have it.
void renew_border(Rank here, std::span<const Rank> ghost_to, mesh::DistMesh& mesh) {
  std::vector<mesh::RemoteFace> border;
  border.reserve(ghost_to.size());
  for (std::size_t k = 0; k < ghost_to.size(); ++k)
    border.push_back({mesh.border_face[k], ghost_to[k], mesh.ghost_global[k]});
  mesh.border_rank.clear();
  mesh.border_offset = {0};
  mesh.border_face.clear();
  mesh.ghost_global.clear();
  mesh::fill_border(here, mesh, border);
}

/// The cells and nodes of this rank in the mesh whose cells have moved.
mesh::DistMesh join(Rank here, mesh::DistMesh mesh, std::vector<Piece> pieces, std::vector<std::uint8_t>* cell_byte,
                    Moves& moves) {
  auto info = std::move(mesh.info);
  auto& own = pieces.front();
  own.mesh = std::move(mesh);
  if (cell_byte != nullptr) own.cell_byte = std::move(*cell_byte);
  std::vector<std::uint8_t> bytes;
  auto joined = join_pieces(here, std::move(pieces), bytes);
  joined.mesh.info = std::move(info);
  if (cell_byte != nullptr) *cell_byte = std::move(bytes);
  moves.cells.result = std::move(joined.cells);
  moves.nodes.result = std::move(joined.nodes);
  return std::move(joined.mesh);
}

mesh::DistMesh move_cells(const par::Comm& comm, mesh::DistMesh mesh, std::span<const Rank> destination,
                          std::vector<std::uint8_t>* cell_byte) {
  check_destinations(comm, mesh, destination, cell_byte);
  std::vector<LocalId> departing;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (destination[at(c)] != comm.rank()) departing.push_back(c);
  const bool none_departs = departing.empty();
  if (!comm.any(!none_departs)) return mesh;

  auto cell_fields = std::exchange(mesh.cell_fields, {}), node_fields = std::exchange(mesh.node_fields, {});
  const auto cells_at_once = cells_of_round(comm, mesh);
  std::vector<Piece> pieces(1);
  auto ghost_to = mesh::ghost_values(comm, mesh, destination);
  auto moves = [&] {
    PieceCutter cutter(
        mesh, destination, ghost_to,
        cell_byte != nullptr ? std::span<const std::uint8_t>(*cell_byte) : std::span<const std::uint8_t>());
    return exchange_pieces(comm, destination, cutter, std::move(departing), cells_at_once, pieces);
  }();
  if (none_departs && pieces.size() == 1 && std::is_sorted(mesh.cell_global.begin(), mesh.cell_global.end())) {
    renew_border(comm.rank(), ghost_to, mesh);
    if (mesh.n_cells() > 0) moves.cells.result = {{0, 0, mesh.n_cells()}};
    if (mesh.n_nodes() > 0) moves.nodes.result = {{0, 0, mesh.n_nodes()}};
  } else {
    pieces.front().ghost_to = std::move(ghost_to);
    pieces.front().destination = destination;
    mesh = join(comm.rank(), std::move(mesh), std::move(pieces), cell_byte, moves);
  }
  const auto bytes_of_round = bytes_of_cell * cells_at_once;
  mesh.cell_fields = move_fields(comm, std::move(cell_fields), moves.cells, bytes_of_round);
  moves.cells = {};
  mesh.node_fields = move_fields(comm, std::move(node_fields), moves.nodes, bytes_of_round);
  return mesh;
}

}  // namespace

mesh::DistMesh migrate(const par::Comm& comm, mesh::DistMesh mesh, std::span<const Rank> destination,
                       std::vector<std::uint8_t>* cell_byte) {
  mesh = move_cells(comm, std::move(mesh), destination, cell_byte);
  mesh::send_level0_rows(comm, mesh);
  return mesh;
}

}  // namespace pamr::balance
