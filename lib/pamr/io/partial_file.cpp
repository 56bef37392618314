// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/partial_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

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

enum class Space { set_aside, missing, unknown };

Space allocate(int descriptor, std::uint64_t bytes) {
  while (fallocate(descriptor, 0, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    return errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL ? Space::unknown : Space::missing;
  }
  return Space::set_aside;
}

bool write_zeros(int descriptor, std::uint64_t begin, std::uint64_t end) {
  const std::vector<char> zeros(std::size_t{1} << 20U);
  while (begin < end) {
    const auto n =
        pwrite(descriptor, zeros.data(), std::min<std::uint64_t>(zeros.size(), end - begin), static_cast<off_t>(begin));
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) begin += static_cast<std::uint64_t>(n);
  }
  return fsync(descriptor) == 0;
}

}  // namespace

PartialFile::PartialFile(std::filesystem::path file) : file_(std::move(file)), partial_(file_) {
  partial_ += ".partial";
}

void PartialFile::fail(const char* what) const {
  throw Error("file '" + file_.string() + "': " + what + ": " + std::strerror(errno));
}

bool PartialFile::make(std::uint64_t bytes) const {
  std::error_code code;
  if (std::filesystem::is_directory(file_, code))
    throw Error("file '" + file_.string() + "': expected a name for a file, found a folder of that name");
  const Descriptor descriptor(partial_, O_RDWR | O_CREAT | O_TRUNC);
  if (!descriptor.is_open()) fail("cannot create it");
  const auto space = allocate(descriptor.number(), bytes);
  if (space == Space::missing) {
    const auto reason = errno;
    discard();
    errno = reason;
    fail("cannot write it");
  }
  return space == Space::set_aside;
}

void PartialFile::occupy(std::uint64_t begin, std::uint64_t end) const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || !write_zeros(descriptor.number(), begin, end)) fail("cannot write it");
}

void PartialFile::reserve(std::uint64_t bytes) const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || allocate(descriptor.number(), bytes) == Space::missing) fail("cannot write it");
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
