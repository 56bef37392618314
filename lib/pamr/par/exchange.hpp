// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::par {

/// A symmetric pattern of shared things, built once and used many times. Slot `k` of neighbor `i` (slots
/// `offset[i] .. offset[i+1]`) stands for local item `item[k]`, and means the same thing on both sides: the two ranks
/// list what they share in the same order. Neighbors ascending, never this rank.
struct Pattern {
  std::vector<Rank> rank;
  std::vector<std::size_t> offset{0};
  std::vector<LocalId> item;

  std::size_t n_slots() const { return item.size(); }
};

/// Swaps one value per slot with the neighbors of a pattern. Every call is collective over the neighbors and sends
/// one message to each.
class Exchange {
 public:
  Exchange(const Comm& comm, const Pattern& pattern) : comm_(&comm), pattern_(&pattern) {}

  const Pattern& pattern() const { return *pattern_; }
  /// How many slots are those of neighbors with a lower rank than this one: the first ones.
  std::size_t n_slots_of_lower_ranks() const {
    const auto& rank = pattern_->rank;
    return pattern_
        ->offset[static_cast<std::size_t>(std::lower_bound(rank.begin(), rank.end(), comm_->rank()) - rank.begin())];
  }

  /// What the other side put into each slot. `mine` has `n_slots` entries in slot order.
  template <class T>
  std::vector<T> swap(std::span<const T> mine) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> theirs(mine.size());
    std::vector<std::span<const std::byte>> send;
    std::vector<std::span<std::byte>> receive;
    for (std::size_t i = 0; i < pattern_->rank.size(); ++i) {
      const auto begin = pattern_->offset[i], count = pattern_->offset[i + 1] - begin;
      send.push_back(std::as_bytes(mine.subspan(begin, count)));
      receive.push_back(std::as_writable_bytes(std::span<T>(theirs).subspan(begin, count)));
    }
    comm_->neighbor_exchange(pattern_->rank, send, receive);
    return theirs;
  }

 private:
  const Comm* comm_;
  const Pattern* pattern_;
};

/// Combines what the holders of shared items have: swaps `value_of(item)` in every slot and calls `take(item, theirs)`
/// once for each other holder of each shared item, their ranks ascending. Collective: one exchange.
template <class ValueOf, class Take>
requires std::is_invocable_v<ValueOf, LocalId>
void fold_shared(const Exchange& exchange, ValueOf&& value_of, Take&& take) {
  const auto& item = exchange.pattern().item;
  using T = std::decay_t<std::invoke_result_t<ValueOf, LocalId>>;
  std::vector<T> mine;
  mine.reserve(item.size());
  for (const auto i : item) mine.push_back(value_of(i));
  const auto theirs = exchange.swap<T>(mine);
  for (std::size_t k = 0; k < theirs.size(); ++k) take(item[k], theirs[k]);
}

/// The same in place for a value of each item, shared or not: `join(mine, theirs)` changes `mine`. All holders end with
/// the same value if the order of joins does not matter; sums of doubles take `fold_in_rank_order`.
template <class T, class Join>
void fold_shared(const Exchange& exchange, std::vector<T>& of_item, Join&& join) {
  fold_shared(
      exchange, [&](LocalId i) -> const T& { return of_item[at(i)]; },
      [&](LocalId i, const T& theirs) { join(of_item[at(i)], theirs); });
}

/// Raises flags at every holder of an item where one has raised it. Collective: one exchange.
void fold_flags(const Exchange& exchange, std::vector<std::uint8_t>& flag_of_item);

