// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// The named parts of a surface file: solids of a text STL, groups and objects of an OBJ.
struct NamedParts {
  std::vector<std::string> name;  ///< different ones, in the order of the file; "" for what has no name
  std::vector<int> part;          ///< of each triangle
};

/// Which named parts divide a surface: the others are one part without a name. Null: none do.
using PartChoice = std::function<bool(const std::string& name)>;

/// A surface file as it was read.
struct NamedTriangulation {
  Triangulation surface;
  NamedParts parts;               ///< no names where the format has none
  std::vector<std::string> rest;  ///< the remarks on the surface, but for the one that names are left out
};

/// The number of the part of a name, which is added where it is new. O(number of parts).
inline int part_called(NamedParts& parts, const std::string& name) {
  const auto place = std::find(parts.name.begin(), parts.name.end(), name) - parts.name.begin();
  if (place == std::ssize(parts.name)) parts.name.push_back(name);
  return static_cast<int>(place);
}

}  // namespace pamr::geometry
