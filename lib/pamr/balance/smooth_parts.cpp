// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/smooth_parts.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/ghost_values.hpp"

namespace pamr::balance {

namespace {

constexpr int max_sweeps = 12;

/// Faces of one family by the part on their other side; a family has at most 16.
class FaceCount {
 public:
  void add(Rank part) {
    for (std::size_t i = 0; i < size_; ++i)
      if (part_[i] == part) {
        ++count_[i];
        return;
      }
    part_[size_] = part;
    count_[size_++] = 1;
  }
  int of(Rank part) const {
    for (std::size_t i = 0; i < size_; ++i)
      if (part_[i] == part) return count_[i];
    return 0;
  }
  std::size_t size() const { return size_; }
  Rank part(std::size_t i) const { return part_[i]; }
  int count(std::size_t i) const { return count_[i]; }

 private:
  std::array<Rank, 16> part_{};
  std::array<int, 16> count_{};
  std::size_t size_ = 0;
};

class Smoother {
 public:
  Smoother(const mesh::DistMesh& mesh, Rank here, std::span<const std::int64_t> weight, std::vector<Rank>& part)
      : mesh_(mesh), here_(here), weight_(weight), part_(part), is_listed_(part.size(), 0) {
    for (std::size_t i = 0; i < mesh.border_rank.size(); ++i)
      ghost_rank_.resize(mesh.border_offset[i + 1], mesh.border_rank[i]);
    for (std::size_t c = 0; c < part.size(); ++c)
      for (const auto neighbor : mesh.cell_to_cell[c])
        if (mesh.is_ghost(neighbor) || (neighbor >= 0 && part[at(neighbor)] != part[c])) {
          list(static_cast<LocalId>(c));
          break;
        }
  }

  /// Goes over the families at borders, and those that come to lie there, once. `room`: what this rank may still add to
  /// each part. Families at a rank border only move when it is their side's turn, so that two that face each other do
  /// not move at once; they are looked at in every sweep. Returns the faces saved.
  std::int64_t sweep(std::span<const Rank> beyond, bool lower_rank_moves, std::vector<std::int64_t>& room) {
    std::int64_t saved = 0;
    const auto now = std::move(listed_);
    listed_.clear();
    for (const auto first : now) is_listed_[at(first)] = 0;
    for (const auto first : now) {
      const auto size = size_of(first);
      const auto gain = move(first, size, beyond, lower_rank_moves, room);
      saved += gain;
      for (auto c = first; c < first + size; ++c)
        for (const auto neighbor : mesh_.cell_to_cell[at(c)])
          if (mesh_.is_ghost(neighbor))
            list(c);
          else if (neighbor >= 0 && gain > 0)
            list(neighbor);
    }
    return saved;
  }

 private:
  LocalId size_of(LocalId first) const {
    const auto lineage = mesh_.lineage[at(first)];
    return lineage.is_removable() ? lineage.family_size() : 1;
  }
  void list(LocalId cell) {
    const auto lineage = mesh_.lineage[at(cell)];
    const auto first = lineage.is_removable() ? cell - lineage.child() : cell;
    if (is_listed_[at(first)] != 0) return;
    is_listed_[at(first)] = 1;
    listed_.push_back(first);
  }
  Rank part_behind(LocalId neighbor, std::span<const Rank> beyond) const {
    return mesh_.is_ghost(neighbor) ? beyond[at(neighbor - mesh_.n_cells())] : part_[at(neighbor)];
  }

  std::int64_t move(LocalId first, LocalId size, std::span<const Rank> beyond, bool lower_rank_moves,
                    std::vector<std::int64_t>& room) {
    FaceCount faces;
    std::int64_t weight = 0;
    for (auto c = first; c < first + size; ++c) {
      weight += weight_[at(c)];
      for (const auto neighbor : mesh_.cell_to_cell[at(c)]) {
        if (neighbor < 0 || (neighbor >= first && neighbor < first + size)) continue;
        if (mesh_.is_ghost(neighbor) && (ghost_rank_[at(neighbor - mesh_.n_cells())] > here_) != lower_rank_moves)
          return 0;
        faces.add(part_behind(neighbor, beyond));
      }
    }
    const auto own = part_[at(first)];
    const int kept = faces.of(own);
    int most = kept;
    Rank best = own;
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (faces.part(i) != own && room[at(faces.part(i))] >= weight &&
          (faces.count(i) > most || (faces.count(i) == most && best != own && faces.part(i) < best))) {
        most = faces.count(i);
        best = faces.part(i);
      }
    if (best == own) return 0;
    room[at(best)] -= weight;
    room[at(own)] += weight;
    for (auto c = first; c < first + size; ++c) part_[at(c)] = best;
    return most - kept;
  }

  const mesh::DistMesh& mesh_;
  Rank here_;
  std::span<const std::int64_t> weight_;
  std::vector<Rank>& part_;
  std::vector<Rank> ghost_rank_;         // of each rank-border face
  std::vector<LocalId> listed_;          // families to look at, by their first cells
  std::vector<std::uint8_t> is_listed_;  // by first cell
};

}  // namespace

std::int64_t smooth_parts(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                          const PartLimit& limit, std::vector<Rank>& part) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()) && part.size() == weight.size());
  Smoother smoother(mesh, comm.rank(), weight, part);
  std::vector<std::int64_t> here(at(limit.n_parts), 0);
  for (std::size_t c = 0; c < part.size(); ++c) here[at(part[c])] += weight[c];
  std::int64_t saved = 0;
  int idle = 0;
  for (int sweep = 0; sweep < max_sweeps && idle < 2; ++sweep) {
    auto sum = here;
    comm.sum_in_place(sum);
    const auto total = std::accumulate(sum.begin(), sum.end(), std::int64_t{0});
    const auto max_weight = static_cast<std::int64_t>(limit.max_imbalance * static_cast<double>(total) /
                                                      static_cast<double>(limit.n_parts));
    // shared out evenly, so that all ranks together stay below the limit
    for (auto& value : sum) value = std::max<std::int64_t>(0, max_weight - value) / comm.size();
    auto room = sum;
    const auto beyond = mesh::ghost_values(comm, mesh, part);
    const auto now = comm.sum(smoother.sweep(beyond, sweep % 2 == 0, room));
    for (std::size_t p = 0; p < here.size(); ++p) here[p] += sum[p] - room[p];
    saved += now;
    idle = now == 0 ? idle + 1 : 0;
  }
  return saved;
}

}  // namespace pamr::balance
