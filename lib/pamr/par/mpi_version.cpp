// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/mpi_version.hpp"

#include <mpi.h>

#include <algorithm>
#include <array>

namespace pamr::par {

std::string mpi_version() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  std::string version(text.data());
  version.resize(std::min(version.find_first_of(",\n"), version.size()));  // what follows says how it was built
  if (const auto at = version.find(" v"); at != std::string::npos) version.erase(at + 1, 1);
  for (auto& letter : version)
    if (letter == '\t') letter = ' ';  // MPICH writes one after the colon
  return version;
}

}  // namespace pamr::par
