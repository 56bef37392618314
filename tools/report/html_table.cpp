// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/html_table.hpp"

#include <fmt/format.h>

namespace pamr::report {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string grouped(std::int64_t count) {
  auto digits = std::to_string(count);
  for (std::ptrdiff_t i = std::ssize(digits) - 3; i > (count < 0 ? 1 : 0); i -= 3)
    digits.insert(static_cast<std::size_t>(i), ",");
  return digits;
}

std::string short_number(double value) { return fmt::format("{:.6g}", value); }

void HtmlTable::add(const std::vector<std::string>& cells, const std::string& attributes) {
  rows_ += "<tr" + attributes + ">";
  for (std::size_t i = 0; i < cells.size(); ++i)
    rows_ += i < n_names_ ? "<th scope=\"row\">" + escaped(cells[i]) + "</th>" : "<td>" + escaped(cells[i]) + "</td>";
  rows_ += "</tr>\n";
}

std::string HtmlTable::text() const {
  std::string head;
  for (std::size_t i = 0; i < heads_.size(); ++i)
    head += (i < n_names_ ? "<th scope=\"col\" class=\"name\">" : "<th scope=\"col\">") + escaped(heads_[i]) + "</th>";
  return "<div class=\"table\"><table><caption>" + escaped(caption_) + "</caption>\n<thead><tr>" + head +
         "</tr></thead>\n<tbody>\n" + rows_ + "</tbody></table></div>\n";
}

}  // namespace pamr::report
