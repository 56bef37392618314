// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/weighted_blocks.hpp"

#include <numeric>

namespace pamr::balance {

std::vector<Rank> weighted_blocks(const par::Comm& comm, std::span<const std::int64_t> weight) {
  const auto here = std::accumulate(weight.begin(), weight.end(), std::int64_t{0});
  const auto total = comm.sum(here);
  auto before = comm.exclusive_sum(here);
  std::vector<Rank> rank;
  rank.reserve(weight.size());
  for (const auto w : weight) {
    // the cell goes where its middle falls; n * size stays far below 2^63
    rank.push_back(static_cast<Rank>((2 * before + w) * comm.size() / (2 * total)));
    before += w;
  }
  return rank;
}

}  // namespace pamr::balance
