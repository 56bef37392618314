// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/exchange.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::par {

namespace {

/// A key on its way to its meeting rank; `item` is its index on the rank it comes from.
struct Card {
  SharedKey key;
  std::int64_t item;
};

/// Told by the meeting rank to a holder: your item is held by `rank` too.
struct Match {
  std::int32_t item;
  Rank rank;
};

std::uint64_t hash_of(const SharedKey& key) {
  return mix(static_cast<std::uint64_t>(key[0]) + 0x9e3779b97f4a7c15U * static_cast<std::uint64_t>(key[1]) +
             0xc2b2ae3d27d4eb4fU * static_cast<std::uint64_t>(key[2]));
}

/// The rank on which the holders of a key meet: by the lower half of its hash.
Rank meeting_rank(const SharedKey& key, Rank size) {
  return static_cast<Rank>((hash_of(key) & 0xffffffffU) * static_cast<std::uint64_t>(size) >> 32U);
}

/// Cards in an order in which equal keys stand together, those of one key in the order in which they came: dealt into
/// as many buckets as there are cards by the hash, then put in order within each, which holds one key or two.
std::vector<std::uint32_t> group_by_key(std::span<const Card> cards) {
  narrow<LocalId>(std::ssize(cards));
  // the lower half said which rank they meet on
  const auto shift = 64U - static_cast<unsigned>(std::bit_width(cards.size() | 1U));
  std::vector<std::uint32_t> bucket, end((std::size_t{1} << (64U - shift)) + 1, 0), order(cards.size());
  bucket.reserve(cards.size());
  for (const auto& card : cards) {
    bucket.push_back(static_cast<std::uint32_t>(hash_of(card.key) >> shift));
    ++end[bucket.back() + 1];
  }
  for (std::size_t b = 1; b < end.size(); ++b) end[b] += end[b - 1];
  auto& next = end;  // of each bucket its begin, which moves to its end
  for (std::size_t i = 0; i < cards.size(); ++i) order[next[bucket[i]]++] = static_cast<std::uint32_t>(i);
  for (std::size_t begin = 0, b = 0; b + 1 < next.size(); begin = next[b++])
    if (next[b] - begin > 1)
      std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + next[b],
                       [&](std::uint32_t x, std::uint32_t y) { return cards[x].key < cards[y].key; });
  return order;
}

/// For every key that several ranks sent: tells each of them about the others.
Received<Match> introduce(const Comm& comm, const Received<Card>& cards) {
  std::vector<Rank> sender;
  sender.reserve(cards.item.size());
  for (std::size_t r = 0; r < cards.rank.size(); ++r) sender.resize(cards.offset[r + 1], cards.rank[r]);
  const auto order = group_by_key(cards.item);
  Mailbox<Match> matches(comm);
  for (std::size_t r = 0; r < cards.rank.size(); ++r) matches.reserve(cards.rank[r], cards.from(r).size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && cards.item[order[end]].key == cards.item[order[begin]].key) ++end;
    for (auto i = begin; i < end; ++i)
      for (auto j = begin; j < end; ++j)
        if (i != j)
          matches.add(sender[order[i]], {static_cast<std::int32_t>(cards.item[order[i]].item), sender[order[j]]});
  }
  return matches.send();
}

}  // namespace

void fold_flags(const Exchange& exchange, std::vector<std::uint8_t>& flag_of_item) {
  fold_shared(exchange, flag_of_item, [](std::uint8_t& mine, std::uint8_t theirs) {
    if (theirs != 0) mine = 1;
  });
}

std::vector<std::uint8_t> held_first_here(const Exchange& exchange, Exact<std::size_t> n_items) {
  std::vector<std::uint8_t> is_first(n_items, 1);
  const auto& item = exchange.pattern().item;
  for (std::size_t k = 0; k < exchange.n_slots_of_lower_ranks(); ++k) is_first[at(item[k])] = 0;
  return is_first;
}

Pattern find_shared(const Comm& comm, std::span<const SharedKey> key) {
  narrow<LocalId>(std::ssize(key));
  std::vector<Rank> to(key.size());
  std::vector<std::size_t> count(at(comm.size()), 0);
  for (std::size_t i = 0; i < key.size(); ++i) {
    to[i] = meeting_rank(key[i], comm.size());
    ++count[at(to[i])];
  }
  Mailbox<Card> cards(comm);
  for (Rank rank = 0; rank < comm.size(); ++rank) cards.reserve(rank, count[at(rank)]);
  for (std::size_t i = 0; i < key.size(); ++i) cards.add(to[i], {key[i], static_cast<std::int64_t>(i)});
  // a meeting rank tells all holders of its keys in one order, so what two ranks share comes in one order on both
  auto matches = introduce(comm, cards.send()).item;
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.rank < b.rank; });
  Pattern pattern;
  for (const auto& match : matches) {
    if (pattern.rank.empty() || pattern.rank.back() != match.rank) {
      pattern.rank.push_back(match.rank);
      pattern.offset.push_back(pattern.item.size());
    }
    pattern.item.push_back(match.item);
    pattern.offset.back() = pattern.item.size();
  }
  return pattern;
}

}  // namespace pamr::par
