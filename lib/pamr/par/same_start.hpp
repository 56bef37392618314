// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Version, folder and arguments of a program on one rank.
struct Start {
  std::string version;                 ///< of the program
  std::string folder;                  ///< in which names of files are looked up; empty where that is not known
  std::vector<std::string> arguments;  ///< without the program's name
};

/// `argv` without its first word, and the current folder. Local.
Start start_of(std::string version, int argc, char** argv);

/// Throws `Error`, the same on every rank, that names the first difference to the first rank unless all have begun with
/// the same: ranks with different options would wait for one another for ever. Collective: two reductions of a number
/// where there is no difference.
void require_same_start(const Comm& comm, const Start& start);

}  // namespace pamr::par
