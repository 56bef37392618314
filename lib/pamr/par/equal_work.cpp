// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/equal_work.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "pamr/base/contract.hpp"

namespace pamr::par {

namespace {

/// Where runs begin, in twice the weight of all that is before: twice the total, cut into `n_runs` equal shares.
class Beginnings {
 public:
  Beginnings(std::int64_t total, Rank n_runs)
      : n_runs_(n_runs), share_(2 * total / n_runs), rest_(2 * total % n_runs) {}

  /// `run * 2 * total / n_runs`, rounded up, without ever forming the product.
  std::int64_t operator[](std::int64_t run) const { return run * share_ + (run * rest_ + n_runs_ - 1) / n_runs_; }

  /// The last run that begins at `place` or before.
  std::int64_t run_at(std::int64_t place) const {
    std::int64_t first = 0;
    for (std::int64_t end = n_runs_; end - first > 1;) {
      const auto middle = (first + end) / 2;
      ((*this)[middle] <= place ? first : end) = middle;
    }
    return first;
  }

 private:
  std::int64_t n_runs_, share_, rest_;
};

template <class Weight>
std::vector<Rank> cut(const Comm& comm, std::span<const Weight> weight, Rank n_runs) {
  const auto of_rank = comm.all_gather(std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const auto total = std::accumulate(of_rank.begin(), of_rank.end(), std::int64_t{0});
  PAMR_EXPECTS(n_runs > 0 && total <= std::numeric_limits<std::int64_t>::max() / 4);
  PAMR_EXPECTS(weight.empty() || total > 0);
  auto before = std::accumulate(of_rank.begin(), of_rank.begin() + comm.rank(), std::int64_t{0});
  const Beginnings beginning(total, n_runs);
  auto run = beginning.run_at(2 * before);
  auto next = beginning[run + 1];
  std::vector<Rank> result;
  result.reserve(weight.size());
  for (const std::int64_t w : weight) {
    for (; run + 1 < n_runs && 2 * before + w >= next; next = beginning[run + 1]) ++run;
    result.push_back(static_cast<Rank>(run));
    before += w;
  }
  return result;
}

}  // namespace

std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::int64_t> weight, Exact<Rank> n_runs) {
  return cut(comm, weight, n_runs);
}

std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::uint8_t> weight, Exact<Rank> n_runs) {
  return cut(comm, weight, n_runs);
}

}  // namespace pamr::par
