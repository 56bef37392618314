// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// Values of the cells on the other side of the rank border, for one value a cell given by `of_cell` (n_cells): one for
/// each rank-border face, in the order of `border_face`, so that of a neighbor `next` with `mesh.is_ghost(next)` it is
/// number next - n_cells. T: any trivially copyable type. Collective over neighboring ranks: one message to each, of
/// sizeof(T) bytes a face.
template <class T>
std::vector<T> ghost_values(const par::Comm& comm, const DistMesh& mesh, std::span<const T> of_cell) {
  static_assert(std::is_trivially_copyable_v<T>);
  PAMR_EXPECTS(of_cell.size() == mesh.cell_to_cell.size());
  std::vector<T> mine, theirs(mesh.border_face.size());
  mine.reserve(mesh.border_face.size());
  for (const auto face : mesh.border_face) mine.push_back(of_cell[at(face.cell)]);
  std::vector<std::span<const std::byte>> send;
  std::vector<std::span<std::byte>> receive;
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    const auto begin = mesh.border_offset[i], count = mesh.border_offset[i + 1] - begin;
    send.push_back(std::as_bytes(std::span<const T>(mine).subspan(begin, count)));
    receive.push_back(std::as_writable_bytes(std::span<T>(theirs).subspan(begin, count)));
  }
  comm.neighbor_exchange(mesh.border_rank, send, receive);
  return theirs;
}

/// The same for values in a vector.
template <class T>
std::vector<T> ghost_values(const par::Comm& comm, const DistMesh& mesh, const std::vector<T>& of_cell) {
  return ghost_values(comm, mesh, std::span<const T>(of_cell));
}

}  // namespace pamr::mesh
