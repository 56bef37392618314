// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Sorts items by the rank that they are for, to be sent together: at most one message to each rank. 24 bytes a rank
/// in addition to the items.
template <class T>
class Mailbox {
 public:
  explicit Mailbox(const Comm& comm) : comm_(&comm), for_rank_(at(comm.size())) {}

  void add(Exact<Rank> to, T item) { for_rank_[at(to)].push_back(std::move(item)); }

  void reserve(Exact<Rank> to, Exact<std::size_t> n) { for_rank_[at(to)].reserve(n); }

  /// Delivers the items; those from one rank arrive in the order in which they were added there. The box is empty
  /// afterwards. Collective: one sparse exchange.
  Received<T> send() {
    std::vector<Outgoing<T>> messages;
    for (std::size_t r = 0; r < for_rank_.size(); ++r)
      if (!for_rank_[r].empty()) messages.push_back({static_cast<Rank>(r), std::exchange(for_rank_[r], {})});
    return comm_->sparse_exchange(messages);
  }

 private:
  const Comm* comm_;
  std::vector<std::vector<T>> for_rank_;
};

}  // namespace pamr::par
