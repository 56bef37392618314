// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/gather_siblings.hpp"

#include <algorithm>
#include <array>

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

/// Base cells of this rank that follow each other in number and in the tree: siblings, maybe not all.
struct Siblings {
  std::array<LocalId, 8> first{};
  int n = 0;
  LocalId end = 0;
  bool may_go = true;         ///< all of them
  bool may_continue = false;  ///< the cells before and after them do not say that the others are not siblings
};

/// Those that begin with `first`, which has a parent.
Siblings siblings_from(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, LocalId first) {
  const auto base = mesh.lineage[at(first)].base();
  Siblings siblings{.end = first};
  const auto child = [&] { return base.child_number() + siblings.n; };
  const auto is_next = [&](LocalId cell) {
    if (!continues_at(mesh, cell)) return false;
    const auto other = mesh.lineage[at(cell)].base();
    return other.depth() > 0 && other.child_number() == child() && other.red_parent() == base.red_parent();
  };
  do {
    siblings.may_go = siblings.may_go && base_cell_may_go(mesh, flags, siblings.end);
    siblings.first[at(siblings.n++)] = siblings.end;
    siblings.end = end_of_base_cell(mesh, siblings.end);
  } while (child() < 8 && is_next(siblings.end));
  siblings.may_continue =
      (base.child_number() == 0 || !continues_at(mesh, first)) && (child() == 8 || !continues_at(mesh, siblings.end));
  return siblings;
}

/// Those of this rank whose siblings are not all here, though they may be elsewhere.
std::vector<Lone> find_lone(const mesh::DistMesh& mesh, std::span<const std::int8_t> flags, Rank here) {
  std::vector<Lone> lone;
  LocalId end = 0;
  for (LocalId c = 0; c < mesh.n_cells(); c = end) {
    end = end_of_base_cell(mesh, c);
    if (mesh.lineage[at(c)].base().depth() == 0) continue;
    const auto siblings = siblings_from(mesh, flags, c);
    end = siblings.end;
    if (siblings.n == 8 || !siblings.may_go || !siblings.may_continue) continue;
    for (int i = 0; i < siblings.n; ++i) {
      const auto first = siblings.first[at(i)];
      const auto base = mesh.lineage[at(first)].base();
      lone.push_back({mesh.cell_global[at(first)], base.red_parent().bits(), end_of_base_cell(mesh, first) - first,
                      base.child_number(), here, first});
    }
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
