// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/standard_output.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "cli/launcher.hpp"

namespace pamr::cli {

namespace {

int first_failure = 0;  // an errno; one thread prints

constexpr std::size_t terminal_piece = 1024;  // which a terminal takes, and the launcher reads, at once

/// Whole lines from the beginning of a text, as many as the launcher reads at once; at least one.
std::string_view first_lines(std::string_view text) {
  if (text.size() <= terminal_piece) return text;
  auto end = text.rfind('\n', terminal_piece - 1);
  if (end == std::string_view::npos) end = text.find('\n', terminal_piece);
  return text.substr(0, end == std::string_view::npos ? end : end + 1);
}

bool write_now(std::string_view text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

/// Waits until the launcher has read all bytes in the pipe of standard error, but no longer than until `latest`.
void wait_for_errors(std::chrono::steady_clock::time_point latest) {
  int n_bytes = 0;
  while (::ioctl(STDERR_FILENO, FIONREAD, &n_bytes) == 0 && n_bytes > 0 && std::chrono::steady_clock::now() < latest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// Standard output is a terminal of the launcher, which does not say how much of it has been read. But the system
/// counts the bytes that the launcher reads, of any file; what has been written is read once as many have been added.
class OutputReader {
 public:
  /// Called before something is written.
  void begin() { n_before_ = n_read(); }

  /// Waits until this many bytes have been read since then, but no longer than until `latest`. Where the system does
  /// not count, or the launcher is not the parent of this process, the wait is 10 ms.
  void wait_for(std::size_t n_bytes, std::chrono::steady_clock::time_point latest) {
    const auto enough_to_see_one = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (n_before_ && std::chrono::steady_clock::now() < latest) {
      const auto n_now = n_read();
      if (n_now && *n_now - *n_before_ >= n_bytes) return;
      if (!n_now || (*n_now == *n_before_ && std::chrono::steady_clock::now() > enough_to_see_one)) is_counted_ = false;
      if (!is_counted_) break;
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

 private:
  std::optional<std::uint64_t> n_read() const { return is_counted_ ? bytes_read_by_parent() : std::nullopt; }

  bool is_counted_ = true;
  std::optional<std::uint64_t> n_before_;
};

/// Each piece when all before it has been read. The launcher then hardly ever reads, and holds back, a part of a line;
/// and where it does, it has read the end before this process writes anything else, to standard error say.
bool write_in_pieces(std::string_view text) {
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  wait_for_errors(latest);
  OutputReader reader;
  while (!text.empty()) {
    const auto piece = first_lines(text);
    reader.begin();
    if (!write_now(piece)) return false;
    reader.wait_for(piece.size(), latest);
    text.remove_prefix(piece.size());
  }
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
