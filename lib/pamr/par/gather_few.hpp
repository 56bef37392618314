// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

}  // namespace pamr::par
