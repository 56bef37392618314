// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/lone_start.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "pamr/base/process.hpp"

namespace pamr::par {

namespace {

/// Beginnings of variables that launchers give to the processes of a job: Open MPI's, PMI's and PMIx's, those of a
/// step of Slurm, of LSF's jsrun, of Flux and of ALPS.
constexpr std::array<std::string_view, 9> of_launchers{
    "OMPI_COMM_WORLD_", "PMIX_", "PMI_", "PMI2_", "SLURM_STEP_ID=", "SLURM_PROCID=", "JSM_", "FLUX_", "ALPS_"};

/// The only process of a job: no daemon for jobs to come; messages from this process to itself alone, without the
/// libraries of networks, some of which measure the processor's clock for 0.1 s.
constexpr std::array<std::pair<const char*, const char*>, 4> settings{{{"OMPI_MCA_ess_singleton_isolated", "1"},
                                                                       {"OMPI_MCA_pml", "ob1"},
                                                                       {"OMPI_MCA_btl", "self"},
                                                                       {"OMPI_MCA_osc", "^ucx"}}};

constexpr const char* folder_setting = "OMPI_MCA_orte_jobfam_session_dir";

namespace fs = std::filesystem;

std::string folder_for_temporary_files() {
  std::string base = "/tmp";
  for (const auto* name : {"TMP", "TEMP", "TMPDIR"})
    if (const char* value = std::getenv(name); value != nullptr && value[0] == '/') base = value;
  return base;
}

/// Beginning of the names of this user's folders, which go on with machine, process, start (`ProcessId`) and the time.
std::string own_beginning() { return fmt::format("ompi.alone.{}.", getuid()); }

/// A folder of this process for what MPI keeps in files while it runs; MPI makes and removes it. Without a name of its
/// own all processes without a daemon share one, and the first that ends removes it from under the others.
std::string own_folder(const std::string& base) {
  const auto us = this_process();
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return fmt::format("{}/{}{:08x}-{}-{}.{:x}", base, own_beginning(), us.machine, us.process, us.start, now);
}

/// Nothing for other names, those of older versions among them.
std::optional<ProcessId> owner_of(const std::string& name, const std::string& beginning) {
  ProcessId id;
  int end = 0;
  if (!name.starts_with(beginning) ||
      std::sscanf(name.c_str() + beginning.size(), "%" SCNx64 "-%" SCNu64 "-%" SCNu64 ".%*x%n", &id.machine,
                  &id.process, &id.start, &end) != 3 ||
      end == 0 || beginning.size() + static_cast<std::size_t>(end) != name.size())
    return {};
  return id;
}

/// Removes what processes of this user have left that were killed, or ended without MPI_Finalize.
void remove_folders_of_the_dead(const std::string& base) {
  const auto beginning = own_beginning();
  std::vector<fs::path> dead;
  std::error_code failed;
  for (fs::directory_iterator entry(base, failed), end; !failed && entry != end; entry.increment(failed)) {
    const auto owner = owner_of(entry->path().filename().string(), beginning);
    struct stat status {};
    if (!owner || lstat(entry->path().c_str(), &status) != 0) continue;
    if (S_ISDIR(status.st_mode) && status.st_uid == getuid() && has_ended(*owner) == true)
      dead.push_back(entry->path());
  }
  for (const auto& folder : dead) fs::remove_all(folder, failed);
}

bool is_launched() {
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const auto begins = [&](std::string_view begin) { return text.starts_with(begin); };
    if (std::any_of(of_launchers.begin(), of_launchers.end(), begins)) return true;
  }
  return false;
}

}  // namespace

LoneStart::LoneStart() {
  if (is_launched()) return;
  for (const auto& [name, value] : settings) set(name, value);
  const auto base = folder_for_temporary_files();
  remove_folders_of_the_dead(base);
  set(folder_setting, own_folder(base).c_str());
}

void LoneStart::set(const char* name, const char* value) {
  if (std::getenv(name) != nullptr) return;
  setenv(name, value, 0);
  set_here_.push_back(name);
}

LoneStart::~LoneStart() {
  for (const auto* name : set_here_) unsetenv(name);
}

}  // namespace pamr::par
