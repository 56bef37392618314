// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/select_smallest.hpp"

#include <algorithm>

namespace pamr::par {

namespace {

constexpr std::size_t bytes_per_word = 8;

std::size_t byte_of(const SortKey& key, std::size_t digit) {
  return static_cast<std::size_t>(key[digit / bytes_per_word] >> (56U - 8U * (digit % bytes_per_word)) & 0xffU);
}

}  // namespace

std::vector<std::uint8_t> select_smallest(const Comm& comm, std::span<const SortKey> key, Exact<std::int64_t> count) {
  std::vector<std::uint8_t> chosen(key.size(), 0);
  std::vector<std::size_t> open(key.size());  // keys that share the digits decided so far
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  std::int64_t wanted = std::max<std::int64_t>(count, 0);  // how many of the open keys are to be taken
  std::int64_t n_open = comm.sum(static_cast<std::int64_t>(open.size()));

  for (std::size_t digit = 0; digit < std::tuple_size_v<SortKey> * bytes_per_word; ++digit) {
    if (wanted == 0 || wanted >= n_open) break;
    std::array<std::int64_t, 256> here{};
    for (const auto i : open) ++here[byte_of(key[i], digit)];
    comm.sum_in_place(here);
    std::size_t last = 0;  // the byte value within which the boundary lies
    while (here[last] < wanted) wanted -= here[last++];
    n_open = here[last];
    std::vector<std::size_t> still_open;
    for (const auto i : open) {
      const auto byte = byte_of(key[i], digit);
      if (byte < last) chosen[i] = 1;
      if (byte == last) still_open.push_back(i);
    }
    open = std::move(still_open);
  }

  const std::int64_t before = comm.exclusive_sum(static_cast<std::int64_t>(open.size()));
  for (std::size_t k = 0; k < open.size(); ++k)
    if (before + static_cast<std::int64_t>(k) < wanted) chosen[open[k]] = 1;
  return chosen;
}

}  // namespace pamr::par
