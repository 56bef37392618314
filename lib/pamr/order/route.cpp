// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/route.hpp"

#include <bit>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/sorted_order.hpp"

// Every rank sorts its cells by key. Where the blocks of the new numbers begin among all ranks' keys is found digit by
// digit: the ranks add up how many of their cells have each digit, and go on with those that hold the block's first
// cell. So every cell is sent once.
namespace pamr::order {

namespace {

constexpr unsigned bits_of_digit = 4;
constexpr std::size_t n_values = std::size_t{1} << bits_of_digit;

/// Looks for the first cell of a block. It is known to be among certain cells, which on this rank are `low` to `high` of
/// its order; `n_before` of them, on all ranks, come before it.
struct Search {
  std::size_t low = 0, high = 0;
  std::int64_t n_before = 0;
};

/// Narrows each search to the cells whose value, of `bits` bits, is that of the cell it looks for. `value_at`: the value
/// of a cell by its place in this rank's order, in which values ascend. Collective: a reduction for each digit.
template <class ValueAt>
void narrow_all(const par::Comm& comm, std::vector<Search>& searches, unsigned bits, ValueAt value_at) {
  for (auto shift = (bits + bits_of_digit - 1) / bits_of_digit * bits_of_digit; shift > 0;) {
    shift -= bits_of_digit;
    std::vector<std::size_t> begin;     // n_values + 1 a search
    std::vector<std::int64_t> n_cells;  // n_values a search, of all ranks
    for (const auto& [low, high, n_before] : searches) {
      auto at = low;
      begin.push_back(at);
      for (std::size_t value = 0; value < n_values; ++value) {
        auto end = high;
        while (at < end) {
          const auto middle = at + (end - at) / 2;
          if ((value_at(middle) >> shift & (n_values - 1)) <= value)
            at = middle + 1;
          else
            end = middle;
        }
        n_cells.push_back(static_cast<std::int64_t>(at - begin.back()));
        begin.push_back(at);
      }
    }
    comm.sum_in_place(n_cells);
    for (std::size_t s = 0; s < searches.size(); ++s) {
      auto& search = searches[s];
      std::size_t value = 0;
      for (; value + 1 < n_values && n_cells[s * n_values + value] <= search.n_before; ++value)
        search.n_before -= n_cells[s * n_values + value];
      search.low = begin[s * (n_values + 1) + value];
      search.high = begin[s * (n_values + 1) + value + 1];
    }
  }
}

/// `Route::begin`. `key`: of the cells in the route's order. Collective.
std::vector<std::size_t> find_begin(const par::Comm& comm, const mesh::BlockMesh& block, const Route& route,
                                    const std::vector<std::uint64_t>& key) {
  const auto cells = block.info.cell_ids();
  std::vector<Search> searches;
  for (Rank r = 1; r < comm.size(); ++r)
    searches.push_back({0, key.size(), par::block_range(cells, r, comm.size()).begin - cells.first});
  narrow_all(comm, searches, 64, [&](std::size_t i) { return key[i]; });
  narrow_all(
      comm, searches, static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(cells.n))),
      [&](std::size_t i) { return static_cast<std::uint64_t>(block.first_cell - cells.first) + route.order[i]; });
  std::vector<std::size_t> begin{0};
  for (const auto& search : searches) begin.push_back(search.low);
  begin.push_back(key.size());
  return begin;
}

}  // namespace

Route find_route(const par::Comm& comm, const mesh::BlockMesh& block, std::span<const std::uint64_t> key) {
  Route route;
  route.order = sorted_order(key);
  std::vector<std::uint64_t> sorted;
  reserve_array(sorted, key.size());
  for (const auto c : route.order) sorted.push_back(key[c]);
  route.begin = find_begin(comm, block, route, sorted);

  const auto here = static_cast<std::size_t>(comm.rank()), size = static_cast<std::size_t>(comm.size());
  std::vector<par::Outgoing<std::uint64_t>> parts;
  for (std::size_t r = 0; r < size; ++r)
    if (route.begin[r] < route.begin[r + 1])
      parts.push_back({static_cast<Rank>(r),
                       {sorted.begin() + static_cast<std::ptrdiff_t>(route.begin[r]),
                        sorted.begin() + static_cast<std::ptrdiff_t>(route.begin[r + 1])}});
  free_array(sorted);
  const auto arrived = comm.sparse_exchange(parts);
  free_array(parts);
  route.first.assign(size + 1, 0);
  for (std::size_t k = 0; k < arrived.rank.size(); ++k)
    route.first[static_cast<std::size_t>(arrived.rank[k]) + 1] = arrived.from(k).size();
  std::partial_sum(route.first.begin(), route.first.end(), route.first.begin());
  PAMR_ENSURES(static_cast<GlobalId>(arrived.item.size()) ==
               par::block_range(block.info.cell_ids(), comm.rank(), comm.size()).count());

  // Equal keys arrive in order of their cells: ranks ascend, and with them the cells' numbers.
  assign_array(route.place, arrived.item.size(), 0U);
  std::uint32_t next = 0;
  for (const auto i : sorted_order(arrived.item)) route.place[i] = next++;

  constexpr std::size_t cells_of_round = std::size_t{1} << 17U;
  const auto n_departing = key.size() - (route.begin[here + 1] - route.begin[here]);
  route.rounds = comm.max(static_cast<std::int64_t>((n_departing + cells_of_round - 1) / cells_of_round));
  return route;
}

std::vector<GlobalId> new_numbers(const par::Comm& comm, const Route& route, IdRange cells) {
  const auto first = par::block_range(cells, comm.rank(), comm.size()).begin;
  std::vector<par::Outgoing<GlobalId>> answers;
  for (std::size_t r = 0; r + 1 < route.first.size(); ++r) {
    if (route.first[r] == route.first[r + 1]) continue;
    auto& out = answers.emplace_back(par::Outgoing<GlobalId>{static_cast<Rank>(r), {}}).item;
    reserve_array(out, route.first[r + 1] - route.first[r]);
    for (auto i = route.first[r]; i < route.first[r + 1]; ++i)
      out.push_back(first + static_cast<GlobalId>(route.place[i]));
  }
  const auto answered = comm.sparse_exchange(answers);
  PAMR_ENSURES(answered.item.size() == route.order.size());
  std::vector<GlobalId> number;
  assign_array(number, route.order.size(), GlobalId{0});
  // the parts, ranks ascending, are the sorted cells from front to back
  for (std::size_t i = 0; i < route.order.size(); ++i) number[route.order[i]] = answered.item[i];
  return number;
}

}  // namespace pamr::order
