// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/step_clock.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <ctime>
#include <string_view>

#include "cli/launcher.hpp"

namespace pamr::cli {

namespace {

// What the handler of a signal may touch: fixed storage, changed while the signal is held back.
struct Shown {
  std::array<char, 160> text{};
  std::size_t length = 0;
  std::time_t start = 0;
  bool on_terminal = false;
  bool is_running = false;
  volatile std::sig_atomic_t is_drawn = 0;
};
Shown shown;

constexpr std::string_view to_empty_line = "\r\033[K";

std::time_t seconds_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec;
}

/// Appends to a line of fixed length; nothing here may allocate.
class Line {
 public:
  void add(std::string_view text) {
    const auto n = std::min(text.size(), text_.size() - length_);
    std::copy_n(text.begin(), n, text_.begin() + static_cast<std::ptrdiff_t>(length_));
    length_ += n;
  }
  void add(long number, int digits) {
    std::array<char, 24> reversed{};
    std::size_t n = 0;
    for (; number > 0 || static_cast<int>(n) < digits; number /= 10)
      reversed[n++] = static_cast<char>('0' + number % 10);
    while (n > 0) add(std::string_view(&reversed[--n], 1));
  }
  void write() const {
    if (::write(STDERR_FILENO, text_.data(), length_) < 0) return;  // nobody to tell
  }

 private:
  std::array<char, 256> text_{};
  std::size_t length_ = 0;
};

extern "C" void tell_step(int) {
  const int before = errno;
  const auto seconds = static_cast<long>(seconds_now() - shown.start);
  Line line;
  if (shown.on_terminal) line.add(to_empty_line);
  line.add(std::string_view(shown.text.data(), shown.length));
  line.add(", ");
  line.add(seconds / 60, 1);
  line.add(":");
  line.add(seconds % 60, 2);
  if (!shown.on_terminal) line.add("\n");
  shown.is_drawn = shown.on_terminal ? 1 : 0;  // before it is: an interrupt may come in between
  line.write();
  errno = before;
}

void set_timer(std::time_t seconds) {
  const itimerval interval{{seconds, 0}, {seconds, 0}};
  ::setitimer(ITIMER_REAL, &interval, nullptr);
}

/// Holds the signal back while it lives.
class Held {
 public:
  Held() {
    sigset_t alarm;
    sigemptyset(&alarm);
    sigaddset(&alarm, SIGALRM);
    ::sigprocmask(SIG_BLOCK, &alarm, &before_);
  }
  ~Held() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  Held(Held&&) = delete;
  Held& operator=(Held&&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

bool error_is_on_terminal() {
  if (::isatty(STDERR_FILENO) == 1) return true;
  if (!is_under_launcher() || launcher_holds_lines_back()) return false;
  std::array<char, PATH_MAX> target{};
  const auto link = "/proc/" + std::to_string(::getppid()) + "/fd/2";
  if (::readlink(link.c_str(), target.data(), target.size() - 1) < 0) return false;
  const std::string_view name(target.data());
  return name.starts_with("/dev/pts/") || name.starts_with("/dev/tty") || name == "/dev/console";
}

void show_step(const std::string& what) {
  const Held held;
  shown.length = std::min(what.size(), shown.text.size());
  std::copy_n(what.begin(), shown.length, shown.text.begin());
  shown.start = seconds_now();
  if (shown.is_running) return;
  shown.is_running = true;
  shown.on_terminal = error_is_on_terminal();
  struct sigaction action {};
  action.sa_handler = tell_step;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGALRM, &action, nullptr);
  set_timer(shown.on_terminal ? 1 : 10);
}

void hide_step() {
  if (shown.is_running) set_timer(0);
  shown.is_running = false;
  if (shown.is_drawn == 0) return;
  shown.is_drawn = 0;
  if (::write(STDERR_FILENO, to_empty_line.data(), to_empty_line.size()) < 0) return;  // nobody to tell
}

void mark_line(bool is_drawn) { shown.is_drawn = is_drawn ? 1 : 0; }

}  // namespace pamr::cli
