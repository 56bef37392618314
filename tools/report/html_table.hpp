// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pamr::report {

/// Text as it stands in a page, attributes included.
std::string escaped(const std::string& text);

/// 59971 as 59,971.
std::string grouped(std::int64_t count);

/// Six digits.
std::string short_number(double value);

/// A table of a page, row by row.
class HtmlTable {
 public:
  /// `n_names`: columns at the left that hold names, the others hold numbers.
  HtmlTable(std::string caption, std::vector<std::string> heads, std::size_t n_names = 1)
      : caption_(std::move(caption)), heads_(std::move(heads)), n_names_(n_names) {}

  /// Plain texts; `attributes` of the row are for the scripts, such as ` data-cell="7"`.
  void add(const std::vector<std::string>& cells, const std::string& attributes = {});
  bool is_empty() const { return rows_.empty(); }
  std::string text() const;

 private:
  std::string caption_;
  std::vector<std::string> heads_;
  std::size_t n_names_;
  std::string rows_;
};

}  // namespace pamr::report
