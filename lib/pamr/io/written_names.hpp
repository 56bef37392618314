// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pamr::io {

/// Told of what is not as in the mesh, on every rank alike; may be none.
using Remark = std::function<void(const std::string& text)>;

/// Which names a format can have.
struct NameRule {
  std::string_view format, what;  ///< as remarks call them: "Gmsh", "patch"
  bool (*is_allowed)(char c);     ///< other characters become `instead`
  char instead = '_';
  std::size_t longest = std::string::npos;  ///< bytes; no character in UTF-8 is cut
  std::vector<std::string> taken = {};      ///< by the format itself
  bool has_outer_blanks = true;             ///< or else blanks at the beginning and the end become `instead`, too
};

/// The names of a mesh as a format can have them, no two alike: names that the format can have stay; others that would
/// become one that is there get `_2`, `_3`, ... at their end. One remark says the first that is changed and how many
/// are. `endings`, one for each name or none at all, stay behind it whatever happens. Local.
std::vector<std::string> written_names(const NameRule& rule, const std::vector<std::string>& names,
                                       const Remark& remark, const std::vector<std::string>& endings = {});

}  // namespace pamr::io
