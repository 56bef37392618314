// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/border_agrees.hpp"

#include <algorithm>

namespace pamr::mesh {

bool border_agrees(const par::Comm& comm, const DistMesh& mesh,
                   const std::function<std::uint64_t(std::size_t k, bool is_lower)>& word_of) {
  std::vector<par::Outgoing<std::uint64_t>> messages;
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    messages.push_back({mesh.border_rank[i], {}});
    auto& words = messages.back().item;
    words.reserve(mesh.border_offset[i + 1] - mesh.border_offset[i]);
    for (auto k = mesh.border_offset[i]; k < mesh.border_offset[i + 1]; ++k)
      words.push_back(word_of(k, comm.rank() < mesh.border_rank[i]));
  }
  const auto arrived = comm.sparse_exchange(messages);
  if (arrived.rank != mesh.border_rank) return false;
  for (std::size_t i = 0; i < messages.size(); ++i)
    if (!std::ranges::equal(arrived.from(i), messages[i].item)) return false;
  return true;
}

}  // namespace pamr::mesh
