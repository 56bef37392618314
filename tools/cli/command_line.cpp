// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "cli/help_format.hpp"

namespace pamr::cli {
namespace {

/// Refuses words that are no finite number for which `holds`. CLI11's own checks spell its limits out with 300 digits.
template <class Holds>
CLI::Validator number(const std::string& expected, const std::string& shown_in_help, Holds holds) {
  return {[expected, holds](const std::string& word) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(word, value) && std::isfinite(value) && holds(value)) return {};
            return fmt::format("expected {}, found {}", expected, word);
          },
          shown_in_help};
}

template <class T>
CLI::Validator between(T low, T high) {
  return number(fmt::format("a number from {} to {}", low, high), fmt::format("{} to {}", low, high),
                [low, high](double value) { return low <= value && value <= high; });
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::positive() {
  option_->check(number("a number above 0", "POSITIVE", [](double value) { return value > 0; }));
  return *this;
}

Option& Option::not_negative() {
  option_->check(number("0 or a number above it", "NONNEGATIVE", [](double value) { return value >= 0; }));
  return *this;
}

Option& Option::range(int low, int high) {
  option_->check(between(low, high));
  return *this;
}

Option& Option::range(double low, double high) {
  option_->check(between(low, high));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}

Option& Option::file_ending(const std::string& ending) {
  option_->type_name("FILE" + ending);
  option_->check(CLI::Validator(
      [ending](const std::string& name) -> std::string {
        const auto found = std::filesystem::path(name).extension();
        if (name != "-" && (found.empty() || CLI::detail::to_lower(found.string()) == ending)) return {};
        return fmt::format("expected a name that ends in {}, found '{}'", ending, name);
      },
      ""));
  return *this;
}

Option& Option::one_at_a_time() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::delimiter(char between) {
  option_->delimiter(between);
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

bool Option::is_given() const { return !option_->empty(); }

template <class T>
Option CommandLine::option(const std::string& name, T& value, const std::string& help) {
  return Option(app_->add_option(name, value, help));
}
template <class T>
Option CommandLine::option(const std::string& name, Exact<T>& value, const std::string& help) {
  auto* const option = app_->add_option_function<T>(
      name, [&value](const T& given) { value = given; }, help);
  option->default_function([&value] { return fmt::to_string(static_cast<T>(value)); });
  return Option(option);
}
template Option CommandLine::option(const std::string&, std::string&, const std::string&);
template Option CommandLine::option(const std::string&, int&, const std::string&);
template Option CommandLine::option(const std::string&, std::int64_t&, const std::string&);
template Option CommandLine::option(const std::string&, std::uint64_t&, const std::string&);
template Option CommandLine::option(const std::string&, double&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<std::int64_t>&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::option(const std::string&, Exact<int>&, const std::string&);
template Option CommandLine::option(const std::string&, Exact<std::int64_t>&, const std::string&);
template Option CommandLine::option(const std::string&, Exact<std::uint64_t>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<std::vector<double>>&, const std::string&);

Option CommandLine::flag(const std::string& name, bool& value, const std::string& help) {
  return Option(app_->add_flag(name, value, help));
}

void CommandLine::group(const std::string& heading, const std::string& example) {
  app_->option_defaults()->group(heading);
  app_->get_formatter()->label(heading, example);  // where the layout of --help finds it
}

Option CommandLine::listed_option(const std::string& name, const std::string& help) {
  auto* option = app_->add_option(name, help);
  constexpr int most = 1000;
  option->take_all()->expected(1, most)->allow_extra_args(false);
  listed_.push_back(option);
  return Option(option);
}

Option CommandLine::listed_flag(const std::string& name, bool& value, const std::string& help) {
  const auto result = flag(name, value, help);
  listed_.push_back(result.option_);
  return result;
}

std::vector<std::pair<std::string, std::string>> CommandLine::listed() const {
  std::vector<std::pair<std::string, std::string>> result;
  std::map<const CLI::Option*, std::size_t> n_seen;
  for (const CLI::Option* option : app_->parse_order()) {
    if (std::find(listed_.begin(), listed_.end(), option) == listed_.end()) continue;
    const auto number = n_seen[option]++;
    const bool is_flag = option->get_items_expected_max() == 0;
    if (is_flag && number > 0) continue;
    result.emplace_back(option->get_name(), is_flag ? "" : option->results().at(number));
  }
  return result;
}

CommandLine CommandLine::subcommand(const std::string& name, const std::string& help) {
  auto* const command = app_->add_subcommand(name, help);
  command->fallthrough();
  command->formatter(help_format(help_width()));  // whose examples are those of its own groups
  app_->require_subcommand(1);
  return CommandLine(*command);
}

void CommandLine::after_reading(std::function<void()> check) { app_->parse_complete_callback(std::move(check)); }

void CommandLine::refuse_without(const std::string& what) { throw CLI::RequiredError(what); }

void CommandLine::refuse_ignored(const Option& option, bool has_partner, const std::string& partner) {
  if (option.is_given() && !has_partner)
    throw CLI::ValidationError(option.option_->get_name(), fmt::format("expected {} beside it", partner));
}

}  // namespace pamr::cli
