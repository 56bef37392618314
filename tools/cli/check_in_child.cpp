// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/check_in_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "pamr/base/case_file.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/read_cad.hpp"
#include "pamr/io/cgns/read_cgns.hpp"
#include "pamr/io/native/preflight.hpp"
#include "pamr/par/parent_job.hpp"

namespace pamr::cli {

namespace fs = std::filesystem;

namespace {

template <class Resource>
void set_limit(Resource resource, rlim_t limit) {
  rlimit both{};
  if (getrlimit(resource, &both) != 0) return;
  both.rlim_cur = std::min(limit, both.rlim_max);
  setrlimit(resource, &both);
}

rlim_t address_space_in_use() {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  if (!(statm >> pages)) return RLIM_INFINITY / 2;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// All of the text; false when the parent is gone.
bool send(int pipe_end, std::string_view text) {
  while (!text.empty()) {
    const auto n = write(pipe_end, text.data(), text.size());
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// All bytes until the child has closed its end.
std::string receive(int pipe_end) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    const auto n = read(pipe_end, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

[[noreturn]] void be_child(const std::function<std::string()>& work, ChildLimits limits, int pipe_end) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, limits.processor_seconds);
  set_limit(RLIMIT_AS, address_space_in_use() + limits.memory_bytes);
  try {
    _exit(send(pipe_end, work()) ? 0 : 1);
  } catch (...) {
    _exit(1);
  }
}

/// For the child that reads a file of HDF5: what it needs beyond the limits that hold for all files.
void allow_time_for(std::uint64_t bytes) {
  constexpr rlim_t slowest = rlim_t{4} << 20U;  // a processor inflates at least so many bytes a second
  static std::uint64_t left = 0;                // of the child: less than a second's
  left += bytes;
  rlimit now{};
  if (getrlimit(RLIMIT_CPU, &now) == 0) set_limit(RLIMIT_CPU, now.rlim_cur + left / slowest);
  left %= slowest;
}

/// Where it makes a mesh of an array, too: prisms that are cut and put in order take the most, nine times the array.
void allow_mesh_for(std::uint64_t bytes) {
  allow_time_for(bytes);
  rlimit now{};
  if (getrlimit(RLIMIT_AS, &now) == 0) set_limit(RLIMIT_AS, now.rlim_cur + 12 * bytes);
}

/// Reads a CAD file as a tool will.
void try_reading_cad(const std::string& file, bool fuses_solids) {
  const geometry::CadSource source{file, geometry::read_cad_source(file).text};
  const auto model = geometry::make_cad_model(source, geometry::usual_cad_unit);
  if (!fuses_solids || model->n_solids() < 2) return;
  try {
    (void)geometry::make_cad_assembly(source, geometry::usual_cad_unit, {});
  } catch (const Error&) {  // of solids of which none may be asked for
  }
}

std::string error_of_reading(const std::string& file, bool is_cad, bool fuses_solids) {
  try {
    if (is_cad)
      try_reading_cad(file, fuses_solids);
    else if (fs::path(file).extension() == ".cgns")
      io::try_reading_cgns(file, allow_mesh_for);
    else
      io::try_reading(file, allow_time_for);
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    return fmt::format("file '{}': {}", file, error.what());
  }
  return {};
}

/// HDF5 may take 16 times the memory of the file, and 64 MiB; a CAD text of a megabyte takes OpenCASCADE a second and
/// some ten megabytes.
ChildLimits limits_for(std::uintmax_t bytes, bool is_cad) {
  const auto megabytes = bytes >> 20U;
  if (is_cad) return {.processor_seconds = 60 + 20 * megabytes, .memory_bytes = (1 + megabytes / 8) << 30U};
  return {.processor_seconds = 2, .memory_bytes = 16 * rlim_t{bytes} + (rlim_t{64} << 20U)};
}

/// By the variables of launchers: of Open MPI, PMI (MPICH, Intel MPI, Slurm), PMIx and Slurm. A process without any is
/// alone, as is one that a rank of another job has started.
bool is_first_rank() {
  if (par::leave_parent_job()) return true;
  for (const auto* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})
    if (const char* rank = std::getenv(name)) return std::string_view(rank) == "0";
  return true;
}

bool is_regular_file(const std::string& file) {
  std::error_code failed;
  return fs::is_regular_file(file, failed) && !failed;
}

}  // namespace

ChildAnswer in_child(const std::function<std::string()>& work, ChildLimits limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  const auto child = fork();
  if (child == 0) be_child(work, limits, ends[1]);
  close(ends[1]);
  ChildAnswer answer;
  if (child > 0) answer.text = receive(ends[0]);
  close(ends[0]);
  if (child < 0) return {};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status))
    answer.trouble = strsignal(WTERMSIG(status));  // NOLINT(concurrency-mt-unsafe): there is one thread
  else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    answer.trouble = "failure";
  return answer;
}

std::string check_in_child(const std::string& file, bool fuses_solids) {
  const bool is_cad = geometry::is_cad_file(file);
  if (!is_regular_file(file) || !(is_cad ? geometry::can_read_cad() : io::has_hdf5_signature(file))) return {};
  std::error_code failed;
  const auto limits = limits_for(fs::file_size(file, failed), is_cad);
  const auto [text, trouble] = in_child([&] { return error_of_reading(file, is_cad, fuses_solids); }, limits);
  if (trouble.empty()) return text;
  return fmt::format("file '{}': expected a sound {}, found a damaged one: {} failed on it ({})", file,
                     is_cad ? "shape" : "HDF5 file", is_cad ? "OpenCASCADE" : "HDF5", trouble);
}

std::vector<std::string> files_in_case(const std::string& file) {
  constexpr std::uintmax_t longest = std::uintmax_t{1} << 20U;
  std::error_code failed;
  if (geometry::is_cad_file(file) || io::has_hdf5_signature(file) || fs::file_size(file, failed) > longest) return {};
  try {
    const auto text = read_file(file);
    return text ? files_of_case(*text, file) : std::vector<std::string>{};
  } catch (const Error&) {  // no case file; who reads it says so
    return {};
  }
}

BadFiles check_named_files(int argc, char** argv, FilesIn files_in, bool fuses_solids) {
  BadFiles bad;
  if (!is_first_rank()) return bad;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    names.push_back(word);
    if (word.starts_with("--")) names.push_back(word.substr(word.find('=') + 1));  // --mesh=FILE
  }
  std::set<std::string> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto name = names[i];
    if (!seen.insert(name).second || !is_regular_file(name)) continue;
    if (auto error = check_in_child(name, fuses_solids); !error.empty()) bad.emplace(name, std::move(error));
    if (files_in == nullptr) continue;
    for (auto& inner : files_in(name)) names.push_back(std::move(inner));
  }
  return bad;
}

}  // namespace pamr::cli
