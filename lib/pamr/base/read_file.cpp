// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/read_file.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <system_error>

namespace pamr {

std::optional<std::string> read_file(const std::filesystem::path& file) {
  constexpr std::size_t least = std::size_t{1} << 16U;
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::error_code unknown;  // as of what is no file on a disk
  const auto expected = std::filesystem::file_size(file, unknown);
  std::string text;
  std::size_t n = 0;
  do {
    text.resize(std::max({least, 2 * n, unknown ? std::size_t{0} : static_cast<std::size_t>(expected) + 1}));
    in.read(text.data() + n, static_cast<std::streamsize>(text.size() - n));
    n += static_cast<std::size_t>(in.gcount());
  } while (in);
  if (in.bad()) return std::nullopt;  // a bad disk, or a folder
  text.resize(n);
  return text;
}

}  // namespace pamr
