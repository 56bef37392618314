// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

// Names of files and folders while they are being written
//
// `OUT.<host>-<machine>-<process>-<start>-<number>.partial` beside OUT, so that it can be renamed:
//   host     name of the machine, for people
//   machine  8 hexadecimal digits: hash of the running system (boot) and of its namespace of processes (container)
//   process  its number, and
//   start    the moment at which it was started, in ticks since the system was, 0 where that is not known
//   number   counts the names of this process
// No two processes, wherever they run, make the same name; a killed one leaves a name that tells that it is dead. No
// lock on the file is needed, which the file systems of clusters do not all keep and which could stand in the way of
// MPI's own.
namespace pamr::io {

/// A new name for `target` while it is written. Local.
std::filesystem::path unfinished_name(const std::filesystem::path& target);

/// Removes what processes that are dead have left of `target`, but none of `keep`. Names of this machine: when no
/// process has the number and the start. Of other machines (or of this one before it was started anew): when nothing
/// was written for a day, since nobody can tell here whether their process lives. Folders go with what is in them.
/// Never throws for what cannot be read or removed. Local.
void remove_leftovers(const std::filesystem::path& target, const std::vector<std::string>& keep);

/// The same of every target in a folder that `is_target` says is one. `is_cut`: the name was too long for a temporary
/// one, and is its beginning.
void remove_leftovers(const std::filesystem::path& folder,
                      const std::function<bool(const std::string& name, bool is_cut)>& is_target,
                      const std::vector<std::string>& keep);

}  // namespace pamr::io
