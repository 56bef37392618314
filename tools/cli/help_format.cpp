// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/help_format.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <utility>
#include <vector>

namespace pamr::cli {

namespace {

class HelpFormat : public CLI::Formatter {
 public:
  explicit HelpFormat(std::size_t width) : width_(width) {}

  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(option->get_description(), width_ - get_column_width());
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_name(), wrapped(command->get_description(), width_ - get_column_width()),
                             get_column_width());
    return out.str();
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), width_) + "\n";
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return Formatter::make_usage(app, std::move(name)) + "\n";
  }
  std::string make_positionals(const CLI::App* app) const override {
    const auto text = Formatter::make_positionals(app);
    return text.empty() ? text : text + "\n";
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    auto text = Formatter::make_group(group, is_positional, std::move(options)).substr(1);  // without an empty line
    const auto example = get_label(group);
    return example == group ? text : text + example_lines("Example: " + example, width_);
  }

 private:
  std::size_t width_;
};

}  // namespace

std::size_t help_width() {
  constexpr int least = 60, usual = 80, most = 100;
  int columns = 0;
  if (const char* given = std::getenv("COLUMNS"); given != nullptr)
    columns = static_cast<int>(std::strtol(given, nullptr, 10));
  if (winsize size{}; columns <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  return static_cast<std::size_t>(columns <= 0 ? usual : std::clamp(columns, least, most));
}

std::string wrapped(const std::string& text, std::size_t width, const std::string& next) {
  const auto line_break = next.find('\n');
  const auto indent = next.size() - line_break - 1;
  std::string result;
  std::size_t column = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (column > indent && column + 1 + word.size() + line_break > width) {
      result += next;
      column = indent;
    } else if (column > 0) {
      result += ' ';
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result;
}

std::string example_lines(const std::string& examples, std::size_t width) {
  std::string result;
  std::istringstream lines(examples);
  for (std::string line; std::getline(lines, line);) result += "  " + wrapped(line, width - 2, " \\\n      ") + "\n";
  return result;
}

std::shared_ptr<CLI::FormatterBase> help_format(std::size_t width) { return std::make_shared<HelpFormat>(width); }

}  // namespace pamr::cli