/// Replaces the value of each shared item by those of all its holders, joined in the order of their ranks:
/// `join(join(a, b), c)`. All holders get the same bits for any `join`. Collective: one exchange.
template <class T, class Join>
void fold_in_rank_order(const Exchange& exchange, std::vector<T>& of_item, Join&& join) {
  const auto& item = exchange.pattern().item;
  std::vector<T> mine;
  mine.reserve(item.size());
  for (const auto i : item) mine.push_back(of_item[at(i)]);
  const auto theirs = exchange.swap<T>(mine);
  const auto n_lower = exchange.n_slots_of_lower_ranks();
  std::vector<T> lower(of_item.size());
  std::vector<std::uint8_t> has_lower(of_item.size(), 0);
  for (std::size_t k = 0; k < n_lower; ++k) {
    const auto i = at(item[k]);
    lower[i] = has_lower[i] != 0 ? join(lower[i], theirs[k]) : theirs[k];
    has_lower[i] = 1;
  }
  for (std::size_t i = 0; i < of_item.size(); ++i)
    if (has_lower[i] != 0) of_item[i] = join(lower[i], of_item[i]);
  for (auto k = n_lower; k < item.size(); ++k) of_item[at(item[k])] = join(of_item[at(item[k])], theirs[k]);
}

/// For each of `n_items` items 1 if no lower rank holds it, so that one holder of each counts or numbers it. Local.
std::vector<std::uint8_t> held_first_here(const Exchange& exchange, Exact<std::size_t> n_items);

/// The slots of a pattern for which `new_item(slot)` is not `invalid_local`, with these items. Neighbors must keep the
/// same slots. Local.
template <class NewItem>
Pattern restricted(const Pattern& whole, NewItem&& new_item) {
  Pattern part;
  for (std::size_t i = 0; i < whole.rank.size(); ++i) {
    for (auto k = whole.offset[i]; k < whole.offset[i + 1]; ++k)
      if (const LocalId item = new_item(k); item != invalid_local) part.item.push_back(item);
    if (part.item.size() == part.offset.back()) continue;
    part.rank.push_back(whole.rank[i]);
    part.offset.push_back(part.item.size());
  }
  return part;
}

/// Name of a thing that several ranks may hold: its global node numbers in ascending order, padded with -1.
using SharedKey = std::array<GlobalId, 3>;

/// Finds which ranks hold the same keys. `key[i]` names local item `i`; no key occurs twice on a rank. The pattern
/// lists, for each neighbor, the items held by both, in an order that follows from the keys and the number of ranks.
/// Collective: two sparse exchanges through a meeting rank chosen from the key; time, memory and bytes O(keys).
Pattern find_shared(const Comm& comm, std::span<const SharedKey> key);

/// Rows `ids` (any order, repeats allowed) of an array with a row for each of `all` in canonical block distribution:
/// `rows` holds this rank's block, `width` values a row. Collective: two sparse exchanges.
template <class T>
std::vector<T> fetch_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                          std::span<const GlobalId> ids);

/// The reverse: sends row `i` of `rows` to the block that holds row `ids[i]` of `all` and returns this rank's block. Of
/// rows given more than once the last counts, ranks ascending; rows given by none are value-initialized. Collective:
/// two sparse exchanges.
template <class T>
std::vector<T> scatter_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                            std::span<const GlobalId> ids);

/// The same into a block that is there, of rows as wide as those of `rows`: rows given by none stay as they are.
/// Collective: two sparse exchanges.
template <class T>
void scatter_rows_into(const Comm& comm, IdRange all, std::span<const T> rows, std::span<const GlobalId> ids,
                       std::span<T> block);

/// Calls `work(begin, end)` with at most `most` of this rank's `n` items at a time, one range after another and equally
/// often on every rank, so that `work` may be collective; where items are few, with empty ranges at the end. What an
/// exchange needs on the side is then bounded. Collective: one reduction.
template <class Work>
void in_rounds(const Comm& comm, Exact<std::size_t> n, Exact<std::size_t> most, Work&& work) {
  const auto rounds = comm.max(static_cast<std::int64_t>((n + most - 1) / most));
  for (std::size_t k = 0; k < static_cast<std::size_t>(rounds); ++k)
    work(std::min<std::size_t>(n, k * most), std::min<std::size_t>(n, (k + 1) * most));
}

}  // namespace pamr::par

#include "pamr/par/rows.ipp"
