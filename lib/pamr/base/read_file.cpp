// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/read_file.hpp"

#include <fstream>
#include <iterator>

namespace pamr {

std::optional<std::string> read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  try {
    return std::string(std::istreambuf_iterator<char>(in), {});
  } catch (const std::ios_base::failure&) {  // a bad disk, or a folder
    return std::nullopt;
  }
}

}  // namespace pamr
