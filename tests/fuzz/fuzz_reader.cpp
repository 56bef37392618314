// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads damaged files of one format (native, Gmsh, VTK, ...), each a mutation of a small good one from a fixed seed,
/// and fails when the reader crashes, takes longer than 5 seconds, throws anything but `pamr::Error`, gives an error
/// that does not name the file, or asks for a piece of memory larger than 16 times the file and 64 MiB.
///
///     fuzz_FORMAT [N] [FIRST_SEED]        N damaged files (2000), on all processors
///
/// Worker processes read the files and report each on a pipe, so that a death or a stall belongs to one file; the
/// worker is then started anew behind it. `fuzz_FORMAT --one SEED FILE` writes the damaged file of a seed for a closer
/// look, `fuzz_FORMAT --all N FOLDER` those of the seeds below N. `fuzz_FORMAT --file FILE EXTENSION` reads one file
/// under the name FILE.EXTENSION, and dies where a reader must not end so, as AFL++ wants it
/// (qualification/fuzz/coverage.sh); `--file-as-tool` has a child read it first.
#include <fcntl.h>
#include <hdf5.h>
#include <mpi.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "arguments.hpp"
#include "cli/check_in_child.hpp"
#include "pamr/base/error.hpp"
#include "pamr/par/lone_start.hpp"
#include "seeds.hpp"
#include "watched_memory.hpp"

namespace pamr::fuzz {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
/// On a busy machine the clock says little, so it only tells a standstill.
constexpr double processor_seconds = 5;
constexpr auto stall_limit = std::chrono::milliseconds(60000);
constexpr std::size_t spare_bytes = std::size_t{64} << 20U;

std::string contents_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The good files; seed s damages file s modulo their number.
std::vector<std::string> good_files(const fs::path& folder) {
  std::vector<std::string> files;
  for (int i = 0; i < n_seed_files(); ++i) files.push_back(contents_of(folder / seed_name(i)));
  return files;
}

/// What reading one file came to, one character on the pipe.
enum Outcome : char {
  accepted = 'a',
  refused = 'r',
  wrong_exception = 'x',
  nameless_error = 'n',
  too_much_memory = 'm',
  too_slow = 't',
  died = 'd',  // said by the supervisor
  stalled = 's'
};

/// Processor time of this process and of its finished children.
double processor_time() {
  double seconds = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const auto& part : {usage.ru_utime, usage.ru_stime})
      seconds += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
  }
  return seconds;
}

Outcome read_one(const par::Comm& comm, const fs::path& file) {
  const auto allowed = 16 * fs::file_size(file) + spare_bytes;
  largest_piece();
  const auto start = processor_time();
  Outcome outcome = accepted;
  try {
    read_file(comm, file);
  } catch (const Error& error) {
    outcome = std::string(error.what()).find(file.filename().string()) != std::string::npos ? refused : nameless_error;
  } catch (const std::exception&) {
    outcome = wrong_exception;
  }
  if (processor_time() - start > processor_seconds) return too_slow;
  return largest_piece() > allowed ? too_much_memory : outcome;
}

fs::path file_of_worker(const fs::path& folder) {
  return folder / ("damaged" + std::to_string(getpid()) + seed_name(0).substr(seed_name(0).find('.')));
}

void start_mpi() {
  const par::LoneStart alone;
  MPI_Init(nullptr, nullptr);
}

/// As a tool does, before MPI starts: whether a child refuses the file.
bool is_refused_by_child(const fs::path& file) { return !cli::check_in_child(file.string()).empty(); }

/// Reads the files of seeds `first .. last` and reports each. MPI is started here, with one rank.
int work(const fs::path& folder, std::uint64_t first, std::uint64_t last, int pipe_end) {
  H5dont_atexit();  // it would complain about what damaged files left open
  start_mpi();
  {
    const par::Comm comm(MPI_COMM_WORLD);
    const auto good = good_files(folder);
    const auto file = file_of_worker(folder);
    watch_memory();
    for (auto seed = first; seed < last; ++seed) {
      std::ofstream(file, std::ios::binary) << damaged(good[seed % good.size()], seed);
      const char report = read_one(comm, file);
      if (write(pipe_end, &report, 1) != 1) return 1;
    }
    fs::remove(file);
  }
  MPI_Finalize();
  return 0;
}

