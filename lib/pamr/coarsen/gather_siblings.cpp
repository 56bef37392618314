// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/gather_siblings.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/coarsen/octets.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::coarsen {

namespace {

constexpr GlobalId max_octet_size = GlobalId{8} * mesh::max_family_size;

/// A base cell that may be coarsened, without all of its siblings.
struct Lone {
  GlobalId number = 0;  ///< of its first cell
  std::uint64_t parent = 0;
  std::int32_t size = 0;
  std::int32_t child = 0;
  Rank rank = 0;
  LocalId first = invalid_local;  ///< on its rank
};

struct Answer {
  LocalId first = invalid_local;
  Rank destination = 0;
};

/// The cell has the number after that of the cell before it on this rank.
bool continues_at(const mesh::DistMesh& mesh, LocalId c) {
  return c > 0 && c < mesh.n_cells() && mesh.cell_global[at(c)] == mesh.cell_global[at(c - 1)] + 1;
}

/// Whether the cells before and after this one say that its siblings cannot all be coarsened. If not, and they are not
/// all here, the others may be on other ranks. Base cells that follow each other in number follow each other in the
/// tree.
bool may_be_elsewhere(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, LocalId first) {
  const auto base = mesh.lineage[at(first)].base();
  const auto is_sibling = [&](LocalId cell, int child) {
    const auto other = mesh.lineage[at(cell)].base();
    return other.depth() > 0 && other.child_number() == child && other.red_parent() == base.red_parent() &&
           base_cell_may_go(mesh, flags, cell);
  };
  int child = base.child_number();
  auto begin = first;
  for (; child > 0 && continues_at(mesh, begin); --child) {
    const auto before = mesh.lineage[at(begin - 1)];
    begin -= before.is_removable() ? before.family_size() : 1;
    if (!is_sibling(begin, child - 1)) return false;
  }
  const bool has_first = child == 0;
  auto end = end_of_base_cell(mesh, first);
  for (child = base.child_number(); child < 7 && continues_at(mesh, end); ++child) {
    if (!is_sibling(end, child + 1)) return false;
    end = end_of_base_cell(mesh, end);
  }
  return !has_first || child < 7;
}

/// Behind the eight siblings that begin with this cell, all of which may be coarsened; itself if they are not all here.
LocalId end_of_siblings(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, LocalId first) {
  const auto parent = mesh.lineage[at(first)].base().red_parent();
  auto end = first;
  for (int child = 0; child < 8; ++child) {
    if (end == mesh.n_cells() || (child > 0 && !continues_at(mesh, end))) return first;
    const auto base = mesh.lineage[at(end)].base();
    if (base.depth() == 0 || base.child_number() != child || base.red_parent() != parent ||
        !base_cell_may_go(mesh, flags, end))
      return first;
    end = end_of_base_cell(mesh, end);
  }
  return end;
}

/// Those of this rank whose siblings are not all here, though they may be elsewhere.
std::vector<Lone> find_lone(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, Rank here) {
  std::vector<Lone> lone;
  LocalId end = 0;
  for (LocalId c = 0; c < mesh.n_cells(); c = end) {
    end = end_of_base_cell(mesh, c);
    const auto base = mesh.lineage[at(c)].base();
    if (base.depth() == 0 || !base_cell_may_go(mesh, flags, c)) continue;
    if (base.child_number() == 0)
      if (const auto after = end_of_siblings(mesh, flags, c); after != c) {
        end = after;
        continue;
      }
    if (!may_be_elsewhere(mesh, flags, c)) continue;
    lone.push_back({mesh.cell_global[at(c)], base.red_parent().bits(), end - c, base.child_number(), here, c});
  }
  return lone;
}

/// Asks the blocks in which an octet with each of these cells may begin.
std::vector<par::Outgoing<Lone>> questions_about(const par::Comm& comm, IdRange cells, const std::vector<Lone>& lone) {
  std::vector<par::Outgoing<Lone>> by_rank(at(comm.size()));
  for (const auto& cell : lone) {
    const auto from = par::block_of(std::max(cells.first, cell.number - max_octet_size), cells, comm.size());
    for (auto r = from; r <= par::block_of(cell.number, cells, comm.size()); ++r) by_rank[at(r)].item.push_back(cell);
  }
  std::vector<par::Outgoing<Lone>> questions;
  for (Rank r = 0; r < comm.size(); ++r)
    if (!by_rank[at(r)].item.empty()) questions.push_back({r, std::move(by_rank[at(r)].item)});
  return questions;
}

bool are_siblings(std::span<const Lone> cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].child != static_cast<std::int32_t>(i) || cells[i].parent != cells[0].parent) return false;
    if (i > 0 && cells[i].number != cells[i - 1].number + cells[i - 1].size) return false;
  }
  return true;
}

}  // namespace

std::vector<Rank> gather_siblings(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  std::span<const std::int8_t> flags) {
  if (comm.size() == 1) return {};
  const auto lone = find_lone(mesh, flags, comm.rank());
  if (!comm.any(!lone.empty())) return {};
  const auto cells = mesh.info.cell_ids();
  auto asked = comm.sparse_exchange(questions_about(comm, cells, lone)).item;
  std::sort(asked.begin(), asked.end(), [](const Lone& a, const Lone& b) { return a.number < b.number; });

  const auto block = par::block_range(cells, comm.rank(), comm.size());
  std::vector<par::Outgoing<Answer>> by_rank(at(comm.size()));
  for (std::size_t i = 0; i + 8 <= asked.size(); ++i) {
    const auto octet = std::span<const Lone>(asked).subspan(i, 8);
    if (octet[0].number < block.begin || octet[0].number >= block.end || !are_siblings(octet)) continue;
    for (const auto& cell : octet)
      if (cell.rank != octet[0].rank) by_rank[at(cell.rank)].item.push_back({cell.first, octet[0].rank});
  }
  std::vector<par::Outgoing<Answer>> answers;
  for (Rank r = 0; r < comm.size(); ++r)
    if (!by_rank[at(r)].item.empty()) answers.push_back({r, std::move(by_rank[at(r)].item)});
  const auto answered = comm.sparse_exchange(answers).item;
  if (!comm.any(!answered.empty())) return {};
  std::vector<Rank> destination(at(mesh.n_cells()), comm.rank());
  for (const auto& [first, rank] : answered)
    std::fill(destination.begin() + first, destination.begin() + end_of_base_cell(mesh, first), rank);
  return destination;
}

}  // namespace pamr::coarsen
