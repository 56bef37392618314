// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/partial_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/rights_of.hpp"
#include "pamr/io/unfinished_name.hpp"

namespace pamr::io {

namespace fs = std::filesystem;

namespace {

constexpr mode_t all_rights = 0777;  // less what the user's mask takes

/// Exchanges two names in one step; false where the system or the file system cannot.
bool swap_names(const fs::path& a, const fs::path& b) {
#ifdef RENAME_EXCHANGE
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
#else
  (void)a;
  (void)b;
  errno = ENOSYS;
  return false;
#endif
}

}  // namespace

PartialFolder::PartialFolder(fs::path folder) : folder_(std::move(folder)) {}

PartialFolder::~PartialFolder() {
  if (!is_made_) return;
  std::error_code ignored;
  if (!partial_.empty()) fs::remove_all(partial_, ignored);
  for (auto around = made_around_.rbegin(); around != made_around_.rend(); ++around) rmdir(around->c_str());
}

void PartialFolder::fail(const char* what) const {
  throw Error("folder '" + folder_.string() + "': " + what + ": " + std::strerror(errno));
}

void PartialFolder::make_around() {
  std::vector<fs::path> missing;
  std::error_code none;
  for (auto around = folder_.parent_path(); !around.empty() && !fs::exists(around, none); around = around.parent_path())
    missing.push_back(around);
  for (; !missing.empty(); missing.pop_back()) {
    if (mkdir(missing.back().c_str(), all_rights) == 0) {
      made_around_.push_back(missing.back());
      remove_on_interrupt_.push_back(std::make_unique<RemoveOnInterrupt>(missing.back()));
    } else if (errno != EEXIST) {  // else another process was faster
      fail("cannot create it");
    }
  }
}

void PartialFolder::make() {
  is_made_ = true;
  make_around();
  const auto name = unfinished_name(folder_);
  remove_on_interrupt_.push_back(std::make_unique<RemoveOnInterrupt>(name));
  constexpr mode_t of_owner = 0700;
  if (mkdir(name.c_str(), rights_of(folder_) ? of_owner : all_rights) != 0) fail("cannot create it");
  partial_ = name;
}

void PartialFolder::share(const par::Comm& comm) {
  partial_ = comm.broadcast(partial_.string());
  if (!comm.is_first()) remove_on_interrupt_.push_back(std::make_unique<RemoveOnInterrupt>(partial_));
}

void PartialFolder::hold(std::initializer_list<const char*> files) {
  for (const auto* file : files) remove_on_interrupt_.push_back(std::make_unique<RemoveOnInterrupt>(partial_ / file));
}

/// Puts the old folder where the new one is, and the reverse.
void PartialFolder::exchange() const {
  if (swap_names(partial_, folder_)) return;
  if (errno != ENOSYS && errno != EINVAL) fail("cannot replace it");
  const auto aside = unfinished_name(folder_);
  if (rename(folder_.c_str(), aside.c_str()) != 0) fail("cannot replace it");
  if (rename(partial_.c_str(), folder_.c_str()) != 0) {
    const auto reason = errno;
    rename(aside.c_str(), folder_.c_str());
    errno = reason;
    fail("cannot rename it when complete");
  }
  if (rename(aside.c_str(), partial_.c_str()) != 0) {
    const auto trouble = "it is written and has its name, but what it replaced stays in " + aside.string();
    fail(trouble.c_str());
  }
}

/// Gives the new folder and each file in it the rights of what has its name in the old one.
void PartialFolder::take_rights() const {
  const auto give = [&](const fs::path& to, const fs::path& from) {
    const auto rights = rights_of(from);
    if (!rights) return;
    const int opened = ::open(to.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    const bool is_given = opened >= 0 && set_rights(opened, *rights);
    const auto reason = errno;
    if (opened >= 0) ::close(opened);
    errno = reason;
    if (!is_given) fail("cannot give it the rights of what it replaces");
  };
  std::error_code none;
  for (fs::directory_iterator entry(partial_, none), end; entry != end; entry.increment(none))
    give(entry->path(), folder_ / entry->path().filename());
  give(partial_, folder_);
}

void PartialFolder::commit() {
  take_rights();
  // An empty folder of that name is replaced as well; one with something in it, or a link to one, is exchanged.
  const bool is_new = rename(partial_.c_str(), folder_.c_str()) == 0;
  if (!is_new && errno != ENOTEMPTY && errno != EEXIST && errno != ENOTDIR) fail("cannot rename it when complete");
  if (!is_new) exchange();
  add_complete_output(folder_);
  is_made_ = false;
  remove_on_interrupt_.clear();
  std::error_code failed;
  if (!is_new) fs::remove_all(partial_, failed);
  if (failed)
    throw Error("folder '" + folder_.string() + "': written, but what it replaced cannot be removed from " +
                partial_.string() + ": " + failed.message());
}

}  // namespace pamr::io
