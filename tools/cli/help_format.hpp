// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace CLI {
class FormatterBase;
}

namespace pamr::cli {

/// Columns of --help: the variable COLUMNS or the terminal's size, from 60 to 100; 80 where standard output is no
/// terminal. Local.
std::size_t help_width();

/// The words of `text` in lines of at most `width` columns, as far as single words allow it. `next` stands where a line
/// is broken: it ends with what begins the next one ("\n", or " \\\n    " in a command). Local.
std::string wrapped(const std::string& text, std::size_t width, const std::string& next = "\n");

/// Command lines, one a line of `examples`, each indented and wrapped. Local.
std::string example_lines(const std::string& examples, std::size_t width);

/// How --help is laid out: everything wrapped at `width`, one heading a group of options, and below the options of a
/// group its example, which is the formatter's label of the group's name. Local.
std::shared_ptr<CLI::FormatterBase> help_format(std::size_t width);

}  // namespace pamr::cli
