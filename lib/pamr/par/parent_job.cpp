// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/parent_job.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace pamr::par {

namespace {

/// What starts ranks: such a process between here and one that uses MPI means that this is a rank of the inner job.
constexpr std::array<std::string_view, 12> launchers{"mpirun",        "mpiexec",   "orterun", "orted",
                                                     "prterun",       "prted",     "prte",    "mpiexec.hydra",
                                                     "hydra_pmi_pro", "hydra_bst", "srun",    "slurmstepd"};
/// Variables that bind a process to its place in a job. Settings of users (OMPI_MCA_btl..., OMPI_MCA_rmaps...) stay.
constexpr std::array<std::string_view, 15> bonds{"PMIX_",
                                                 "PMI_",
                                                 "PMI2_",
                                                 "OMPI_COMM_WORLD_",
                                                 "OMPI_UNIVERSE_",
                                                 "OMPI_MCA_ess",
                                                 "OMPI_MCA_orte",
                                                 "OMPI_MCA_pmix",
                                                 "OMPI_APP_CTX_",
                                                 "OMPI_ARGV",
                                                 "OMPI_COMMAND",
                                                 "OMPI_FILE_LOCATION",
                                                 "OMPI_FIRST_",
                                                 "OMPI_NUM_APP_",
                                                 "OMPI_MCA_initial_wdir"};
constexpr std::array<const char*, 4> rank_variables{"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "PMI_ID"};

std::string file_of(int process, const char* name) { return "/proc/" + std::to_string(process) + "/" + name; }

std::string name_of(int process) {
  std::ifstream file(file_of(process, "comm"));
  std::string name;
  std::getline(file, name);
  return name;
}

/// 0 if it is not known.
int parent_of(int process) {
  std::ifstream file(file_of(process, "status"));
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("PPid:")) return std::atoi(line.c_str() + 5);
  return 0;
}

bool uses_mpi(int process) {
  std::ifstream file(file_of(process, "maps"));
  for (std::string line; std::getline(file, line);)
    if (line.find("/libmpi.so") != std::string::npos || line.find("/libmpich.so") != std::string::npos) return true;
  return false;
}

bool is_child_of_a_rank() {
  for (int process = getppid(); process > 1; process = parent_of(process)) {
    const auto name = name_of(process);
    if (std::find(launchers.begin(), launchers.end(), name) != launchers.end()) return false;
    if (uses_mpi(process)) return true;
  }
  return false;
}

}  // namespace

bool leave_parent_job() {
  const bool is_rank = std::any_of(rank_variables.begin(), rank_variables.end(),
                                   [](const char* name) { return std::getenv(name) != nullptr; });
  if (!is_rank || !is_child_of_a_rank()) return false;
  std::vector<std::string> names;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    if (std::any_of(bonds.begin(), bonds.end(), [&](std::string_view bond) { return text.starts_with(bond); }))
      names.emplace_back(text.substr(0, text.find('=')));
  }
  for (const auto& name : names) unsetenv(name.c_str());
  return true;
}

}  // namespace pamr::par
