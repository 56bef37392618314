// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/legacy_words.hpp"

#include <fmt/format.h>

#include <cctype>
#include <string>

namespace pamr::io::vtk {

void skip_blank_lines(TextCursor& in) {
  while (!in.at_end() && std::isspace(static_cast<unsigned char>(in.rest().front())) != 0) in.pass(1);
}

std::string_view next_word(TextCursor& in, std::string_view what) {
  if (in.is_line_over('\n')) in.fail(std::string(what), "the end of the line");
  const auto rest = in.rest();
  const auto text = rest.substr(0, rest.find_first_of(" \t\r\n"));
  in.pass(text.size());
  return text;
}

std::int64_t next_count(TextCursor& in, std::string_view what) {
  return in.checked_count(in.integer_in_line(fmt::format("the number of {}", what)), 1, what);
}

bool skip_metadata(TextCursor& in) {
  (void)in.line();
  bool names_components = false;
  while (!in.at_end()) {
    const auto line = in.line();
    if (line.empty()) break;
    names_components = names_components || line.starts_with("COMPONENT_NAMES");
  }
  return names_components;
}

}  // namespace pamr::io::vtk
