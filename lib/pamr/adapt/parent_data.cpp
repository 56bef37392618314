// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/parent_data.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::adapt::detail {

namespace {

/// Where the row of a cell is kept; a cell that nobody gives has the rank 0, as memory is made.
struct Place {
  std::int32_t rank_and_one = 0;
  LocalId row = 0;
};

void check_held(const par::Comm& comm, IdRange cells, std::span<const GlobalId> held, const ByteRows& rows,
                std::span<const GlobalId> wanted) {
  const auto offset = rows.offset;
  const auto n_items = rows.value.size() / rows.item_bytes;
  par::agree(comm, [&] {
    const auto where = fmt::format("data of cells (rank {}): expected ", comm.rank());
    if (offset.size() != held.size() + 1 || offset.front() != 0 || offset.back() != n_items)
      throw Error(
          fmt::format("{}{} rows that begin at 0 and end at {}, found other offsets", where, held.size(), n_items));
    for (std::size_t i = 0; i < held.size(); ++i)
      if (offset[i] > offset[i + 1])
        throw Error(fmt::format("{}offsets that do not fall, found {} after {}", where, offset[i + 1], offset[i]));
    for (const auto list : {held, wanted})
      for (const auto cell : list)
        if (!cells.contains(cell))
          throw Error(fmt::format("{}cells from {} to {}, found {}", where, cells.first, cells.end() - 1, cell));
  });
}

/// Places of the wanted rows, asked for once where neighbors in the list want the same. Collective.
std::vector<Place> find_places(const par::Comm& comm, IdRange cells, std::span<const GlobalId> held,
                               const std::vector<GlobalId>& wanted) {
  std::vector<Place> own(held.size());
  for (std::size_t i = 0; i < held.size(); ++i) own[i] = {comm.rank() + 1, static_cast<LocalId>(i)};
  const auto directory = par::scatter_rows<Place>(comm, cells, own, 1, held);
  auto places = par::fetch_rows<Place>(comm, cells, directory, 1, wanted);
  par::agree(comm, [&] {
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i].rank_and_one == 0)
        throw Error(fmt::format("data of cells: expected a row for cell {}, found none on any rank", wanted[i]));
  });
  return places;
}

}  // namespace

std::vector<GlobalId> parents_of(const par::Comm& comm, const mesh::DistMesh& fine) {
  const auto* field = fine.find_cell_field(mesh::parent_field);
  if (!comm.all(field != nullptr && field->holds_integers() && field->n_components == 1))
    throw Error("data of parents: expected a refined mesh with the cell field 'parent', found none");
  return field->integer();
}

CellRows<std::byte> fetch_cell_rows(const par::Comm& comm, IdRange cells, std::span<const GlobalId> held,
                                    const ByteRows& rows, std::span<const GlobalId> wanted) {
  const auto& [offset, value, item_bytes] = rows;
  check_held(comm, cells, held, rows, wanted);
  std::vector<GlobalId> once;
  std::vector<std::size_t> place_of(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (i == 0 || wanted[i] != wanted[i - 1]) once.push_back(wanted[i]);
    place_of[i] = once.size() - 1;
  }
  const auto places = find_places(comm, cells, held, once);

  std::vector<par::Outgoing<LocalId>> questions;
  std::vector<std::vector<std::size_t>> asked_of(at(comm.size()));
  for (std::size_t i = 0; i < places.size(); ++i) asked_of[at(places[i].rank_and_one - 1)].push_back(i);
  for (std::size_t r = 0; r < asked_of.size(); ++r) {
    if (asked_of[r].empty()) continue;
    questions.push_back({static_cast<Rank>(r), {}});
    for (const auto i : asked_of[r]) questions.back().item.push_back(places[i].row);
  }
  const auto asked = comm.sparse_exchange(questions);
  std::vector<par::Outgoing<std::uint64_t>> lengths;
  std::vector<par::Outgoing<std::byte>> contents;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {
    lengths.push_back({asked.rank[r], {}});
    contents.push_back({asked.rank[r], {}});
    for (const auto row : asked.from(r)) {
      const auto begin = offset[at(row)], n = offset[at(row) + 1] - begin;
      lengths.back().item.push_back(n);
      const auto bytes = value.subspan(begin * item_bytes, n * item_bytes);
      contents.back().item.insert(contents.back().item.end(), bytes.begin(), bytes.end());
    }
    if (contents.back().item.empty()) contents.pop_back();
  }
  const auto length = comm.sparse_exchange(lengths);
  const auto content = comm.sparse_exchange(contents);

  std::vector<std::span<const std::byte>> row(once.size());
  std::size_t with_content = 0;
  for (std::size_t r = 0; r < length.rank.size(); ++r) {
    const auto& which = asked_of[at(length.rank[r])];
    const bool has_content = with_content < content.rank.size() && content.rank[with_content] == length.rank[r];
    auto rest = has_content ? content.from(with_content++) : std::span<const std::byte>();
    for (std::size_t k = 0; k < which.size(); ++k) {
      row[which[k]] = rest.first(length.from(r)[k] * item_bytes);
      rest = rest.subspan(length.from(r)[k] * item_bytes);
    }
  }
  CellRows<std::byte> result;
  result.offset.reserve(wanted.size() + 1);
  for (const auto place : place_of) {
    result.offset.push_back(result.offset.back() + row[place].size() / item_bytes);
    result.value.insert(result.value.end(), row[place].begin(), row[place].end());
  }
  return result;
}

}  // namespace pamr::adapt::detail