/// Reads the file of one seed as a tool does: it is read here only if a child has survived it.
int work_as_tool(const fs::path& folder, std::uint64_t seed, int pipe_end) {
  const auto good = good_files(folder);
  const auto file = file_of_worker(folder);
  std::ofstream(file, std::ios::binary) << damaged(good[seed % good.size()], seed);
  if (!is_refused_by_child(file)) return work(folder, seed, seed + 1, pipe_end);
  fs::remove(file);
  const char report = refused;
  return write(pipe_end, &report, 1) == 1 ? 0 : 1;
}

/// Compiled by AFL++'s compiler the same process reads a thousand files, one after another under the same name.
int read_alone(const std::string& given, const std::string& extension, bool as_tool) {
  const fs::path file = given + "." + extension;
  if (symlink(fs::path(given).filename().c_str(), file.c_str()) != 0 && errno != EEXIST) return 1;
  if (as_tool && is_refused_by_child(file)) return 0;
  H5dont_atexit();
  start_mpi();
  {
    const par::Comm comm(MPI_COMM_WORLD);
    watch_memory();
#ifdef __AFL_HAVE_MANUAL_CONTROL
    while (__AFL_LOOP(1000))
#endif
    {
      const auto outcome = read_one(comm, file);
      if (outcome != accepted && outcome != refused) std::abort();
    }
  }
  MPI_Finalize();
  return 0;
}

struct Tally {
  std::uint64_t accepted = 0, refused = 0, failed = 0, again = 0;
};

void count(Tally& tally, std::uint64_t seed, char report) {
  if (report == accepted)
    ++tally.accepted;
  else if (report == refused)
    ++tally.refused;
  else {
    ++tally.failed;
    std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed),
                report == too_much_memory   ? "takes too much memory"
                : report == too_slow        ? "takes too long"
                : report == nameless_error  ? "the error does not name the file"
                : report == wrong_exception ? "an exception other than Error"
                : report == died            ? "the reader died"
                : report == stalled         ? "no end in sight"
                                            : "garbled report");
  }
}

struct Worker {
  pid_t process = -1;
  int reports = -1;
};

Worker start_worker(const char* program, const char* mode, const fs::path& folder, std::uint64_t first,
                    std::uint64_t last) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) std::abort();
  const auto child = fork();
  if (child == 0) {
    dup2(ends[1], STDIN_FILENO);
    execl(program, program, mode, folder.c_str(), std::to_string(first).c_str(), std::to_string(last).c_str(), nullptr);
    _exit(127);
  }
  close(ends[1]);
  return {child, ends[0]};
}

char next_report(const Worker& worker) {
  pollfd waiting{worker.reports, POLLIN, 0};
  if (poll(&waiting, 1, static_cast<int>(stall_limit.count())) == 0) return stalled;
  char report = 0;
  return read(worker.reports, &report, 1) == 1 ? report : static_cast<char>(died);
}

/// Its status.
int end_worker(const Worker& worker, bool is_stalled) {
  close(worker.reports);
  if (is_stalled) kill(worker.process, SIGKILL);
  int status = 0;
  waitpid(worker.process, &status, 0);
  return status;
}

/// One file once more, as the tools read it: by a child first.
char read_again(const char* program, const fs::path& folder, std::uint64_t seed) {
  const auto worker = start_worker(program, "--work-as-tool", folder, seed, seed + 1);
  const auto report = next_report(worker);
  end_worker(worker, report == stalled);
  return report;
}

