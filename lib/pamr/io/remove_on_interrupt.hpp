// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>

namespace pamr::io {

/// While it lives, `remove_unfinished` removes this file or empty folder: what is being written and has no name of its
/// own yet. At most 64 at a time; more are not remembered. Local.
class RemoveOnInterrupt {
 public:
  explicit RemoveOnInterrupt(const std::filesystem::path& path);
  ~RemoveOnInterrupt();
  RemoveOnInterrupt(const RemoveOnInterrupt&) = delete;
  RemoveOnInterrupt& operator=(const RemoveOnInterrupt&) = delete;
  RemoveOnInterrupt(RemoveOnInterrupt&&) = delete;
  RemoveOnInterrupt& operator=(RemoveOnInterrupt&&) = delete;

 private:
  std::size_t slot_;
};

/// Removes the unfinished files of this process, and the folders that are empty then. May be called by a signal
/// handler; leaves errno as it was. Local.
void remove_unfinished() noexcept;

}  // namespace pamr::io
