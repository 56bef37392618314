// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace pamr::test {

/// While it lives, `pwrite` of this process takes at most `bytes_a_write` bytes at once, as it may on a network disk or
/// beyond 2 GB, and `fsync` says that the disk failed if `flush_fails`.
class PoorDisk {
 public:
  PoorDisk(std::size_t bytes_a_write, bool flush_fails);
  ~PoorDisk();
  PoorDisk(const PoorDisk&) = delete;
  PoorDisk& operator=(const PoorDisk&) = delete;
  PoorDisk(PoorDisk&&) = delete;
  PoorDisk& operator=(PoorDisk&&) = delete;
};

}  // namespace pamr::test
