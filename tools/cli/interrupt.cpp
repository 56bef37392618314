// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/interrupt.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <string_view>

#include "cli/step_clock.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/remove_on_interrupt.hpp"

namespace pamr::cli {

namespace {

// What the handler needs: fixed storage.
std::array<char, 160> interrupt_text{};
std::size_t interrupt_length = 0;
std::array<char, PATH_MAX> abort_mark{};  ///< a file that is there once a process of the job aborts it

/// In the folder that mpirun makes for a job on each machine, and removes; nothing elsewhere.
std::string name_of_mark() {
  const char* folder = std::getenv("PMIX_SERVER_TMPDIR");
  return folder == nullptr ? std::string() : std::string(folder) + "/pamr-aborts";
}

bool has_others = false;

/// Whether SIGHUP was ignored when the process began, as `nohup` has it. A library that is loaded with the program may
/// give the signal a handler of its own before `main`: UCX, which MPI uses, does (openucx/ucx, issue 10742). Functions
/// in .preinit_array run before that.
bool hangup_is_ignored = false;

void look_at_hangup() {
  struct sigaction now {};
  ::sigaction(SIGHUP, nullptr, &now);
  hangup_is_ignored = hangup_is_ignored || now.sa_handler == SIG_IGN;
}

#ifndef __SANITIZE_ADDRESS__  // which begins there, too
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = look_at_hangup;
#endif

/// Open MPI's mpirun sends SIGTERM to all ranks and means to wait a second before it kills them; but the first that
/// ends ends its wait (`sleep` returns at SIGCHLD), and it kills those that had no time yet. Nobody ends at once,
/// therefore. Source: open-mpi/ompi v4.1, orte/mca/odls/base/odls_base_default_fns.c,
/// orte_odls_base_default_kill_local_procs.
void wait_for_others() {
  timespec left{0, 500'000'000};
  while (::nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
}

/// A second signal, which mpirun sends to one that waits for the others, may reach another thread: it changes nothing.
std::atomic_flag is_ending = ATOMIC_FLAG_INIT;

/// One write of the text, of what is complete, and of the end of the line.
bool write_line(std::string_view text) {
  std::array<char, 1400> line{};
  std::size_t n = 0;
  for (const auto part : {text, io::complete_outputs(), std::string_view("\n")})
    for (const char c : part)
      if (n < line.size()) line[n++] = c;
  return ::write(STDERR_FILENO, line.data(), n) >= 0;
}

extern "C" void remove_files_and_end(int) {
  if (is_ending.test_and_set()) return;
  io::remove_unfinished();
  hide_step();
  constexpr int interrupted = 6;
  const bool is_told = abort_mark[0] != '\0' && ::access(abort_mark.data(), F_OK) == 0;
  const bool is_heard = is_told || interrupt_length == 0 || write_line({interrupt_text.data(), interrupt_length});
  if (has_others && is_heard) wait_for_others();
  ::_exit(interrupted);
}

/// Fixed storage for the beginning of a line.
struct Line {
  std::array<char, 160> text{};
  std::size_t length = 0;

  void set(const std::string& from) {
    length = std::min(from.size(), text.size());
    std::copy_n(from.begin(), length, text.begin());
  }
  std::string_view view() const { return {text.data(), length}; }
};

constexpr std::array signals_of_crash{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
Line crash_line, end_line;
std::array<struct sigaction, signals_of_crash.size()> before_crash{};
std::optional<int> kept_code;

/// Then the handler that was there before gets the signal.
extern "C" void say_what_is_complete(int signal) {
  for (std::size_t i = 0; i < signals_of_crash.size(); ++i)
    if (signals_of_crash[i] == signal) ::sigaction(signal, &before_crash[i], nullptr);
  if (!io::complete_outputs().empty()) (void)write_line(crash_line.view());
  (void)::raise(signal);
}

extern "C" void end_with_kept_code(int) {
  if (end_line.length > 0) (void)write_line(end_line.view());
  ::_exit(*kept_code);
}

/// The last of the functions that run at the end of a process: another may have ended it with a code of its own.
void keep_code_at_exit(int code, void*) {
  if (!kept_code || code == *kept_code) return;
  std::fflush(nullptr);
  end_with_kept_code(0);
}

}  // namespace

void end_well_on_interrupt(const std::string& tool, bool speaks, bool in_company) {
  has_others = in_company;
  const auto line = tool + ": interrupted: outputs that were not complete are removed";
  interrupt_length = speaks ? std::min(line.size(), interrupt_text.size()) : 0;
  std::copy_n(line.begin(), interrupt_length, interrupt_text.begin());
  if (const auto mark = name_of_mark(); mark.size() < abort_mark.size())
    std::copy(mark.begin(), mark.end(), abort_mark.begin());
  struct sigaction action {};
  action.sa_handler = remove_files_and_end;
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) ::sigaction(signal, &action, nullptr);
  look_at_hangup();
  if (hangup_is_ignored) action.sa_handler = SIG_IGN;
  ::sigaction(SIGHUP, &action, nullptr);
}

void be_silent_on_interrupt() { interrupt_length = 0; }

void tell_of_crash([[maybe_unused]] const std::string& tool) {
#ifndef __SANITIZE_ADDRESS__  // which tells more
  crash_line.set(tool + ": error: crashed");
  struct sigaction action {};
  action.sa_handler = say_what_is_complete;
  for (std::size_t i = 0; i < signals_of_crash.size(); ++i) ::sigaction(signals_of_crash[i], &action, &before_crash[i]);
#endif
}

void guard_exit_code() {
#ifndef __SANITIZE_ADDRESS__  // whose code for what it finds is to stay
  ::on_exit(keep_code_at_exit, nullptr);
#endif
}

void keep_outcome([[maybe_unused]] const std::string& tool, int code, bool is_error) {
  if (!is_error)
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) std::signal(signal, SIG_IGN);
#ifndef __SANITIZE_ADDRESS__  // which tells more
  kept_code = code;
  if (!is_error)
    end_line.set(tool + ": warning: MPI or another library failed while the process ended, when all work was done");
  for (const int signal : signals_of_crash) std::signal(signal, end_with_kept_code);
#endif
}

void announce_abort() {
  if (abort_mark[0] == '\0') return;
  const int file = ::open(abort_mark.data(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  if (file >= 0) ::close(file);
}

}  // namespace pamr::cli
