// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace pamr::meshing {

/// A point of the half plane of a surface of revolution: x along the axis, r from it.
struct MeridianPoint {
  double x = 0, r = 0;
};

/// One step of a profile: straight, or an arc of at most half a turn about `center`.
struct ProfileStep {
  MeridianPoint from, to;
  bool is_arc = false;
  MeridianPoint center{};
};

using Profile = std::vector<ProfileStep>;

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
  BluntConeMeridian();

  /// From the axis to 15 mm behind the gas, so that the surface has no edge where the gas ends.
  Profile body() const;
  /// From the axis; the front corner is an arc, because a patch is one smooth surface. 15 mm longer than the gas too.
  Profile outer() const;
  bool is_in_body(MeridianPoint p) const;
  bool is_beyond_outer(MeridianPoint p) const;

  double nose_radius = 12.5e-3, max_radius = 25e-3, shoulder_radius = 1.25e-3, fillet_radius = 2.08e-3,
         sting_radius = 6.25e-3;
  MeridianPoint nose_end, cone_end;              ///< where the neighbors touch
  MeridianPoint shoulder_center, fillet_center;  ///< of the arcs
  MeridianPoint shoulder_end, base_end, fillet_end;
  double inflow_x = -30e-3, outflow_x = 60e-3, outer_radius = 60e-3, rounding_radius = 30e-3;

 private:
  double slope_ = 0;  ///< dr/dx of the cone
};

/// Points along a profile, `n_arc` steps an arc and `n_line` a line; both ends of every step among them, bit for bit.
std::vector<MeridianPoint> sample(const Profile& profile, int n_line, int n_arc);

/// A profile as an entry `[[surface]]` of kind `revolution` about the x axis, numbers with 17 digits.
std::string revolution_toml(const std::string& name, const Profile& profile);
/// A plane as an entry `[[surface]]`; `axis` 0, 1, 2 is the direction of its normal, `at` where it cuts that axis.
std::string plane_toml(const std::string& name, int axis, double at);

}  // namespace pamr::meshing
