// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace pamr::io {

/// The file under its temporary name `<file>.partial`, in the same folder. All functions are local and meant for one
/// rank; they throw `Error` with the name of the file and the system's reason.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path file);

  const std::filesystem::path& path() const { return partial_; }
  /// Makes the file, `bytes` long, to see that the disk has room for it. False where the file system cannot tell
  /// without writing; then `occupy` finds out.
  bool make(std::uint64_t bytes) const;
  /// Writes zeros over bytes `begin .. end`, as far as the disk: several ranks may do their parts at once.
  void occupy(std::uint64_t begin, std::uint64_t end) const;
  /// Makes the disk set `bytes` aside, where the file system can: a later write then cannot run out of space.
  void reserve(std::uint64_t bytes) const;
  /// Flushes it to the disk and gives it its name, replacing a file of that name in one step.
  void commit() const;
  /// Removes it; does not throw.
  void discard() const noexcept;

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path file_, partial_;
};

}  // namespace pamr::io
