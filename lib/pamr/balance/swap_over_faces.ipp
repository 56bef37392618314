// SPDX-License-Identifier: GPL-3.0-or-later
// Template of dual_graph.hpp.
#pragma once

#include "pamr/balance/dual_graph.hpp"
#include "pamr/base/index.hpp"

namespace pamr::balance {

template <class T>
std::vector<T> swap_over_faces(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const T> of_cell) {
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

}  // namespace pamr::balance
