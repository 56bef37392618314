// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/partial_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

/// Closes a file descriptor at the end of the scope.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : number_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

/// False when the space is not there. A file system that cannot tell counts as having it.
bool allocate(int descriptor, std::uint64_t bytes) {
  while (fallocate(descriptor, 0, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    return errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL;
  }
  return true;
}

}  // namespace

PartialFile::PartialFile(std::filesystem::path file) : file_(std::move(file)), partial_(file_) {
  partial_ += ".partial";
}

void PartialFile::fail(const char* what) const {
  throw Error("file '" + file_.string() + "': " + what + ": " + std::strerror(errno));
}

void PartialFile::make(std::uint64_t bytes) const {
  std::error_code code;
  if (std::filesystem::is_directory(file_, code))
    throw Error("file '" + file_.string() + "': expected a name for a file, found a folder of that name");
  const Descriptor descriptor(partial_, O_RDWR | O_CREAT | O_TRUNC);
  if (!descriptor.is_open()) fail("cannot create it");
  if (!allocate(descriptor.number(), bytes)) {
    const auto reason = errno;
    discard();
    errno = reason;
    fail("cannot write it");
  }
  if (ftruncate(descriptor.number(), 0) != 0) fail("cannot create it");
}

void PartialFile::reserve(std::uint64_t bytes) const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || !allocate(descriptor.number(), bytes)) fail("cannot write it");
}

void PartialFile::commit() const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || fsync(descriptor.number()) != 0) fail("cannot flush it to the disk");
  if (rename(partial_.c_str(), file_.c_str()) != 0) fail("cannot rename it when complete");
  // The new name is safe once the folder is flushed; some file systems cannot and need not.
  const auto folder = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
  const Descriptor directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.is_open() && fsync(directory.number()) != 0 && errno == EIO) fail("cannot flush its folder");
}

void PartialFile::discard() const noexcept { unlink(partial_.c_str()); }

}  // namespace pamr::io
