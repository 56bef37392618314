// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/lone_start.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

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

/// A folder of this process for what MPI keeps in files while it runs; MPI makes and removes it. Without a name of its
/// own all processes without a daemon share one, and the first that ends removes it from under the others.
std::string own_folder() {
  std::string base = "/tmp";
  for (const auto* name : {"TMP", "TEMP", "TMPDIR"})
    if (const char* value = std::getenv(name); value != nullptr && value[0] == '/') base = value;
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return fmt::format("{}/ompi.alone.{}.{}.{:x}", base, getuid(), getpid(), now);
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
  set(folder_setting, own_folder().c_str());
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
