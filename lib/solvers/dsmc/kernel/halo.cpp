// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/halo.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::dsmc {

namespace {

/// A cell of some rank.
struct RankCell {
  Rank rank = -1;
  LocalId cell = 0;
};

/// What is behind a face: a cell, a boundary face, or both where the boundary is periodic.
struct Behind {
  RankCell cell;               ///< rank below 0: none
  std::int32_t boundary = -1;  ///< number of the boundary face on the rank of its cell; below 0: none
  std::int32_t patch = 0;
};

/// A cell as its rank tells of it.
struct CellReport {
  CellPlanes planes;
  double dt = 0;
  std::array<Behind, 4> behind;
};

class HaloMaker {
 public:
  HaloMaker(const par::Comm& comm, GasDomain& domain) : comm_(&comm), domain_(&domain), n_own_(domain.n_cells()) {}

  void make(int layers) {
    find_border();
    link_own();
    for (int layer = 0; layer < layers; ++layer) add_layer();
    name_neighbors();
  }

 private:
  /// The cells behind the faces of the rank border.
  void find_border();
  void link_own();
  void add_layer();
  void name_neighbors();
  /// The link to a cell; names it if it is new.
  LocalId link_to(const RankCell& cell);
  RankCell cell_of(LocalId link) const;
  CellReport report(LocalId cell) const;
  void take(const CellReport& report, Rank rank);

  const par::Comm* comm_;
  GasDomain* domain_;
  LocalId n_own_;
  std::vector<RankCell> border_;  ///< behind each face of the rank border
  std::vector<RankCell> named_;   ///< cells of other ranks, in the order of the layers
  std::vector<RankCell> halo_face_;
  std::unordered_map<std::uint64_t, LocalId> number_;  ///< of a named cell among them
};

void HaloMaker::find_border() {
  const auto& domain = *domain_;
  const auto n = domain.border_face.size();
  std::vector<LocalId> here(n), there(n);
  for (std::size_t k = 0; k < n; ++k) here[k] = domain.border_face[k].cell;
  std::vector<std::span<const std::byte>> send;
  std::vector<std::span<std::byte>> receive;
  for (std::size_t i = 0; i < domain.border_rank.size(); ++i) {
    const auto first = domain.border_offset[i], count = domain.border_offset[i + 1] - first;
    send.push_back(std::as_bytes(std::span(here).subspan(first, count)));
    receive.push_back(std::as_writable_bytes(std::span(there).subspan(first, count)));
  }
  comm_->neighbor_exchange(domain.border_rank, send, receive);
  border_.resize(n);
  for (std::size_t i = 0; i < domain.border_rank.size(); ++i)
    for (auto k = domain.border_offset[i]; k < domain.border_offset[i + 1]; ++k)
      border_[k] = {domain.border_rank[i], there[k]};
}

/// Before the links become those of the halo.
RankCell HaloMaker::cell_of(LocalId link) const {
  return link < n_own_ ? RankCell{comm_->rank(), link} : border_[at(link - n_own_)];
}

LocalId HaloMaker::link_to(const RankCell& cell) {
  if (cell.rank == comm_->rank()) return cell.cell;
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.rank)) << 32U) |
                   static_cast<std::uint32_t>(cell.cell);
  const auto [found, is_new] = number_.try_emplace(key, static_cast<LocalId>(named_.size()));
  if (is_new) named_.push_back(cell);
  return n_own_ + found->second;
}

void HaloMaker::link_own() {
  for (const auto& cell : border_) link_to(cell);
}

CellReport HaloMaker::report(LocalId cell) const {
  const auto& domain = *domain_;
  CellReport report{domain.planes[at(cell)], domain.dt[at(cell)], {}};
  for (std::size_t f = 0; f < 4; ++f) {
    auto& behind = report.behind[f];
    const auto link = domain.link[at(cell)][f];
    if (link >= 0) {
      behind.cell = cell_of(link);
      continue;
    }
    behind.boundary = -link - 1;
    const auto& face = domain.boundary[at(behind.boundary)];
    behind.patch = face.patch;
    if (face.across >= 0) behind.cell = cell_of(face.across);
  }
  return report;
}

