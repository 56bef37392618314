// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>

namespace pamr {

/// How a list reads.
struct Listing {
  std::string_view before_last = ", ";  ///< before the last item of a list that is shown to its end: " and ", " or "
  std::size_t most = 10;                ///< items that are shown; ", ..." stands for the others
};

inline constexpr std::size_t all_items = static_cast<std::size_t>(-1);  ///< for `Listing::most`

/// "A, B, C": the items of a list in a message, by default the first ten; empty for none. `text`: makes a text of an
/// item, or the member that is one. Local.
template <class Items, class Text = std::identity>
std::string listed(const Items& items, Listing how = {}, Text text = {}) {
  const std::size_t n = std::size(items), n_shown = std::min(n, how.most);
  std::string line;
  std::size_t i = 0;
  for (auto item = std::begin(items); i < n_shown; ++item, ++i) {
    if (i > 0) line += i + 1 == n ? how.before_last : ", ";
    line += std::invoke(text, *item);
  }
  return n > n_shown ? line + ", ..." : line;
}

}  // namespace pamr
