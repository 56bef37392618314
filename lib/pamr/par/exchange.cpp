// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/exchange.hpp"

#include <algorithm>
#include <numeric>

#include "pamr/base/hash.hpp"

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

template <class T>
std::vector<Outgoing<T>> non_empty(std::vector<std::vector<T>>& by_rank) {
  std::vector<Outgoing<T>> out;
  for (std::size_t r = 0; r < by_rank.size(); ++r)
    if (!by_rank[r].empty()) out.push_back({static_cast<Rank>(r), std::move(by_rank[r])});
  return out;
}

/// For every key that several ranks sent: what each of them has to know about the others.
std::vector<Outgoing<Match>> introduce(const Received<Card>& cards, Rank size) {
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
  std::vector<std::vector<Match>> matches(static_cast<std::size_t>(size));
  for (std::size_t begin = 0, end = 0; begin < holders.size(); begin = end) {
    while (end < holders.size() && holders[end].card.key == holders[begin].card.key) ++end;
    for (auto i = begin; i < end; ++i)
      for (auto j = begin; j < end; ++j)
        if (i != j)
          matches[static_cast<std::size_t>(holders[i].rank)].push_back(
              {holders[i].card.key, holders[i].card.item, holders[j].rank});
  }
  return non_empty(matches);
}

}  // namespace

Pattern find_shared(const Comm& comm, std::span<const SharedKey> key) {
  std::vector<std::vector<Card>> cards(static_cast<std::size_t>(comm.size()));
  for (std::size_t i = 0; i < key.size(); ++i)
    cards[static_cast<std::size_t>(meeting_rank(key[i], comm.size()))].push_back(
        {key[i], static_cast<std::int64_t>(i)});
  const auto told = comm.sparse_exchange(introduce(comm.sparse_exchange(non_empty(cards)), comm.size()));

  auto matches = told.item;
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.rank != b.rank ? a.rank < b.rank : a.key < b.key; });
  Pattern pattern;
  for (const auto& match : matches) {
    if (pattern.rank.empty() || pattern.rank.back() != static_cast<Rank>(match.rank)) {
      pattern.rank.push_back(static_cast<Rank>(match.rank));
      pattern.offset.push_back(pattern.item.size());
    }
    pattern.item.push_back(static_cast<LocalId>(match.item));
    pattern.offset.back() = pattern.item.size();
  }
  return pattern;
}

}  // namespace pamr::par
