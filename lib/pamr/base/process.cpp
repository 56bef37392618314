// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/process.hpp"

#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>

#include "pamr/base/hash.hpp"
#include "pamr/base/machine.hpp"
#include "pamr/base/read_file.hpp"

namespace pamr {

namespace {

/// State of a process and the moment of its start: fields 3 and 22 of /proc/N/stat, behind a name that may hold
/// anything. Nothing where the system does not tell.
struct Running {
  char state = '?';
  std::uint64_t start = 0;
};
std::optional<Running> look_up(const std::string& process) {
  const auto text = read_file("/proc/" + process + "/stat").value_or("");
  const auto behind = text.rfind(") ");
  if (behind == std::string::npos) return {};
  std::istringstream fields(text.substr(behind + 2));
  Running found;
  fields >> found.state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  return fields >> found.start ? std::optional(found) : std::nullopt;
}

/// The running system and its namespace of processes.
std::uint64_t this_machine() {
  std::error_code none;
  auto h = machine_id();
  for (const char c : std::filesystem::read_symlink("/proc/self/ns/pid", none).string())
    h = combine(h, static_cast<unsigned char>(c));
  return h >> 32U;
}

}  // namespace

ProcessId this_process() {
  static const auto machine = this_machine();
  const auto running = look_up("self");
  return {machine, static_cast<std::uint64_t>(getpid()), running ? running->start : 0};
}

std::optional<bool> has_ended(const ProcessId& id) {
  if (id.machine != this_process().machine) return {};
  if (id.process == 0 || id.process > std::uint64_t{INT_MAX}) return true;
  if (kill(static_cast<pid_t>(id.process), 0) != 0 && errno == ESRCH) return true;
  const auto running = look_up(std::to_string(id.process));
  return running && (running->state == 'Z' || (id.start != 0 && running->start != id.start));
}

}  // namespace pamr
