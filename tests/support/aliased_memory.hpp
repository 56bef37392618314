// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <span>
#include <stdexcept>

namespace pamr::test {

/// Addresses of `bytes` bytes that are `window` bytes of memory again and again: byte `i` is byte `i % window`. For
/// messages and slabs beyond 2^31 bytes in little memory.
class AliasedMemory {
 public:
  /// A multiple of the page size, and no divisor of the pieces that messages are cut into.
  static constexpr std::size_t window = 257 * std::size_t{4096};

  explicit AliasedMemory(std::size_t bytes) : size_(bytes), mapped_((bytes + window - 1) / window * window) {
    const int file = ::memfd_create("pamr_test", MFD_CLOEXEC);
    if (file < 0 || ::ftruncate(file, static_cast<off_t>(window)) != 0) throw std::runtime_error("memfd");
    auto* const begin = ::mmap(nullptr, mapped_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (begin == MAP_FAILED) throw std::runtime_error("mmap");
    begin_ = static_cast<std::byte*>(begin);
    for (std::size_t at = 0; at < mapped_; at += window)
      if (::mmap(begin_ + at, window, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0) == MAP_FAILED)
        throw std::runtime_error("mmap of a window");
    ::close(file);
  }
  ~AliasedMemory() { ::munmap(begin_, mapped_); }
  AliasedMemory(const AliasedMemory&) = delete;
  AliasedMemory& operator=(const AliasedMemory&) = delete;
  AliasedMemory(AliasedMemory&&) = delete;
  AliasedMemory& operator=(AliasedMemory&&) = delete;

  std::span<std::byte> bytes() const { return {begin_, size_}; }
  std::span<std::byte> first_window() const { return {begin_, window}; }

 private:
  std::size_t size_, mapped_;
  std::byte* begin_ = nullptr;
};

}  // namespace pamr::test
