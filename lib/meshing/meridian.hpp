// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/axis.hpp"
#include "pamr/geometry/profile.hpp"

namespace pamr::meshing {

using geometry::Meridian;
/// Lines and arcs one after another, arcs of less than half a turn.
using MeridianPath = std::vector<geometry::ProfilePiece>;

/// The 70-degree blunt cone (AGARD WG 18 planetary probe, model of the CNRS SR3 wind tunnel) on its sting and the outer
/// border of the gas about it, meters. Seven numbers define the body; every other one follows from them:
///
///        cone    ___ shoulder            nose: radius 12.5 mm; cone: 70 degrees against the axis; shoulder: radius
///          \    (   |                    1.25 mm up to 25 mm from the axis; base: flat; fillet: radius 2.08 mm;
///           \      | base                sting: radius 6.25 mm
///      nose  |      \_______ sting
///    --------+--------------- axis, x from the nose's tip along the flow
class BluntConeMeridian {
 public:
  /// In a cylinder of the radius `around` that ends at x = `behind`.
  explicit BluntConeMeridian(double around = 60e-3, double behind = 60e-3);

  /// From the axis to 15 mm behind the gas, so that the surface has no edge where the gas ends.
  MeridianPath body() const;
  /// From the axis; the front corner is an arc, because a patch is one smooth surface. 15 mm longer than the gas too.
  MeridianPath outer() const;
  bool is_in_body(Meridian p) const;
  bool is_beyond_outer(Meridian p) const;

  double nose_radius = 12.5e-3, max_radius = 25e-3, shoulder_radius = 1.25e-3, fillet_radius = 2.08e-3,
         sting_radius = 6.25e-3;
  Meridian nose_end, cone_end;              ///< where the neighbors touch
  Meridian shoulder_center, fillet_center;  ///< of the arcs
  Meridian shoulder_end, base_end, fillet_end;
  double inflow_x = -30e-3, outflow_x, outer_radius, rounding_radius = 30e-3;

 private:
  double slope_ = 0;  ///< dr/dx of the cone
};

/// Points along a profile, `n_arc` steps an arc and `n_line` a line; both ends of every step among them, bit for bit.
std::vector<Meridian> sample(const MeridianPath& profile, int n_line, int n_arc);

}  // namespace pamr::meshing
