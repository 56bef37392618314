// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/exchange.hpp"

#include <algorithm>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/hash.hpp"
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
  SharedKey key;
  std::int64_t item;
  std::int64_t rank;
};

Rank meeting_rank(const SharedKey& key, Rank size) {
  std::uint64_t h = 0;
  for (const auto id : key) h = combine(h, static_cast<std::uint64_t>(id));
  return static_cast<Rank>(h % static_cast<std::uint64_t>(size));
}

/// For every key that several ranks sent: tells each of them about the others.
Received<Match> introduce(const Comm& comm, const Received<Card>& cards) {
  struct Holder {
    Card card;
    Rank rank;
  };
  std::vector<Holder> holders;
  holders.reserve(cards.item.size());
  for (std::size_t r = 0; r < cards.rank.size(); ++r)
    for (const auto& card : cards.from(r)) holders.push_back({card, cards.rank[r]});
  std::sort(holders.begin(), holders.end(), [](const Holder& a, const Holder& b) {
    return a.card.key != b.card.key ? a.card.key < b.card.key : a.rank < b.rank;
  });
  Mailbox<Match> matches(comm);
  for (std::size_t begin = 0, end = 0; begin < holders.size(); begin = end) {
    while (end < holders.size() && holders[end].card.key == holders[begin].card.key) ++end;
    for (auto i = begin; i < end; ++i)
      for (auto j = begin; j < end; ++j)
        if (i != j) matches.add(holders[i].rank, {holders[i].card.key, holders[i].card.item, holders[j].rank});
  }
  return matches.send();
}

}  // namespace

Pattern find_shared(const Comm& comm, std::span<const SharedKey> key) {
  Mailbox<Card> cards(comm);
  for (std::size_t i = 0; i < key.size(); ++i)
    cards.add(meeting_rank(key[i], comm.size()), {key[i], static_cast<std::int64_t>(i)});
  auto matches = introduce(comm, cards.send()).item;
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.rank != b.rank ? a.rank < b.rank : a.key < b.key; });
  Pattern pattern;
  for (const auto& match : matches) {
    if (pattern.rank.empty() || pattern.rank.back() != static_cast<Rank>(match.rank)) {
      pattern.rank.push_back(static_cast<Rank>(match.rank));
      pattern.offset.push_back(pattern.item.size());
    }
    pattern.item.push_back(narrow<LocalId>(match.item));
    pattern.offset.back() = pattern.item.size();
  }
  return pattern;
}

}  // namespace pamr::par
