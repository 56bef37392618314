// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/profile.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// A number or a vector with the text that stands for it in a description.
template <class T>
struct Written {
  T value;
  std::string toml;
};
/// With 17 digits, from which the same bits are read back.
Written<double> digits(double value);
Written<Vec3> digits(Vec3 value);
/// With the fewest digits from which the same number is read back; both zeros are 0.
Written<double> shortest(double value);
Written<Vec3> shortest(Vec3 value);
/// Whole numbers, as `1.0`.
Written<double> whole(double value);
Written<Vec3> whole(Vec3 value);

/// A surface made from values, with its entry `[[surface]]`: what `surfaces_from_toml` makes of the entry is the same
/// surface, bit for bit. Pre: no control characters in the name. The functions that make it throw `Error` as the
/// constructors of the surfaces do.
struct DescribedSurface {
  std::string name;
  std::shared_ptr<const Surface> surface;
  std::string toml;
};
DescribedSurface described_plane(const std::string& name, const Written<Vec3>& point, const Written<Vec3>& normal);
/// The plane across a coordinate axis (0, 1, 2) that cuts it at `at`.
DescribedSurface described_plane(const std::string& name, Exact<int> axis, double at);
DescribedSurface described_sphere(const std::string& name, const Written<Vec3>& center, const Written<double>& radius);
DescribedSurface described_cylinder(const std::string& name, const Written<Vec3>& point, const Written<Vec3>& axis,
                                    const Written<double>& radius);
/// `half_angle`: degrees.
DescribedSurface described_cone(const std::string& name, const Written<Vec3>& apex, const Written<Vec3>& axis,
                                const Written<double>& half_angle);
DescribedSurface described_torus(const std::string& name, const Written<Vec3>& center, const Written<Vec3>& axis,
                                 const Written<double>& major_radius, const Written<double>& minor_radius);
/// About the x axis, x counted from the origin.
DescribedSurface described_revolution(const std::string& name, const std::vector<ProfilePiece>& profile);
/// The set of these surfaces in this order, an empty line between their entries. `where` is what they belong to.
/// Throws `Error` for a name that stands twice.
SurfaceSet set_of(std::span<const DescribedSurface> surfaces, const std::string& where);

}  // namespace pamr::geometry
