// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/equal_work.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "pamr/base/contract.hpp"

namespace pamr::par {

namespace {

template <class Weight>
std::vector<Rank> cut(const Comm& comm, std::span<const Weight> weight, Rank n_runs) {
  const auto of_rank = comm.all_gather(std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const auto total = std::accumulate(of_rank.begin(), of_rank.end(), std::int64_t{0});
  PAMR_EXPECTS(weight.empty() || (total > 0 && total <= std::numeric_limits<std::int64_t>::max() / (2 * n_runs)));
  auto before = std::accumulate(of_rank.begin(), of_rank.begin() + comm.rank(), std::int64_t{0});
  // twice the weight up to the middle of an item, and where the next run begins in the same measure, times the runs
  auto run = weight.empty() ? std::int64_t{0} : before * n_runs / total;
  std::vector<Rank> result;
  result.reserve(weight.size());
  for (const std::int64_t w : weight) {
    while (run + 1 < n_runs && (2 * before + w) * n_runs >= (run + 1) * 2 * total) ++run;
    result.push_back(static_cast<Rank>(run));
    before += w;
  }
  return result;
}

}  // namespace

std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::int64_t> weight, Rank n_runs) {
  return cut(comm, weight, n_runs);
}

std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::uint8_t> weight, Rank n_runs) {
  return cut(comm, weight, n_runs);
}

}  // namespace pamr::par
