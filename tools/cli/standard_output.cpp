// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/standard_output.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <thread>

#include "cli/launcher.hpp"

namespace pamr::cli {

namespace {

int first_failure = 0;  // an errno; one thread prints

constexpr std::size_t pipe_piece = 1024;  // which the launcher of Open MPI 5 reads at once

/// Whole lines from the beginning of a text, as many as the launcher reads at once; at least one.
std::string_view first_lines(std::string_view text) {
  if (text.size() <= pipe_piece) return text;
  auto end = text.rfind('\n', pipe_piece - 1);
  if (end == std::string_view::npos) end = text.find('\n', pipe_piece);
  return text.substr(0, end == std::string_view::npos ? end : end + 1);
}

bool write_now(std::string_view text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

/// Waits until the launcher has read all bytes in the pipe of a stream, but no longer than until `latest`, and then
/// gives its threads time to hand them on, which they may otherwise do in another order.
void wait_for_reader(int stream, std::chrono::steady_clock::time_point latest) {
  int n_bytes = 0;
  while (::ioctl(stream, FIONREAD, &n_bytes) == 0 && n_bytes > 0 && std::chrono::steady_clock::now() < latest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

/// Each piece when all before it has been read: the launcher then never reads, and holds back, a part of a line.
bool write_in_pieces(std::string_view text) {
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  wait_for_reader(STDERR_FILENO, latest);
  while (!text.empty()) {
    const auto piece = first_lines(text);
    wait_for_reader(STDOUT_FILENO, latest);
    if (!write_now(piece)) return false;
    text.remove_prefix(piece.size());
  }
  wait_for_reader(STDOUT_FILENO, latest);  // before anything goes to standard error
  return true;
}

}  // namespace

void keep_standard_streams() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(file, F_GETFD) >= 0) continue;
    // The lowest free number is this one. Reading or writing the wrong way fails as on a closed stream.
    if (::open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY) != file) return;
  }
}

bool print(const std::string& text) {
  errno = 0;
  const bool has_arrived = launcher_holds_lines_back() ? write_in_pieces(text) : write_now(text);
  if (!has_arrived && first_failure == 0) first_failure = errno == 0 ? EIO : errno;
  return has_arrived;
}

std::string trouble_of_output() {
  if (first_failure == 0 || first_failure == EBADF) return {};
  return std::generic_category().message(first_failure);
}

}  // namespace pamr::cli
