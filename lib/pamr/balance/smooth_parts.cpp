// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/smooth_parts.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "pamr/balance/dual_graph.hpp"
#include "pamr/base/contract.hpp"

namespace pamr::balance {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }
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
      : mesh_(mesh), here_(here), weight_(weight), part_(part) {
    for (std::size_t i = 0; i < mesh.border_rank.size(); ++i)
      ghost_rank_.resize(mesh.border_offset[i + 1], mesh.border_rank[i]);
  }

  /// Goes over the cells once. `room`: what this rank may still add to each part. Cells at a rank border only move when
  /// it is their side's turn, so that two cells that face each other do not move at once. Returns the faces saved.
  std::int64_t sweep(std::span<const Rank> beyond, bool lower_rank_moves, std::vector<std::int64_t>& room) {
    std::int64_t saved = 0;
    for (LocalId first = 0; first < mesh_.n_cells();) {
      const auto lineage = mesh_.lineage[at(first)];
      const LocalId size = lineage.is_removable() ? lineage.family_size() : 1;
      if (is_at_border(first, size, beyond)) saved += move(first, size, beyond, lower_rank_moves, room);
      first += size;
    }
    return saved;
  }

 private:
  bool is_at_border(LocalId first, LocalId size, std::span<const Rank> beyond) const {
    const auto own = part_[at(first)];
    for (auto c = first; c < first + size; ++c)
      for (const auto neighbour : mesh_.cell_to_cell[at(c)])
        if (neighbour >= 0 && part_behind(neighbour, beyond) != own) return true;
    return false;
  }
  Rank part_behind(LocalId neighbour, std::span<const Rank> beyond) const {
    return mesh_.is_ghost(neighbour) ? beyond[at(neighbour - mesh_.n_cells())] : part_[at(neighbour)];
  }

  std::int64_t move(LocalId first, LocalId size, std::span<const Rank> beyond, bool lower_rank_moves,
                    std::vector<std::int64_t>& room) {
    FaceCount faces;
    std::int64_t weight = 0;
    for (auto c = first; c < first + size; ++c) {
      weight += weight_[at(c)];
      for (const auto neighbour : mesh_.cell_to_cell[at(c)]) {
        if (neighbour < 0 || (neighbour >= first && neighbour < first + size)) continue;
        if (mesh_.is_ghost(neighbour) && (ghost_rank_[at(neighbour - mesh_.n_cells())] > here_) != lower_rank_moves)
          return 0;
        faces.add(part_behind(neighbour, beyond));
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
  std::vector<Rank> ghost_rank_;  // of each rank-border face
};

}  // namespace

std::int64_t smooth_parts(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                          Rank n_parts, double worst, std::vector<Rank>& part) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()) && part.size() == weight.size());
  Smoother smoother(mesh, comm.rank(), weight, part);
  std::int64_t saved = 0;
  int idle = 0;
  for (int sweep = 0; sweep < max_sweeps && idle < 2; ++sweep) {
    std::vector<std::int64_t> sum(at(n_parts), 0);
    for (std::size_t c = 0; c < part.size(); ++c) sum[at(part[c])] += weight[c];
    comm.sum_in_place(sum);
    const auto total = std::accumulate(sum.begin(), sum.end(), std::int64_t{0});
    const auto limit = static_cast<std::int64_t>(worst * static_cast<double>(total) / static_cast<double>(n_parts));
    // shared out evenly, so that all ranks together stay below the limit
    for (auto& value : sum) value = std::max<std::int64_t>(0, limit - value) / comm.size();
    const auto beyond = swap_over_faces<Rank>(comm, mesh, part);
    const auto now = comm.sum(smoother.sweep(beyond, sweep % 2 == 0, sum));
    saved += now;
    idle = now == 0 ? idle + 1 : 0;
  }
  return saved;
}

}  // namespace pamr::balance
