// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/exact.hpp"

namespace pamr::refine {

/// What happens to a closure cell that has to be split again. All but `removable` use 1:2, 1:4 and 1:8 only.
/// Source of `isotropic` and `short_edge`: the PAMR paper, section 2.1.3 and its reference [18].
enum class QualityControl : std::uint8_t {
  none,        ///< split like any other cell; quality falls at every level
  isotropic,   ///< it becomes eight
  short_edge,  ///< a mark on a halved edge takes the better face of that edge with it
  removable,   ///< its family is taken back to the parent, which is closed anew or becomes eight: quality is bounded
};

/// Their names on command lines and in reports.
inline constexpr std::array<std::pair<const char*, QualityControl>, 4> quality_control_names{
    {{"none", QualityControl::none},
     {"isotropic", QualityControl::isotropic},
     {"short-edge", QualityControl::short_edge},
     {"removable", QualityControl::removable}}};

/// The policy of that name. Throws `Error` for any other name.
QualityControl quality_control_named(std::string_view name);
/// All the names, for help texts and checks of command lines.
std::vector<std::string> quality_control_list();

inline constexpr double default_shape_floor = 0.35;

/// Which inner edges of level 0 may bend for better shapes of what they are split into (docs/coarse-walls.md). Decides
/// when a mesh of level 0 is split; later calls go on with what was decided then.
enum class Bend : std::uint8_t {
  none,   ///< new nodes are placed from the ends of their edges, level after level
  walls,  ///< those near walls that are curved more than their edges are short
  all,    ///< all; children may then leave their parents anywhere
};
inline constexpr std::array<std::pair<const char*, Bend>, 3> bend_names{
    {{"none", Bend::none}, {"walls", Bend::walls}, {"all", Bend::all}}};
/// The choice of that name. Throws `Error` for any other name.
Bend bend_named(std::string_view name);
/// All the names, for help texts and checks of command lines.
std::vector<std::string> bend_list();

/// How to refine once.
struct Options {
  QualityControl quality_control = QualityControl::removable;
  /// Of `removable`: smallest mean ratio of closure cells, as far as 1:8 would reach it; 0: none. At most 1.
  double shape_floor = default_shape_floor;
  Exact<bool> project = true;  ///< put new boundary nodes onto the surfaces of their patches
  Bend bend = Bend::walls;     ///< not looked at where nothing is put onto surfaces
  Exact<bool> parent_field =
      true;                   ///< add the integer cell field `parent`: input cell that held the new cell's centroid
  std::string marks_field{};  ///< cell field to drop from the result (it held the marks); empty: none
  /// Cell fields of reals of which the sum of value times volume is kept, also where nodes go onto curved walls. All
  /// others keep values: children have that of their parent. Both are the same where walls are flat.
  std::vector<std::string> integrals{};
};

/// Throws `Error` unless the options are such as can be obeyed.
void require_sound(const Options& options);

}  // namespace pamr::refine
