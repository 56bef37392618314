// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_triangulation.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/read_obj.hpp"
#include "pamr/geometry/triangulated/read_ply.hpp"
#include "pamr/geometry/triangulated/read_stl.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

Triangulation read_triangulation(const std::filesystem::path& file, bool open_allowed) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!stream || !std::filesystem::is_regular_file(file, error))
    throw Error(file.string() + ": expected a surface file that can be read, found " +
                (errno != 0 ? std::strerror(errno) : "no such file"));
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw Error(file.string() + ": cannot be read");
  return parse_triangulation(bytes, file.string(), open_allowed);
}

Triangulation parse_triangulation(std::string_view bytes, const std::string& where, bool open_allowed) {
  const auto ending = std::filesystem::path(where).extension().string();
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(fmt::format("{}: expected a surface file below 2 GiB, found {} bytes", where, bytes.size()));
  Triangulation surface;
  if (is_same_word(ending, ".stl"))
    surface = parse_stl(bytes, where);
  else if (is_same_word(ending, ".obj"))
    surface = parse_obj(bytes, where);
  else if (is_same_word(ending, ".ply"))
    surface = parse_ply(bytes, where);
  else if (is_same_word(ending, ".off"))
    surface = parse_off(bytes, where);
  else
    throw Error(where + ": expected a surface file ending in .stl, .obj, .ply or .off, found \"" + ending + "\"");
  drop_unused_points(surface);
  require_valid(surface, where, open_allowed);
  return surface;
}

}  // namespace pamr::geometry
