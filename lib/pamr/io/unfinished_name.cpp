// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/unfinished_name.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <charconv>
#include <climits>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string_view>

#include "pamr/base/process.hpp"

namespace pamr::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view ending = ".partial";

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "host";
  std::string result(name.data());
  constexpr std::size_t longest = 32;
  result.resize(std::min(result.size(), longest));
  for (auto& c : result)
    if (c != '-' && std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return result.empty() ? "host" : result;
}

/// Takes the last part of `text`, behind a '-', as a number.
std::optional<std::uint64_t> take_number(std::string_view& text, int base) {
  const auto dash = text.rfind('-');
  if (dash == std::string_view::npos || dash + 1 == text.size()) return {};
  const auto digits = text.substr(dash + 1);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  if (error != std::errc{} || end != digits.data() + digits.size()) return {};
  text = text.substr(0, dash);
  return value;
}

/// A temporary name, taken apart.
struct Parts {
  ProcessId owner;     ///< who writes it, or wrote it
  std::string target;  ///< the name that it was to get, or the beginning of that
  bool is_cut = false;
};

/// Nothing when it is no such name.
std::optional<Parts> parts_of(std::string_view name) {
  if (!name.ends_with(ending)) return {};
  const bool is_cut = name.size() + 4 > NAME_MAX;  // long names were shortened, by whole characters
  auto text = name.substr(0, name.size() - ending.size());
  const auto number = take_number(text, 10), start = take_number(text, 10), process = take_number(text, 10),
             machine = take_number(text, 16);
  if (!number || !start || !process || !machine) return {};
  const auto dot = text.rfind('.');  // a host has none
  if (dot == std::string_view::npos) return {};
  return Parts{{*machine, *process, *start}, std::string(text.substr(0, dot)), is_cut};
}

bool is_dead(const ProcessId& owner, const struct stat& status) {
  constexpr std::time_t day = 86400;
  return has_ended(owner).value_or(std::time(nullptr) - status.st_mtime > day);
}

bool is_one_of(const fs::path& path, const std::vector<std::string>& others) {
  std::error_code none;
  return std::any_of(others.begin(), others.end(),
                     [&](const auto& other) { return fs::equivalent(path, other, none); });
}

}  // namespace

fs::path unfinished_name(const fs::path& target) {
  static std::atomic<std::uint64_t> next{0};
  const auto us = this_process();
  const auto tail = fmt::format(".{}-{:08x}-{}-{}-{}{}", host_name(), us.machine, us.process, us.start, next++, ending);
  auto name = target.filename().string();
  if (name.size() + tail.size() > NAME_MAX) {
    name.resize(NAME_MAX - tail.size());
    while (!name.empty() && (static_cast<unsigned char>(name.back()) & 0xc0U) == 0x80U) name.pop_back();
    if (!name.empty() && (static_cast<unsigned char>(name.back()) & 0x80U) != 0) name.pop_back();
  }
  return target.parent_path() / (name + tail);
}

void remove_leftovers(const fs::path& folder,
                      const std::function<bool(const std::string& name, bool is_cut)>& is_target,
                      const std::vector<std::string>& keep) {
  std::vector<fs::path> dead;
  std::error_code failed;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const auto parts = parts_of(entry->path().filename().string());
    struct stat status {};
    if (!parts || !is_target(parts->target, parts->is_cut) || lstat(entry->path().c_str(), &status) != 0) continue;
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) continue;
    if (is_dead(parts->owner, status) && !is_one_of(entry->path(), keep)) dead.push_back(entry->path());
  }
  for (const auto& path : dead) {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
}

void remove_leftovers(const fs::path& target, const std::vector<std::string>& keep) {
  const auto name = target.filename().string();
  const auto is_target = [&](const std::string& found, bool is_cut) {
    return found == name || (is_cut && !found.empty() && name.starts_with(found));
  };
  remove_leftovers(target.parent_path(), is_target, keep);
}

}  // namespace pamr::io
