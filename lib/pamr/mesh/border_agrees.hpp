// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

/// True when both sides of every rank-border face give the same word for it, in the same order. `word_of(k, is_lower)`:
/// of border face `k`, `is_lower` on the lower of the two ranks; `border_word` is a word of nodes and cells.
/// Collective: one sparse exchange of 8 bytes a face; the result is this rank's own.
bool border_agrees(const par::Comm& comm, const DistMesh& mesh,
                   const std::function<std::uint64_t(std::size_t k, bool is_lower)>& word_of);

/// What one side of a rank-border face knows of it: to find in what the two sides differ when they do not agree.
struct FaceRecord {
  par::SharedKey key{};  ///< global numbers of its nodes, ascending
  GlobalId own = 0;      ///< the cell on this side, and on the other
  GlobalId other = 0;
  std::int64_t sign = 0;  ///< the side from which the own cell looks at it, where that is asked for
};

/// One item for each rank-border face, `make(k)`, to the rank on its other side. Local.
template <class T, class Make>
std::vector<par::Outgoing<T>> for_each_border_face(const DistMesh& mesh, Make&& make) {
  std::vector<par::Outgoing<T>> messages;
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    messages.push_back({mesh.border_rank[i], {}});
    messages.back().item.reserve(mesh.border_offset[i + 1] - mesh.border_offset[i]);
    for (auto k = mesh.border_offset[i]; k < mesh.border_offset[i + 1]; ++k) messages.back().item.push_back(make(k));
  }
  return messages;
}

}  // namespace pamr::mesh