/// Starts workers one after another until all seeds are done; each death or stall costs one file. Workers read without
/// a child, which is faster and hides nothing of what goes wrong in our own code; what then goes wrong is decided by
/// reading the file again.
Tally supervise(const char* program, const fs::path& folder, std::uint64_t first, std::uint64_t last) {
  Tally tally;
  while (first < last) {
    const auto worker = start_worker(program, "--work", folder, first, last);
    char report = accepted;
    const auto is_over = [&] { return report == died || report == stalled; };
    while (first < last && !is_over()) {
      report = next_report(worker);
      const bool is_good = report == accepted || report == refused;
      if (!is_good) ++tally.again;
      count(tally, first, is_good ? report : read_again(program, folder, first));
      ++first;
    }
    const auto status = end_worker(worker, report == stalled);
    if (is_over() || status == 0) continue;
    ++tally.failed;
    std::printf("a worker did not end well (status %d)\n", status);
  }
  return tally;
}

int run(const char* program, std::uint64_t n, std::uint64_t first) {
  auto folder_name = (fs::temp_directory_path() / "pamr-fuzz-XXXXXX").string();
  if (mkdtemp(folder_name.data()) == nullptr) return 1;
  const fs::path folder = folder_name;
  const auto start = Clock::now();
  const auto maker = fork();
  if (maker == 0) {
    execl(program, program, "--seeds", folder.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(maker, &status, 0);
  std::vector<Tally> tallies(std::max(1U, std::min(4U, std::thread::hardware_concurrency())));
  if (status == 0) {
    std::vector<std::thread> supervisors;
    for (std::size_t i = 0; i < tallies.size(); ++i)
      supervisors.emplace_back([&, i] {
        tallies[i] = supervise(program, folder, first + n * i / tallies.size(), first + n * (i + 1) / tallies.size());
      });
    for (auto& supervisor : supervisors) supervisor.join();
  }
  fs::remove_all(folder);
  Tally total;
  for (const auto& tally : tallies) {
    total.accepted += tally.accepted;
    total.refused += tally.refused;
    total.failed += tally.failed;
    total.again += tally.again;
  }
  std::printf("%llu damaged files: %llu refused, %llu accepted, %llu failures, %llu read again, %.1f s\n",
              static_cast<unsigned long long>(n), static_cast<unsigned long long>(total.refused),
              static_cast<unsigned long long>(total.accepted), static_cast<unsigned long long>(total.failed),
              static_cast<unsigned long long>(total.again),
              std::chrono::duration<double>(Clock::now() - start).count());
  return status == 0 && total.failed == 0 && total.refused + total.accepted == n && total.refused > 0 ? 0 : 1;
}

/// The good files, the damaged one of a seed, or those of the seeds below a number.
int write_files(const std::string& mode, std::uint64_t seed, char** argv) {
  start_mpi();
  const fs::path folder = mode == "--seeds" ? argv[2] : mode == "--all" ? argv[3] : fs::temp_directory_path();
  {
    const par::Comm comm(MPI_COMM_WORLD);
    write_seed_files(comm, folder);
  }
  if (mode != "--seeds") {
    const auto good = good_files(folder);
    const auto write_damaged = [&](std::uint64_t s, const fs::path& file) {
      std::ofstream(file, std::ios::binary) << damaged(good[s % good.size()], s);
    };
    for (int i = 0; i < n_seed_files(); ++i) fs::remove(folder / seed_name(i));
    if (mode == "--one") write_damaged(seed, argv[3]);
    if (mode == "--all")
      for (std::uint64_t s = 0; s < seed; ++s) write_damaged(s, folder / (std::to_string(s) + "-" + seed_name(0)));
  }
  MPI_Finalize();
  return 0;
}

}  // namespace
}  // namespace pamr::fuzz

int main(int argc, char** argv) {
  using namespace pamr::fuzz;
  const std::string mode = argc > 1 ? argv[1] : "";
  const auto number = [&](int i, std::uint64_t otherwise) { return number_in(argc, argv, i, otherwise); };
  if (mode == "--seeds" || mode == "--one" || mode == "--all") return write_files(mode, number(2, 0), argv);
  if (mode == "--file" || mode == "--file-as-tool") return read_alone(argv[2], argv[3], mode == "--file-as-tool");
  if (mode == "--work") return work(argv[2], number(3, 0), number(4, 0), STDIN_FILENO);
  if (mode == "--work-as-tool") return work_as_tool(argv[2], number(3, 0), STDIN_FILENO);
  return run(argv[0], number(1, 2000), number(2, 1));
}
