// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/pair_rows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pamr/base/hash.hpp"

namespace pamr::check {

namespace {

using Row = std::span<const std::uint64_t>;

/// Rows that have met their like on this rank, in the order of key, columns and number.
class MetRows {
 public:
  MetRows(const par::Comm& comm, const Rows& rows, std::size_t n_columns)
      : n_keys_(rows.n_keys), width_(rows.n_keys + 1 + n_columns) {
    std::vector<par::Outgoing<std::uint64_t>> messages;
    for (Rank r = 0; r < comm.size(); ++r) messages.push_back({r, {}});
    for (std::size_t at = 0; at < rows.word.size(); at += width_) {
      const Row row = Row(rows.word).subspan(at, width_);
      std::uint64_t hash = 0;
      for (const auto key : row.first(n_keys_)) hash = combine(hash, key);
      auto& out = messages[static_cast<std::size_t>(hash % static_cast<std::uint64_t>(comm.size()))].item;
      out.insert(out.end(), row.begin(), row.end());
    }
    std::erase_if(messages, [](const auto& message) { return message.item.empty(); });
    word_ = comm.sparse_exchange(messages).item;
    order_.resize(word_.size() / width_);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) { return comes_before(i, j); });
    const auto is_copy = [&](std::size_t i, std::size_t j) { return std::ranges::equal(row(i), row(j)); };
    order_.erase(std::unique(order_.begin(), order_.end(), is_copy), order_.end());
  }

  std::size_t size() const { return order_.size(); }
  Row key(std::size_t i) const { return row(order_[i]).first(n_keys_); }
  GlobalId number(std::size_t i) const { return static_cast<GlobalId>(row(order_[i])[n_keys_]); }
  Row columns(std::size_t i) const { return row(order_[i]).subspan(n_keys_ + 1); }

 private:
  Row row(std::size_t i) const { return Row(word_).subspan(i * width_, width_); }
  bool comes_before(std::size_t i, std::size_t j) const {
    const auto a = row(i), b = row(j);
    const auto keys = std::lexicographical_compare_three_way(a.begin(), a.begin() + std::ptrdiff_t(n_keys_), b.begin(),
                                                             b.begin() + std::ptrdiff_t(n_keys_));
    if (keys != 0) return keys < 0;
    const auto values = std::lexicographical_compare_three_way(a.begin() + std::ptrdiff_t(n_keys_) + 1, a.end(),
                                                               b.begin() + std::ptrdiff_t(n_keys_) + 1, b.end());
    return values != 0 ? values < 0 : a[n_keys_] < b[n_keys_];
  }

  std::size_t n_keys_, width_;
  std::vector<std::uint64_t> word_;
  std::vector<std::size_t> order_;
};

void add(Tally& tally, GlobalId number, double difference) {
  tally.first = tally.count == 0 ? number : std::min(tally.first, number);
  ++tally.count;
  tally.largest = std::max(tally.largest, difference);
}

void compare(std::uint64_t a, std::uint64_t b, Column column, double tolerance, GlobalId number, Tally& tally) {
  if (a == b) return;
  if (column == Column::exact) return add(tally, number, 0);
  if (column == Column::integer) {
    const auto x = static_cast<std::int64_t>(a), y = static_cast<std::int64_t>(b);
    const double difference = std::abs(static_cast<double>(x) - static_cast<double>(y));
    if (tolerance == 0 || difference > tolerance) add(tally, number, difference);
    return;
  }
  const auto x = std::bit_cast<double>(a), y = std::bit_cast<double>(b);
  if (x == y || (std::isnan(x) && std::isnan(y))) return;
  const double difference = std::abs(x - y);
  if (!(difference <= tolerance * std::max({1.0, std::abs(x), std::abs(y)})) || std::isinf(difference))
    add(tally, number, std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference);
}

void total(const par::Comm& comm, Tally& tally) {
  constexpr GlobalId none = std::numeric_limits<GlobalId>::max();
  const GlobalId first = comm.min(tally.count > 0 ? tally.first : none);
  tally = {comm.sum(tally.count), first == none ? invalid_global : first, comm.max(tally.largest)};
}

}  // namespace

Pairing pair_rows(const par::Comm& comm, const Rows& a, const Rows& b, std::span<const Column> columns,
                  double tolerance) {
  const MetRows in_a(comm, a, columns.size()), in_b(comm, b, columns.size());
  Pairing result;
  result.column.resize(columns.size());
  std::size_t i = 0, j = 0;
  while (i < in_a.size() || j < in_b.size()) {
    std::strong_ordering order = std::strong_ordering::equal;
    if (i == in_a.size())
      order = std::strong_ordering::greater;
    else if (j == in_b.size())
      order = std::strong_ordering::less;
    else
      order = std::lexicographical_compare_three_way(in_a.key(i).begin(), in_a.key(i).end(), in_b.key(j).begin(),
                                                     in_b.key(j).end());
    if (order < 0) {
      add(result.only_in_a, in_a.number(i++), 0);
    } else if (order > 0) {
      add(result.only_in_b, in_b.number(j++), 0);
    } else {
      for (std::size_t c = 0; c < columns.size(); ++c)
        compare(in_a.columns(i)[c], in_b.columns(j)[c], columns[c], tolerance, in_a.number(i), result.column[c]);
      ++i, ++j;
    }
  }
  total(comm, result.only_in_a);
  total(comm, result.only_in_b);
  for (auto& tally : result.column) total(comm, tally);
  return result;
}

}  // namespace pamr::check
