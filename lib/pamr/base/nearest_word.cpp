// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/nearest_word.hpp"

#include <algorithm>
#include <array>

namespace pamr {

namespace {

/// Least number of letters to insert, delete, replace or swap with their neighbor (optimal string alignment).
std::size_t changes_between(std::string_view a, std::string_view b) {
  std::array<std::vector<std::size_t>, 3> row;  // of two letters ago, of the last one, of this one
  for (auto& r : row) r.resize(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[2][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::rotate(row.begin(), row.begin() + 1, row.end());
    row[2][0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = row[1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[2][j] = std::min({row[1][j] + 1, row[2][j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[2][j] = std::min(row[2][j], row[0][j - 2] + 1);
    }
  }
  return row[2][b.size()];
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 64;  // no key or name is longer; a cost bound for arbitrary input
  if (word.size() > longest) return std::nullopt;
  std::size_t least = word.size() / 3 + 1;
  std::optional<std::string> result;
  for (const auto& candidate : known) {
    if (candidate.size() > longest) continue;
    const auto changes = changes_between(word, candidate);
    if (changes >= least) continue;
    least = changes;
    result = candidate;
  }
  return result;
}

}  // namespace pamr
