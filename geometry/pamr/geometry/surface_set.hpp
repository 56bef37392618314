// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

class Surface;

/// The named surfaces of a mesh, in the order of their description, with all that is written of them to files. Made
/// once, where a file or a case is read or a shape is built, and shared unchanged from then on.
struct SurfaceSet {
  std::vector<std::string> name;
  std::vector<std::string> described_at;  ///< where each is described (file:line:column), to be named in errors
  std::vector<std::shared_ptr<const Surface>> surface;               ///< null where the description was not read
  std::string toml;                                                  ///< the description: entries `[[surface]]`
  std::vector<std::shared_ptr<const Triangulation>> triangulations;  ///< data that the description refers to

  int size() const { return static_cast<int>(surface.size()); }
  /// Index of the surface of that name, -1 where there is none.
  int index_of(std::string_view wanted) const;
  /// The surface of that name, or null.
  const Surface* find(std::string_view wanted) const { return get(index_of(wanted)); }
  /// The surface of that index; null for an index that is none, and where the description was not read.
  const Surface* get(Exact<int> index) const;

  /// Adds a surface; the description does not change. Throws `Error` for a name that is taken.
  void add(std::string new_name, std::string where, std::shared_ptr<const Surface> new_surface);
  /// Adds the surfaces of another set after these, their description and their data too. Throws `Error` for a name
  /// that both have.
  void append(const SurfaceSet& other);

  /// Remarks on data that the files of triangulated surfaces hold and that are left out; each begins with the name of its
  /// surface.
  std::vector<std::string> remarks() const;
};

using SharedSurfaces = std::shared_ptr<const SurfaceSet>;

/// A set without surfaces.
SharedSurfaces no_surfaces();

}  // namespace pamr::geometry
