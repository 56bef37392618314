// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/renumber.hpp"

#include <cstdint>

#include "pamr/par/exchange.hpp"

namespace pamr::par {

Renumbered renumber(const Comm& comm, IdRange all, std::span<const GlobalId> ids) {
  const std::vector<std::uint8_t> ones(ids.size(), 1);
  const auto is_named = scatter_rows<std::uint8_t>(comm, all, ones, 1, ids);
  std::vector<GlobalId> number(is_named.size(), 0);
  std::int64_t count = 0;
  for (std::size_t i = 0; i < is_named.size(); ++i)
    if (is_named[i] != 0) number[i] = count++;
  const auto before = comm.exclusive_sum(count);
  for (auto& one : number) one += before;
  return {comm.sum(count), fetch_rows<GlobalId>(comm, all, number, 1, ids)};
}

}  // namespace pamr::par
