// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// A surface that knows by itself what it has in common with others, as faces of one shape do: they share their edges.
/// `project_onto_all` asks it before it intersects surfaces.
class SharedEdges {
 public:
  /// Nearest point of what these surfaces (this one among them) have in common: the curve of two or more, the corner
  /// of more.
  /// Nothing where they do not know.
  virtual std::optional<Vec3> project_to_common(std::span<const Surface* const> surfaces, Vec3 point) const = 0;

 protected:
  ~SharedEdges() = default;
};

}  // namespace pamr::geometry
