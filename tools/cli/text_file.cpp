// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/text_file.hpp"

#include <fstream>
#include <iterator>

#include "pamr/base/error.hpp"

namespace pamr::cli {

std::string read_text(const par::Comm& comm, const std::string& path) {
  std::string text;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    std::ifstream file(path, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(file), {});
    if (!file) throw Error(path + ": expected a file that can be read");
  });
  return comm.broadcast(text);
}

}  // namespace pamr::cli
