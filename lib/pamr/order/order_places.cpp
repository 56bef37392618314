// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_places.hpp"

#include <algorithm>
#include <tuple>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/sorted_order.hpp"

// A sample sort: every rank sorts its cells, regular samples of all give the borders between the ranks' parts of the
// curve, every part is sorted where it lies, and the places go back. What the samples are decides who works how much,
// never the result.
namespace pamr::order {

namespace {

/// Samples for each rank: parts differ by at most one part in this many for each rank that sends to them.
constexpr GlobalId samples_of_rank = 64;

struct Stop {
  std::uint64_t key = 0;
  GlobalId cell = 0;
  friend bool operator<(const Stop& a, const Stop& b) { return std::tie(a.key, a.cell) < std::tie(b.key, b.cell); }
};

/// First stop of each rank's part but the first rank's. `stops`: those of this rank's cells, ascending. Collective.
std::vector<Stop> choose_borders(const par::Comm& comm, GlobalId n_cells, const std::vector<Stop>& stops) {
  const auto stride = static_cast<std::size_t>(std::max<GlobalId>(1, n_cells / (samples_of_rank * comm.size())));
  std::vector<par::Outgoing<Stop>> messages{{0, {}}};
  for (auto i = stride / 2; i < stops.size(); i += stride) messages[0].item.push_back(stops[i]);
  auto samples = comm.sparse_exchange(messages).item;
  std::sort(samples.begin(), samples.end());
  std::vector<Stop> borders;
  for (Rank r = 1; r < comm.size() && !samples.empty(); ++r)
    borders.push_back(samples[samples.size() * static_cast<std::size_t>(r) / static_cast<std::size_t>(comm.size())]);
  return comm.broadcast(borders);
}

}  // namespace

std::vector<GlobalId> places_along_curve(const par::Comm& comm, const mesh::BlockMesh& block,
                                         std::span<const std::uint64_t> key) {
  const auto order = sorted_order(key);
  std::vector<Stop> stops;
  reserve_array(stops, order.size());
  for (const auto c : order) stops.push_back({key[c], block.first_cell + static_cast<GlobalId>(c)});
  const auto borders = choose_borders(comm, block.info.n_global_cells, stops);

  std::vector<par::Outgoing<Stop>> parts;
  for (auto begin = stops.begin(); begin != stops.end();) {
    const auto border = std::upper_bound(borders.begin(), borders.end(), *begin);
    const auto end = border == borders.end() ? stops.end() : std::lower_bound(begin, stops.end(), *border);
    parts.push_back({static_cast<Rank>(border - borders.begin()), {begin, end}});
    begin = end;
  }
  free_array(stops);

  // Equal keys arrive in order of their cells: ranks ascend, and with them the cells' numbers.
  const auto arrived = comm.sparse_exchange(parts);
  std::vector<std::uint64_t> keys;
  reserve_array(keys, arrived.item.size());
  for (const auto& stop : arrived.item) keys.push_back(stop.key);
  const auto first = block.info.first_id + comm.exclusive_sum(static_cast<std::int64_t>(keys.size()));
  const auto sorted = sorted_order(keys);
  std::vector<GlobalId> place;
  assign_array(place, keys.size(), GlobalId{0});
  for (std::size_t i = 0; i < sorted.size(); ++i) place[sorted[i]] = first + static_cast<GlobalId>(i);

  std::vector<par::Outgoing<GlobalId>> answers;
  for (std::size_t r = 0; r < arrived.rank.size(); ++r)
    answers.push_back({arrived.rank[r],
                       {place.begin() + static_cast<std::ptrdiff_t>(arrived.offset[r]),
                        place.begin() + static_cast<std::ptrdiff_t>(arrived.offset[r + 1])}});
  const auto answered = comm.sparse_exchange(answers);
  PAMR_ENSURES(answered.item.size() == order.size());
  std::vector<GlobalId> result;
  assign_array(result, order.size(), GlobalId{0});
  // the parts, ranks ascending, are the sorted cells from front to back
  for (std::size_t i = 0; i < order.size(); ++i) result[order[i]] = answered.item[i];
  return result;
}

}  // namespace pamr::order
