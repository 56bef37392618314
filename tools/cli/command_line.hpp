// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/exact.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pamr::cli {

/// One option or argument, to say more about: `line.option(...).required().type_name("FILE")`. A handle.
class Option {
 public:
  Option& required();
  /// What stands for the value in --help.
  Option& type_name(const std::string& name);
  /// --help shows the value that the variable has now.
  Option& show_default();

  Option& positive();
  Option& not_negative();
  Option& range(int low, int high);
  Option& range(double low, double high);
  Option& one_of(const std::vector<std::string>& words);
  /// Of a file to write: refuses names with another ending (".csv"); one without any is fine.
  Option& file_ending(const std::string& ending);

  /// May be repeated, with one value each time.
  Option& one_at_a_time();
  /// Splits a value: "1,2,3".
  Option& delimiter(char between);
  Option& needs(const Option& other);
  Option& excludes(const Option& other);

  /// Whether the command line has it; after it was read.
  bool is_given() const;

 private:
  friend class CommandLine;
  explicit Option(CLI::Option* option) : option_(option) {}

  CLI::Option* option_;
};

/// The options and arguments that a tool declares. It keeps CLI11, which takes seconds to compile, out of the tools.
class CommandLine {
 public:
  explicit CommandLine(CLI::App& app) : app_(&app) {}

  /// An option ("-o,--output") or an argument ("MESH") that is read into `value`. T is std::string, int, double,
  /// std::int64_t or std::uint64_t, a std::optional of these two, std::vector<std::string> or
  /// std::vector<std::vector<double>>.
  template <class T>
  Option option(const std::string& name, T& value, const std::string& help);
  template <class T>
  Option option(const std::string& name, Exact<T>& value, const std::string& help);
  Option flag(const std::string& name, bool& value, const std::string& help);

  /// Begins a group of --help: options that are declared from here on stand under this heading, with `example` (one
  /// command line a line) below them. Before the first one the heading is "Options".
  void group(const std::string& heading, const std::string& example);

  /// Options whose order matters: `listed` tells which were given, name and value, in the order of the command line.
  Option listed_option(const std::string& name, const std::string& help);
  Option listed_flag(const std::string& name, bool& value, const std::string& help);
  std::vector<std::pair<std::string, std::string>> listed() const;

  /// A command of its own with options of its own ("pamr-surface info ..."); exactly one has to be given. The options
  /// of all tools may come after it too. `after_reading` of what is returned is called if it was given.
  CommandLine subcommand(const std::string& name, const std::string& help);

  /// Calls `check` after the command line was read without an error.
  void after_reading(std::function<void()> check);
  /// For `check`: ends with the usage error that `what` is required.
  [[noreturn]] static void refuse_without(const std::string& what);
  /// For `check`: ends with a usage error if the option is given and would be ignored, because `partner` is not there.
  static void refuse_ignored(const Option& option, bool has_partner, const std::string& partner);

 private:
  CLI::App* app_;
  std::vector<const CLI::Option*> listed_;
};

}  // namespace pamr::cli
