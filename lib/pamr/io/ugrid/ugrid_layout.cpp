// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/ugrid/ugrid_layout.hpp"

#include <fmt/format.h>

#include "pamr/base/error.hpp"

namespace pamr::io::ugrid {

bool is_big_endian(const std::filesystem::path& file) {
  const auto kind = file.stem().extension();
  if (kind != ".b8" && kind != ".lb8")
    throw Error(
        fmt::format("file '{}': expected a UGRID file of reals of 8 and integers of 4 bytes, whose name ends in "
                    ".lb8.ugrid or .b8.ugrid, found another kind",
                    file.string()));
  return kind == ".b8";
}

std::filesystem::path mapbc_of(const std::filesystem::path& file) {
  auto name = file.stem();
  return file.parent_path() / name.replace_extension(".mapbc");
}

}  // namespace pamr::io::ugrid
