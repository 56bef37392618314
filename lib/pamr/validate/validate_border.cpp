// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "pamr/mesh/face_groups.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/validate/validate_steps.hpp"

namespace pamr::validate {

namespace {

/// What both sides of a rank-border face say of it.
struct FaceCard {
  par::SharedKey key{};
  GlobalId own = 0;
  GlobalId other = 0;
  std::int64_t sign = 0;
};

void compare_sides(std::span<const FaceCard> mine, std::span<const FaceCard> theirs, Findings& findings) {
  for (std::size_t k = 0; k < std::max(mine.size(), theirs.size()); ++k) {
    if (k >= mine.size())
      findings.add(Invariant::border_matches, theirs[k].own);
    else if (k >= theirs.size() || mine[k].key != theirs[k].key)
      findings.add(Invariant::border_matches, mine[k].own);
    else if (mine[k].own != theirs[k].other || mine[k].other != theirs[k].own || mine[k].sign != -theirs[k].sign)
      findings.add(Invariant::neighbors_reciprocal, mine[k].own);
  }
}

/// One item for each rank-border face, `make(k, other rank)`, to the rank on its other side.
template <class T, class Make>
std::vector<par::Outgoing<T>> of_border(const mesh::DistMesh& mesh, Make&& make) {
  std::vector<par::Outgoing<T>> messages;
  for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
    messages.push_back({mesh.border_rank[i], {}});
    messages.back().item.reserve(mesh.border_offset[i + 1] - mesh.border_offset[i]);
    for (auto k = mesh.border_offset[i]; k < mesh.border_offset[i + 1]; ++k)
      messages.back().item.push_back(make(k, mesh.border_rank[i]));
  }
  return messages;
}

/// True when the other side of every rank-border face says the same of it, in the same order: nodes, cells, and from
/// which side each cell looks at it. Collective: one sparse exchange of 8 bytes a face.
bool sides_agree(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto messages = of_border<std::uint64_t>(mesh, [&](std::size_t k, Rank other) {
    const bool is_lower = comm.rank() < other;
    const bool is_positive = (face_sign(mesh, mesh.border_face[k]) > 0) == is_lower;
    return mesh::border_word(mesh, k, is_lower) + (is_positive ? 1 : 0);
  });
  const auto arrived = comm.sparse_exchange(messages);
  if (arrived.rank != mesh.border_rank) return false;
  for (std::size_t i = 0; i < messages.size(); ++i)
    if (!std::ranges::equal(arrived.from(i), messages[i].item)) return false;
  return true;
}

/// Finds in what the two sides of rank-border faces differ. Collective: one sparse exchange.
void find_differences(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  const auto messages = of_border<FaceCard>(mesh, [&](std::size_t k, Rank) {
    const auto face = mesh.border_face[k];
    return FaceCard{mesh::face_key(mesh, face), number_of(mesh, face.cell), mesh.ghost_global[k],
                    face_sign(mesh, face)};
  });
  const auto arrived = comm.sparse_exchange(messages);
  for (const auto& message : messages) {
    const auto from = std::find(arrived.rank.begin(), arrived.rank.end(), message.to);
    compare_sides(message.item,
                  from == arrived.rank.end() ? std::span<const FaceCard>{}
                                             : arrived.from(static_cast<std::size_t>(from - arrived.rank.begin())),
                  findings);
  }
  for (std::size_t r = 0; r < arrived.rank.size(); ++r)
    if (!std::binary_search(mesh.border_rank.begin(), mesh.border_rank.end(), arrived.rank[r]))
      compare_sides({}, arrived.from(r), findings);
}

}  // namespace

void check_border(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings) {
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k)
    if (slot_at(mesh, mesh.border_face[k]) != mesh.n_cells() + static_cast<LocalId>(k))
      findings.add(Invariant::border_matches, number_of(mesh, mesh.border_face[k].cell));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto slot = slot_at(mesh, {c, f});
      if (mesh.is_ghost(slot) &&
          mesh.border_face[static_cast<std::size_t>(slot - mesh.n_cells())] != mesh::CellFace{c, f})
        findings.add(Invariant::border_matches, number_of(mesh, c));
    }
  if (comm.any(!sides_agree(comm, mesh))) find_differences(comm, mesh, findings);
}

}  // namespace pamr::validate
