// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "pamr/par/mailbox.hpp"

namespace pamr::par {

/// What all ranks have, in the order of ranks, on every rank: for lists that are short. Collective.
template <class T>
std::vector<T> gather_few(const par::Comm& comm, std::vector<T> here) {
  par::Mailbox<T> box(comm);
  for (auto& item : here) box.add(0, std::move(item));
  return comm.broadcast(box.send().item);
}

/// The values that any rank has, each once, ascending, on every rank: for sets that are small. Collective.
template <class T>
std::vector<T> gather_distinct(const par::Comm& comm, const std::set<T>& here) {
  par::Mailbox<T> box(comm);
  for (const auto& item : here) box.add(0, item);
  auto all = box.send().item;
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return comm.broadcast(std::move(all));
}

}  // namespace pamr::par
