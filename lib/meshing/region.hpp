// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pamr::meshing {

/// Sides of up to 32 surfaces, a bit each: set where the point lies on the side to which the surface's normal points.
using Sides = std::uint32_t;

/// A boolean combination of the sides of surfaces: `+name` is the side to which the normal points, `-name` the other
/// one, `&` both, `|` either, `!` not, with parentheses; `!` binds before `&`, `&` before `|`.
///
///     "-box & +ball"      in the box, not in the ball
class Region {
 public:
  static constexpr std::size_t max_surfaces = 32;

  /// Throws `Error` that begins with `where` for text that is no region, a name that is not among `names`, or a name
  /// that the text does not use. `side_of`: the number of the side that each name means, ascending from 0; names of one
  /// number mean the same, and one of them is enough in the text.
  Region(std::string_view text, std::span<const std::string> names, std::span<const int> side_of,
         const std::string& where);
  /// The same where each name means a side of its own.
  Region(std::string_view text, std::span<const std::string> names, const std::string& where);
  /// One of several regions: it need not use all names. Throws as above.
  static Region among_others(std::string_view text, std::span<const std::string> names, std::span<const int> side_of,
                             const std::string& where);

  bool contains(Sides sides) const;
  Sides used() const;  ///< a bit for each side that the text names

 private:
  friend class RegionParser;
  Region() = default;
  enum : int { both = -1, either = -2, inverse = -3 };
  std::vector<int> program_;  ///< postfix: 2 i for +i, 2 i + 1 for -i, or an operation
};

}  // namespace pamr::meshing
