// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "pamr/io/remove_on_interrupt.hpp"
#include "pamr/io/rights_of.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// A file under a temporary name of its own (`unfinished_name`) until it is complete: every writer's way to the disk.
///
/// - A file that it replaces gives it its rights of access, owner and group (`Rights`).
/// - The temporary file is made exclusively: no file that exists, whatever its name, is written to, and no symbolic
///   link is followed. Two writers of one file do not meet; the last one to commit gives the file its contents.
/// - Without `commit` it is removed: by the destructor, and by `remove_unfinished` when the process is interrupted.
/// - One rank makes and commits it. All functions but `share` are local; they throw `Error` with the name of the file
///   and the system's reason.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path file);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  PartialFile(PartialFile&&) = delete;
  PartialFile& operator=(PartialFile&&) = delete;

  /// The name that it is to get.
  const std::filesystem::path& file() const { return file_; }
  /// The temporary name; empty before `make` or `share`.
  const std::filesystem::path& path() const { return partial_; }
  /// Makes the file, `bytes` long, to see that the disk has room for it. False where the file system cannot tell
  /// without writing; then `occupy` finds out.
  bool make(std::uint64_t bytes);
  /// Tells all ranks the temporary name that the first one has made. Collective.
  void share(const par::Comm& comm);
  /// Writes zeros over bytes `begin .. end`, as far as the disk: several ranks may do their parts at once.
  void occupy(std::uint64_t begin, std::uint64_t end) const;
  /// Makes the disk set `bytes` aside, where the file system can: a later write then cannot run out of space.
  void reserve(std::uint64_t bytes) const;
  /// Has what this process still writes to it go to memory, and be lost: for a library that must be able to complete
  /// the file in order to let go of it. Does not throw.
  void divert() const noexcept;
  /// Writes a text from the beginning on.
  void write(std::string_view text) const;
  /// Has the system begin to bring what was written so far to the disk, so that `commit` waits for less. Does nothing
  /// on ranks that have not made it, nor where the system cannot; does not throw.
  void begin_flush() const noexcept;
  /// Flushes it to the disk and gives it its name, replacing a file of that name in one step. On the rank that made it.
  void commit();
  /// Removes it, on the rank that made it; does not throw.
  void discard() noexcept;

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path file_, partial_;
  std::optional<Rights> replaced_;  ///< of the file that had the name when this one was made
  int descriptor_ = -1;  ///< of the file that was made here and not yet committed: it keeps others from its number
  std::unique_ptr<RemoveOnInterrupt> remove_on_interrupt_;
};

/// Writes a file in one step: all of it or nothing arrives under the name. Throws `Error` as `PartialFile`. Local.
void write_complete(const std::filesystem::path& file, std::string_view text);

}  // namespace pamr::io
