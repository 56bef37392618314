// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/unfinished_name.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include "pamr/base/hash.hpp"
#include "pamr/base/machine.hpp"

namespace pamr::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view ending = ".partial";

/// A process as a name tells it.
struct Owner {
  std::uint64_t machine = 0, process = 0, start = 0;
};

std::string contents_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// State of a process and the moment of its start: fields 3 and 22 of /proc/N/stat, behind a name that may hold
/// anything. Nothing where the system does not tell.
struct Running {
  char state = '?';
  std::uint64_t start = 0;
};
std::optional<Running> look_up(const std::string& process) {
  const auto text = contents_of("/proc/" + process + "/stat");
  const auto behind = text.rfind(") ");
  if (behind == std::string::npos) return {};
  std::istringstream fields(text.substr(behind + 2));
  Running found;
  fields >> found.state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  return fields >> found.start ? std::optional(found) : std::nullopt;
}

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

/// The running system and its namespace of processes.
std::uint64_t this_machine() {
  std::error_code none;
  auto h = machine_id();
  for (const char c : fs::read_symlink("/proc/self/ns/pid", none).string())
    h = combine(h, static_cast<unsigned char>(c));
  return h >> 32U;
}

/// Taken anew in a process that was forked.
Owner this_process() {
  static const auto machine = this_machine();
  const auto running = look_up("self");
  return {machine, static_cast<std::uint64_t>(getpid()), running ? running->start : 0};
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

/// Who writes, or wrote, a file of this name for `target`; nothing when it is no such name.
std::optional<Owner> owner_of(std::string_view name, std::string_view target) {
  if (!name.ends_with(ending)) return {};
  const bool is_cut = name.size() + 4 > NAME_MAX;  // long names were shortened, by whole characters
  auto text = name.substr(0, name.size() - ending.size());
  const auto number = take_number(text, 10), start = take_number(text, 10), process = take_number(text, 10),
             machine = take_number(text, 16);
  if (!number || !start || !process || !machine) return {};
  const auto dot = text.rfind('.');  // a host has none
  if (dot == std::string_view::npos) return {};
  const auto stem = text.substr(0, dot);
  if (stem != target && !(is_cut && !stem.empty() && target.starts_with(stem))) return {};
  return Owner{*machine, *process, *start};
}

bool is_dead(const Owner& owner, const struct stat& status) {
  constexpr std::time_t day = 86400;
  const auto us = this_process();
  if (owner.machine != us.machine) return std::time(nullptr) - status.st_mtime > day;
  if (owner.process == 0 || owner.process > std::uint64_t{INT_MAX}) return true;
  if (kill(static_cast<pid_t>(owner.process), 0) != 0 && errno == ESRCH) return true;
  const auto running = look_up(std::to_string(owner.process));
  return running && (running->state == 'Z' || (owner.start != 0 && running->start != owner.start));
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

void remove_leftovers(const fs::path& target, const std::vector<std::string>& keep) {
  const auto folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const auto name = target.filename().string();
  std::vector<fs::path> dead;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const auto owner = owner_of(entry->path().filename().string(), name);
    struct stat status {};
    if (!owner || lstat(entry->path().c_str(), &status) != 0) continue;
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) continue;
    if (is_dead(*owner, status) && !is_one_of(entry->path(), keep)) dead.push_back(entry->path());
  }
  for (const auto& path : dead) {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
}

}  // namespace pamr::io
