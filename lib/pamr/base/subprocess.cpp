// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/subprocess.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

#include "pamr/base/error.hpp"

namespace pamr {

namespace {

constexpr int stall_limit_milliseconds = 120000;

template <class Resource>
void set_limit(Resource resource, rlim_t limit) {
  rlimit both{};
  if (getrlimit(resource, &both) != 0) return;
  both.rlim_cur = both.rlim_max == RLIM_INFINITY ? limit : std::min(limit, both.rlim_max);
  setrlimit(resource, &both);
}

rlim_t address_space_in_use() {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  if (!(statm >> pages)) return RLIM_INFINITY / 2;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

void send(int pipe_end, std::span<const char> bytes) {
  while (!bytes.empty()) {
    const auto n = write(pipe_end, bytes.data(), bytes.size());
    if (n < 0 && errno != EINTR) _exit(1);
    if (n > 0) bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

[[noreturn]] void run_child(const std::function<void(const Subprocess::Send&)>& produce, Subprocess::Limits limits,
                            int pipe_end) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGTERM, SIGINT, SIGPIPE})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, limits.processor_seconds);
  set_limit(RLIMIT_AS, address_space_in_use() + limits.memory_bytes);
  try {
    produce([pipe_end](std::span<const char> bytes) { send(pipe_end, bytes); });
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

/// Whether the system lets this process start another one.
bool fork_works() {
  const auto child = fork();
  if (child == 0) _exit(0);
  if (child < 0) return false;
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  return true;
}

}  // namespace

bool may_fork() {
  const char* setting = std::getenv("PAMR_NO_FORK");  // NOLINT(concurrency-mt-unsafe): nobody changes the environment
  const bool is_allowed = setting == nullptr || std::string_view(setting).empty() || std::string_view(setting) == "0";
  static const bool works = is_allowed && fork_works();
  return is_allowed && works;
}

Subprocess::Subprocess(const std::function<void(const Send&)>& produce, Limits limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error(std::string("cannot make a pipe: ") + std::strerror(errno));
  child_ = fork();
  if (child_ == 0) {
    close(ends[0]);
    run_child(produce, limits, ends[1]);
  }
  const auto reason = errno;
  close(ends[1]);
  pipe_end_ = ends[0];
  if (child_ < 0) {
    close(pipe_end_);
    throw Error(std::string("cannot start a process: ") + std::strerror(reason));
  }
}

Subprocess::~Subprocess() { stop(); }

std::size_t Subprocess::receive_some(std::span<char> to) {
  for (;;) {
    pollfd waiting{pipe_end_, POLLIN, 0};
    const int ready = poll(&waiting, 1, stall_limit_milliseconds);
    if (ready == 0) stood_still_ = true;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return 0;
    const auto n = read(pipe_end_, to.data(), to.size());
    if (n < 0 && errno == EINTR) continue;
    return n < 0 ? 0 : static_cast<std::size_t>(n);
  }
}

bool Subprocess::receive(std::span<char> to) {
  while (!to.empty()) {
    const auto n = receive_some(to);
    if (n == 0) return false;
    to = to.subspan(n);
  }
  return true;
}

std::string Subprocess::receive_all() {
  std::string all;
  std::array<char, 1 << 16> buffer;
  while (const auto n = receive_some(buffer)) all.append(buffer.data(), n);
  return all;
}

void Subprocess::stop() noexcept {
  if (pipe_end_ >= 0) close(pipe_end_);
  pipe_end_ = -1;
  if (child_ <= 0) return;
  // A process that closed its end without having ended is beyond caring, and one that stood still has to be stopped.
  kill(child_, SIGKILL);
  while (waitpid(child_, &status_, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
}

std::string Subprocess::end() {
  if (!stood_still_ && child_ > 0) {
    while (waitpid(child_, &status_, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
  }
  stop();
  if (stood_still_) return "no answer";
  if (WIFSIGNALED(status_)) return strsignal(WTERMSIG(status_));
  return WIFEXITED(status_) && WEXITSTATUS(status_) == 0 ? "" : "failure";
}

}  // namespace pamr
