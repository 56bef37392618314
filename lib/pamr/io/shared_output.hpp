// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "pamr/io/partial_file.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// A file that all ranks write together, piece after piece: of each piece the ranks' parts follow one another. It gets
/// its name when it is complete; an error leaves nothing behind. Every member is collective and throws the same `Error`
/// on every rank.
class SharedOutput {
 public:
  SharedOutput(const par::Comm& comm, const std::filesystem::path& file);
  ~SharedOutput();
  SharedOutput(const SharedOutput&) = delete;
  SharedOutput& operator=(const SharedOutput&) = delete;
  SharedOutput(SharedOutput&&) = delete;
  SharedOutput& operator=(SharedOutput&&) = delete;

  /// The name that it is to get. Local.
  const std::filesystem::path& file() const { return file_.file(); }
  /// The temporary name, for what the first rank writes by other means. Local.
  const std::filesystem::path& path() const { return file_.path(); }
  /// Writes the parts of all ranks, in rank order, from a byte on that the first rank says; returns where they end.
  std::int64_t write_at(std::int64_t begin, std::span<const std::byte> part);
  /// Appends the parts of all ranks, in rank order.
  void append(std::span<const std::byte> part);
  void append(std::string_view part) { append(std::as_bytes(std::span<const char>(part.data(), part.size()))); }
  /// Appends what the first rank says.
  void append_once(std::string_view text) { append(comm_.is_first() ? text : std::string_view()); }
  void commit();

 private:
  const par::Comm& comm_;
  PartialFile file_;
  int descriptor_ = -1;
  std::int64_t end_ = 0;
};

}  // namespace pamr::io
