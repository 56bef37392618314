// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "pamr/base/error.hpp"
#include "pamr/io/catalog.hpp"

namespace pamr::io {

namespace {

constexpr rlim_t processor_seconds = 2;
constexpr auto wall_limit = std::chrono::seconds(120);
constexpr rlim_t spare_bytes = rlim_t{64} << 20U;

/// Answers start with one of these.
constexpr char good = 'G', bad = 'B';

void set_limit(int resource, rlim_t limit) {
  rlimit both{};
  if (getrlimit(static_cast<__rlimit_resource>(resource), &both) != 0) return;
  both.rlim_cur = both.rlim_max == RLIM_INFINITY ? limit : std::min(limit, both.rlim_max);
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

rlim_t address_space_in_use() {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  if (!(statm >> pages)) return RLIM_INFINITY / 2;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// What the forked process does: plain system calls and HDF5's serial driver, no MPI, no exit handlers.
[[noreturn]] void run_child(const std::filesystem::path& file, std::uintmax_t file_bytes, int pipe_end) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGTERM, SIGINT, SIGPIPE})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, processor_seconds);
  set_limit(RLIMIT_AS, address_space_in_use() + 16 * static_cast<rlim_t>(file_bytes) + spare_bytes);
  std::string answer;
  try {
    answer = good + pack(inspect(file));
  } catch (const Error& error) {
    answer = bad + std::string(error.what());
  } catch (const std::bad_alloc&) {
    answer = bad + ("file '" + file.string() + "': expected contents in keeping with its size, found a claim of more");
  } catch (const std::exception& error) {
    answer = bad + ("file '" + file.string() + "': " + error.what());
  }
  for (std::size_t at = 0; at < answer.size();) {
    const auto n = write(pipe_end, answer.data() + at, answer.size() - at);
    if (n < 0 && errno != EINTR) _exit(1);
    if (n > 0) at += static_cast<std::size_t>(n);
  }
  _exit(0);
}

/// Everything the child writes until it closes its end; false when it took too long.
bool read_answer(int pipe_end, std::string& answer) {
  const auto deadline = std::chrono::steady_clock::now() + wall_limit;
  for (char buffer[1 << 16];;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    pollfd waiting{pipe_end, POLLIN, 0};
    const int ready = poll(&waiting, 1, static_cast<int>(left));
    if (ready <= 0) {
      if (ready < 0 && errno == EINTR) continue;
      return false;
    }
    const auto n = read(pipe_end, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n == 0;
    answer.append(buffer, static_cast<std::size_t>(n));
  }
}

std::uintmax_t size_of_regular_file(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) throw Error("file '" + file.string() + "': expected a file, found none");
  if (!std::filesystem::is_regular_file(status))
    throw Error("file '" + file.string() + "': expected a file, found " +
                (std::filesystem::is_directory(status) ? "a folder" : "something else"));
  if (access(file.c_str(), R_OK) != 0)
    throw Error("file '" + file.string() + "': expected a file that may be read, found: " + std::strerror(errno));
  return std::filesystem::file_size(file);
}

/// The first bytes of an HDF5 file; HDF5 also allows them at offsets 512, 1024, 2048 ...
void require_signature(const std::filesystem::path& file, std::uintmax_t bytes) {
  constexpr char signature[] = "\x89HDF\r\n\x1a\n";
  std::ifstream stream(file, std::ios::binary);
  for (std::uintmax_t offset = 0; offset + 8 <= bytes; offset = offset == 0 ? 512 : 2 * offset) {
    char found[8] = {};
    stream.seekg(static_cast<std::streamoff>(offset));
    if (stream.read(found, sizeof found) && std::memcmp(found, signature, sizeof found) == 0) return;
  }
  throw Error("file '" + file.string() + "': expected an HDF5 file, found no HDF5 signature");
}

std::string look_through(const std::filesystem::path& file) {
  const auto bytes = size_of_regular_file(file);
  require_signature(file, bytes);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Error("file '" + file.string() + "': cannot make a pipe to check it: " + std::strerror(errno));
  const auto child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(file, bytes, ends[1]);
  }
  close(ends[1]);
  std::string answer;
  const bool in_time = child > 0 && read_answer(ends[0], answer);
  close(ends[0]);
  if (child < 0)
    throw Error("file '" + file.string() + "': cannot start a process to check it: " + std::strerror(errno));
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time)
    throw Error("file '" + file.string() +
                "': expected a sound HDF5 file, found that HDF5 does not come to an end with it");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty())
    throw Error("file '" + file.string() + "': expected a sound HDF5 file, found one that HDF5 cannot cope with (" +
                (WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "no answer") + ")");
  if (answer.front() == bad) throw Error(answer.substr(1));
  return answer.substr(1);
}

}  // namespace

Catalog catalog_of(const par::Comm& comm, const std::filesystem::path& file) {
  std::string packed;
  Catalog catalog;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    packed = look_through(file);
    catalog = unpack(packed);
  });
  packed = comm.broadcast(std::move(packed));
  if (!comm.is_first()) catalog = unpack(packed);
  return catalog;
}

}  // namespace pamr::io