/// `rank`: that of the cell.
void HaloMaker::take(const CellReport& report, Rank rank) {
  auto& domain = *domain_;
  std::array<LocalId, 4> links{};
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& behind = report.behind[f];
    const auto link = behind.cell.rank < 0 ? -1 : link_to(behind.cell);
    links[f] = link;
    if (behind.boundary < 0) continue;
    BoundaryFace face;
    face.slot = static_cast<int>(f);
    face.patch = behind.patch;
    face.normal = report.planes.normal(face.slot);
    face.across = link;
    domain.halo_boundary.push_back(face);
    halo_face_.push_back({rank, behind.boundary});
    links[f] = -static_cast<LocalId>(domain.boundary.size() + domain.halo_boundary.size());
  }
  domain.planes.push_back(report.planes);
  domain.dt.push_back(report.dt);
  domain.link.push_back(links);
}

void HaloMaker::add_layer() {
  const auto known = domain_->planes.size() - at(n_own_);
  std::map<Rank, std::vector<LocalId>> wanted;
  for (auto k = known; k < named_.size(); ++k) wanted[named_[k].rank].push_back(named_[k].cell);
  std::vector<par::Outgoing<LocalId>> questions;
  for (auto& [rank, cells] : wanted) questions.push_back({rank, std::move(cells)});
  const auto asked = comm_->sparse_exchange(questions);
  std::vector<par::Outgoing<CellReport>> answers;
  for (std::size_t i = 0; i < asked.rank.size(); ++i) {
    answers.push_back({asked.rank[i], {}});
    for (const auto cell : asked.from(i)) answers.back().item.push_back(report(cell));
  }
  const auto told = comm_->sparse_exchange(answers);
  std::map<Rank, std::size_t> next;  // the answers of a rank are in the order of the questions
  for (std::size_t i = 0; i < told.rank.size(); ++i) next[told.rank[i]] = told.offset[i];
  const auto n = named_.size();
  // Left to itself a vector would double, and lose its large pages.
  grow_array(domain_->planes, at(n_own_) + n);
  grow_array(domain_->link, at(n_own_) + n);
  grow_array(domain_->dt, at(n_own_) + n);
  for (auto k = known; k < n; ++k) {
    const auto rank = named_[k].rank;
    take(told.item[next[rank]++], rank);
  }
}

/// Replaces ranks by numbers of neighbors, and links to the border by links to the halo.
void HaloMaker::name_neighbors() {
  auto& domain = *domain_;
  auto& rank = domain.neighbor;
  for (const auto& cell : named_) rank.push_back(cell.rank);
  std::sort(rank.begin(), rank.end());
  rank.erase(std::unique(rank.begin(), rank.end()), rank.end());
  const auto place = [&](const RankCell& cell) {
    return Place{static_cast<std::int32_t>(std::lower_bound(rank.begin(), rank.end(), cell.rank) - rank.begin()),
                 cell.cell};
  };
  for (const auto& cell : named_) domain.abroad.push_back(place(cell));
  for (const auto& face : halo_face_) domain.halo_boundary_place.push_back(place(face));
  const auto to_halo = [&](LocalId& link) {
    if (link >= n_own_) link = link_to(border_[at(link - n_own_)]);
  };
  for (std::size_t c = 0; c < at(n_own_); ++c)
    for (auto& link : domain.link[c]) to_halo(link);
  for (auto& face : domain.boundary) to_halo(face.across);
}

}  // namespace

void add_halo(const par::Comm& comm, GasDomain& domain, int layers) {
  if (comm.size() > 1) HaloMaker(comm, domain).make(layers);
}

}  // namespace pamr::dsmc
