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
  /// Makes the file, empty, and tries whether the disk has `bytes` for it.
  void make(std::uint64_t bytes) const;
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
