// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/resource.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace pamr::cli {

// Why input files are read by a child process first
//
// A damaged file (a flipped byte, a broken copy, a bad disk) may make HDF5 1.10 crash, run for ever or ask for all the
// memory of the machine inside HDF5, before any check of ours sees a value; a damaged CAD text does so with
// OpenCASCADE. On 1,000 ranks that is a dead job without a message. Once MPI has started many sites and transports
// forbid a fork, so the first rank has its input files read by a child before that, and tells the others what came of
// it when all are there (`Session::check_input`). The library never forks. This guards against damage, not against
// attack: the child has the rights of its parent.

/// Limits on the processor time and memory of a child.
struct ChildLimits {
  rlim_t processor_seconds = 2;
  rlim_t memory_bytes = 0;  ///< beyond what this process has
};

struct ChildAnswer {
  std::string text;     ///< what its work returned
  std::string trouble;  ///< how it ended otherwise ("Segmentation fault"); empty: well
};

/// The work in a forked process that may die of it, with standard streams closed. Both are empty where the system lets
/// no process start. `work` may use neither MPI nor anything that other threads of this process may hold. Local.
ChildAnswer in_child(const std::function<std::string()>& work, ChildLimits limits);

/// Has a file of HDF5 or CAD read by a child; other files are not looked at. `fuses_solids`: it fuses the solids of a
/// CAD file, too, if there are several; solids that cannot be fused are not wrong yet, since some may be chosen.
/// Returns what is wrong with it: what the reader says of it, or how the child ended. Empty: nothing. Local.
std::string check_in_child(const std::string& file, bool fuses_solids = false);

/// Errors of files, by the files' names.
using BadFiles = std::map<std::string, std::string>;

/// Files that a file names.
using FilesIn = std::vector<std::string> (*)(const std::string& file);

/// `FilesIn` of a case file (`files_of_case`); none for a file of another kind.
std::vector<std::string> files_in_case(const std::string& file);

/// `check_in_child` for each file that the command line names, and for those that `files_in` (may be null) finds in
/// them. Yields the bad ones with their errors; outputs to be replaced may be among them. To be called before MPI
/// starts: only the first rank looks, by the variables that launchers set, elsewhere there is nothing. Local.
BadFiles check_named_files(int argc, char** argv, FilesIn files_in, bool fuses_solids = false);

}  // namespace pamr::cli
