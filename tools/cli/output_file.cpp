// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include "pamr/base/error.hpp"
#include "pamr/io/partial_file.hpp"

namespace pamr::cli {

namespace fs = std::filesystem;

namespace {

std::string because() { return std::generic_category().message(errno); }

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

bool is_device(const fs::file_status& status) {
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Closes a descriptor on every way out.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

void write_to_device(const std::string& name, const std::string& text) {
  const Descriptor file(::open(name.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) throw Error(name + ": cannot be opened for writing: " + because());
  for (std::size_t at = 0; at < text.size();) {
    const auto written = ::write(file.get(), text.data() + at, text.size() - at);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw Error(name + ": cannot be written: " + because());
    at += static_cast<std::size_t>(written);
  }
}

}  // namespace

void require_readable(const std::string& path) {
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (!fs::exists(status)) throw Error(path + ": expected an input file, found nothing of that name");
  if (is_device(status)) throw Error(path + ": expected an input file, found a device or pipe");
  if (::access(path.c_str(), R_OK) != 0) throw Error(path + ": cannot be read: " + because());
}

void require_named(const std::string& path) {
  const auto plain = fs::path(path).lexically_normal();
  // not /dev/shm, where files lie in memory
  if (plain.parent_path() == "/dev" || plain.parent_path() == "/dev/fd" || plain.string().starts_with("/proc/"))
    throw Error(path +
                ": expected the name of a file on a disk, found a stream of this process, which its child and other "
                "ranks do not have: write it to a file first");
}

bool is_device(const std::string& path) {
  std::error_code failed;
  return is_device(fs::status(path, failed));
}

void require_replaceable(const std::string& path) {
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (fs::is_directory(status)) throw Error(path + ": expected a file to write, found a folder");
  if (is_device(status)) return;
  const auto folder = folder_of(path);
  if (!fs::is_directory(folder, failed))
    throw Error(path + ": expected an existing folder to write into, found none named " + folder.string());
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(path + ": the folder " + folder.string() + " cannot be written: " + because());
}

void require_writable(const std::string& path, bool force) {
  require_replaceable(path);
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (!fs::exists(status)) return;
  if (is_device(status)) throw Error(path + ": expected a regular file to replace, found a device or pipe");
  if (!force) throw Error(path + ": the output file exists already (--force replaces it)");
}

void write_whole(const std::string& path, const std::string& text) {
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (is_device(status)) return write_to_device(path, text);
  io::write_complete(path, text);
}

void write_whole(const par::Comm& comm, const std::string& path, const std::string& text) {
  par::agree(comm, [&] {
    if (comm.is_first()) write_whole(path, text);
  });
}

}  // namespace pamr::cli
