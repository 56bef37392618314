// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A surface of a solid that lines divide into smooth pieces: a triangulated one with its creases, a CAD shape with its
/// edges. Each piece that bounds the solid becomes a piece of the domain, each line a curve that mesh edges follow.
class DividedSurface {
 public:
  virtual ~DividedSurface() = default;
  DividedSurface() = default;
  DividedSurface(const DividedSurface&) = delete;
  DividedSurface& operator=(const DividedSurface&) = delete;
  DividedSurface(DividedSurface&&) = delete;
  DividedSurface& operator=(DividedSurface&&) = delete;

  virtual std::size_t n_pieces() const = 0;
  /// The piece alone, as a surface.
  virtual std::shared_ptr<const geometry::Surface> piece(int number) const = 0;
  /// Name of the part of its file that the piece belongs to; empty where that has none.
  virtual std::string part_of(int /*number*/) const { return {}; }
  /// Number of the piece that is nearest to a point.
  virtual int piece_at(geometry::Vec3 point) const = 0;
  /// Calls `use` with some points of each piece, on it or near it.
  virtual void for_each_sample(const std::function<void(int piece, geometry::Vec3 point)>& use) const = 0;

  virtual std::size_t n_lines() const = 0;
  /// Points of a line, finely; the first one again at the end of a closed line. Lines end in common corners to the last
  /// bit.
  virtual const std::vector<geometry::Vec3>& line(std::size_t number) const = 0;
  virtual geometry::Vec3 nearest_on_line(std::size_t number, geometry::Vec3 point) const = 0;
  /// The pieces at a line.
  virtual std::vector<int> pieces_of_line(std::size_t number) const = 0;
};

/// The surface as one in pieces, null where it is in one by its kind. The result must not outlive `surface`.
std::shared_ptr<const DividedSurface> divided(const geometry::Surface& surface);

}  // namespace pamr::meshing
