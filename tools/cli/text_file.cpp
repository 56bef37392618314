// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/text_file.hpp"

#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/read_file.hpp"

namespace pamr::cli {

std::string read_text(const par::Comm& comm, const std::string& path) {
  std::string text;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    auto found = read_file(path);
    if (!found) throw Error(path + ": expected a file that can be read");
    text = std::move(*found);
  });
  return comm.broadcast(text);
}

}  // namespace pamr::cli
