// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/partial_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/unfinished_name.hpp"

namespace pamr::io {

namespace {

/// Opens a temporary file, never through a symbolic link, or a folder; closes it at the end of the scope.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : number_(open(path.c_str(), flags | O_CLOEXEC | (is_folder(flags) ? 0 : O_NOFOLLOW), 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  static bool is_folder(int flags) { return (flags & O_DIRECTORY) != 0; }

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

PartialFile::PartialFile(std::filesystem::path file) : file_(std::move(file)) {}

PartialFile::~PartialFile() { discard(); }

void PartialFile::fail(const char* what) const {
  throw Error("file '" + file_.string() + "': " + what + ": " + std::strerror(errno));
}

bool PartialFile::make(std::uint64_t bytes) {
  std::error_code code;
  if (std::filesystem::is_directory(file_, code))
    throw Error("file '" + file_.string() + "': expected a name for a file, found a folder of that name");
  partial_ = unfinished_name(file_);
  remove_on_interrupt_ = std::make_unique<RemoveOnInterrupt>(partial_);
  replaced_ = rights_of(file_);
  constexpr mode_t of_new = 0666, of_owner = 0600;  // nobody else reads it before it has the rights of the old one
  descriptor_ =
      open(partial_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, replaced_ ? of_owner : of_new);
  if (descriptor_ < 0) {
    const auto reason = errno;
    remove_on_interrupt_.reset();
    errno = reason;
    fail("cannot create it");
  }
  const auto space = allocate(descriptor_, bytes);
  if (space == Space::missing) {
    const auto reason = errno;
    discard();
    errno = reason;
    fail("cannot write it");
  }
  return space == Space::set_aside;
}

void PartialFile::share(const par::Comm& comm) {
  partial_ = comm.broadcast(partial_.string());
  if (!comm.is_first()) remove_on_interrupt_ = std::make_unique<RemoveOnInterrupt>(partial_);
}

void PartialFile::occupy(std::uint64_t begin, std::uint64_t end) const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || !write_zeros(descriptor.number(), begin, end)) fail("cannot write it");
}

void PartialFile::reserve(std::uint64_t bytes) const {
  const Descriptor descriptor(partial_, O_RDWR);
  if (!descriptor.is_open() || allocate(descriptor.number(), bytes) == Space::missing) fail("cannot write it");
}

void PartialFile::write(std::string_view text) const {
  const Descriptor descriptor(partial_, O_WRONLY);
  if (!descriptor.is_open()) fail("cannot write it");
  for (std::size_t at = 0; at < text.size();) {
    const auto n = pwrite(descriptor.number(), text.data() + at, text.size() - at, static_cast<off_t>(at));
    if (n < 0 && errno != EINTR) fail("cannot write it");
    if (n > 0) at += static_cast<std::size_t>(n);
  }
}

void PartialFile::divert() const noexcept {
  struct stat lost {
  }, open{};
  if (stat(partial_.c_str(), &lost) != 0) return;
  const int memory = memfd_create("pamr", MFD_CLOEXEC);
  if (memory < 0) return;
  const int n = static_cast<int>(sysconf(_SC_OPEN_MAX));
  for (int number = 3; number < std::min(n, 65536); ++number)
    if (number != descriptor_ && number != memory && fstat(number, &open) == 0 && open.st_dev == lost.st_dev &&
        open.st_ino == lost.st_ino)
      dup3(memory, number, O_CLOEXEC);
  ::close(memory);
}

void PartialFile::begin_flush() const noexcept {
  if (descriptor_ >= 0) sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE);
}

void PartialFile::commit() {
  if (replaced_ && !set_rights(descriptor_, *replaced_)) fail("cannot give it the rights of the file that it replaces");
  struct stat made {
  }, found{};
  if (fstat(descriptor_, &made) != 0 || lstat(partial_.c_str(), &found) != 0) fail("cannot flush it to the disk");
  if (made.st_dev != found.st_dev || made.st_ino != found.st_ino)
    throw Error("file '" + file_.string() + "': expected its temporary file " + partial_.string() +
                ", found another one in its place");
  if (fsync(descriptor_) != 0) fail("cannot flush it to the disk");
  if (rename(partial_.c_str(), file_.c_str()) != 0) fail("cannot rename it when complete");
  remove_on_interrupt_.reset();
  add_complete_output(file_);
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR)
    fail("it is written, flushed and has its name, but cannot be closed");
  // The new name is safe once the folder is flushed; some file systems cannot and need not.
  const auto folder = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
  const Descriptor directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.is_open() && fsync(directory.number()) != 0 && errno == EIO)
    fail("it is written, complete and has its name, but its folder cannot be flushed to the disk");
}

void PartialFile::discard() noexcept {
  if (descriptor_ >= 0) {
    unlink(partial_.c_str());
    ::close(std::exchange(descriptor_, -1));
  }
  remove_on_interrupt_.reset();
}

void write_complete(const std::filesystem::path& file, std::string_view text) {
  PartialFile partial(file);
  (void)partial.make(0);
  partial.write(text);
  partial.commit();
}

}  // namespace pamr::io
