// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/shared_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/io/complete_outputs.hpp"

namespace pamr::io {

SharedOutput::SharedOutput(const par::Comm& comm, const std::filesystem::path& file) : comm_(comm), file_(file) {
  par::agree(comm, [&] {
    if (comm.is_first()) (void)file_.make(0);
  });
  file_.share(comm);
  try {
    par::agree(comm, [&] {
      descriptor_ = open(file_.path().c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
      if (descriptor_ < 0) throw Error("file '" + file.string() + "': cannot open it: " + std::strerror(errno));
    });
  } catch (const Error&) {
    if (descriptor_ >= 0) ::close(descriptor_);
    throw;
  }
}

SharedOutput::~SharedOutput() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SharedOutput::append(std::span<const std::byte> part) { end_ = write_at(end_, part); }

std::int64_t SharedOutput::write_at(std::int64_t begin, std::span<const std::byte> part) {
  begin = comm_.sum(comm_.is_first() ? begin : 0);
  const auto here = static_cast<std::int64_t>(part.size());
  auto at = begin + comm_.exclusive_sum(here);
  const auto end = begin + comm_.sum(here);
  par::agree(comm_, [&] {
    while (!part.empty()) {
      const auto n = pwrite(descriptor_, part.data(), part.size(), static_cast<off_t>(at));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) throw Error("file '" + file_.file().string() + "': cannot write it: " + std::strerror(errno));
      part = part.subspan(static_cast<std::size_t>(n));
      at += n;
    }
  });
  return end;
}

void SharedOutput::commit() {
  par::agree(comm_, [&] {
    if (fsync(descriptor_) != 0)
      throw Error("file '" + file_.file().string() + "': cannot write it: " + std::strerror(errno));
    if (comm_.is_first()) file_.commit();
  });
  add_complete_output(file_.file());
}

}  // namespace pamr::io
