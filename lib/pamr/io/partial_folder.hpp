// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <vector>

#include "pamr/io/remove_on_interrupt.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// A folder under a temporary name of its own (`unfinished_name`) until all that belongs in it is there. Without
/// `commit` it goes again, with everything in it, and so do the folders around it that had to be made. One rank makes
/// and commits it. All functions but `share` are local and throw `Error` with the name and the system's reason.
class PartialFolder {
 public:
  explicit PartialFolder(std::filesystem::path folder);
  ~PartialFolder();
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  PartialFolder(PartialFolder&&) = delete;
  PartialFolder& operator=(PartialFolder&&) = delete;

  /// The temporary name; empty before `make` or `share`.
  const std::filesystem::path& path() const { return partial_; }
  /// Makes it, and the folders around it that are missing.
  void make();
  /// Tells all ranks the temporary name that the first one has made. Collective.
  void share(const par::Comm& comm);
  /// Names of files that will be complete in it before it is: an interrupt removes these, too. After `make` or `share`.
  void hold(std::initializer_list<const char*> files);
  /// Gives it its name; a folder that had the name is exchanged for it, in one step where the file system can, and
  /// removed. On the rank that made it.
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  void make_around();
  void take_rights() const;
  void exchange() const;

  std::filesystem::path folder_, partial_;
  std::vector<std::filesystem::path> made_around_;  ///< outermost first
  bool is_made_ = false;                            ///< here, and not yet committed
  std::vector<std::unique_ptr<RemoveOnInterrupt>> remove_on_interrupt_;
};

}  // namespace pamr::io
