// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/poor_disk.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <limits>

namespace pamr::test {
namespace {

constexpr auto no_limit = std::numeric_limits<std::size_t>::max();
std::atomic<std::size_t> most = no_limit;
std::atomic<bool> fails = false;

}  // namespace

PoorDisk::PoorDisk(std::size_t bytes_a_write, bool flush_fails) {
  most = bytes_a_write;
  fails = flush_fails;
}

PoorDisk::~PoorDisk() {
  most = no_limit;
  fails = false;
}

}  // namespace pamr::test

// The program's own functions of these names come before those of the C library.
extern "C" ssize_t pwrite(int descriptor, const void* data, std::size_t bytes, off_t at) {
  return syscall(SYS_pwrite64, descriptor, data, std::min<std::size_t>(bytes, pamr::test::most), at);
}

extern "C" int fsync(int descriptor) {
  if (!pamr::test::fails) return static_cast<int>(syscall(SYS_fsync, descriptor));
  errno = EIO;
  return -1;
}
