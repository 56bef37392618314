// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/machine.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "pamr/base/hash.hpp"
#include "pamr/base/read_file.hpp"

namespace pamr {

namespace {

constexpr auto no_limit = std::numeric_limits<std::uint64_t>::max();

/// The first number of a file; nothing for one that cannot be read or says "max".
std::optional<std::uint64_t> number_in(const std::string& file) {
  std::ifstream in(file);
  std::uint64_t value = 0;
  return in >> value ? std::optional(value) : std::nullopt;
}

/// The smallest limit of a group of processes and of those around it. `name`: "/a/b".
std::uint64_t smallest_limit(const std::string& root, std::string name, const std::string& file) {
  auto limit = no_limit;
  for (;;) {
    limit = std::min(limit, number_in(root + name + "/" + file).value_or(no_limit));
    const auto slash = name.rfind('/');
    if (slash == std::string::npos) return limit;
    name.resize(slash);
  }
}

/// Source: Linux, Documentation/admin-guide/cgroup-v2.rst and cgroup-v1/memory.rst.
std::uint64_t limit_of_group() {
  std::ifstream groups("/proc/self/cgroup");
  auto limit = no_limit;
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const auto controllers = line.substr(first + 1, second - first - 1), name = line.substr(second + 1);
    if (controllers.empty())
      limit = std::min(limit, smallest_limit("/sys/fs/cgroup", name, "memory.max"));
    else if (("," + controllers + ",").find(",memory,") != std::string::npos)
      limit = std::min(limit, smallest_limit("/sys/fs/cgroup/memory", name, "memory.limit_in_bytes"));
  }
  return limit;
}

}  // namespace

std::uint64_t machine_id() {
  auto text = read_file("/proc/sys/kernel/random/boot_id").value_or("");
  if (text.empty()) {
    std::array<char, 256> name{};
    (void)gethostname(name.data(), name.size() - 1);
    text = name.data();
  }
  std::uint64_t h = 0;
  for (const char c : text) h = combine(h, static_cast<unsigned char>(c));
  return h;
}

std::uint64_t memory_of_machine() {
  std::ifstream in("/proc/meminfo");
  std::uint64_t built_in = 0, on_disk = 0;
  for (std::string line; std::getline(in, line);) {
    const auto kilobytes = [&] { return 1024 * std::stoull(line.substr(line.find(':') + 1)); };
    if (line.starts_with("MemTotal:")) built_in = kilobytes();
    if (line.starts_with("SwapTotal:")) on_disk = kilobytes();
  }
  return std::min(built_in > 0 ? built_in + on_disk : no_limit, limit_of_group());
}

std::uint64_t memory_of_process() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return no_limit;
  return limit.rlim_cur;
}

}  // namespace pamr
