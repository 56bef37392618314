// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Parameters of a point of a surface.
struct Uv {
  double u = 0, v = 0;
};

/// A point of a curve with its derivatives.
struct CurveJet {
  Vec3 point, first, second;
};

/// A curve over a parameter. Every call is thread-safe and gives the same bits for the same parameter, whatever was
/// asked before: no span is remembered.
class ParametricCurve {
 public:
  virtual ~ParametricCurve() = default;
  ParametricCurve() = default;
  ParametricCurve(const ParametricCurve&) = delete;
  ParametricCurve& operator=(const ParametricCurve&) = delete;
  ParametricCurve(ParametricCurve&&) = delete;
  ParametricCurve& operator=(ParametricCurve&&) = delete;
  virtual CurveJet at(double t) const = 0;
};

/// A point of a surface with its derivatives.
struct SurfaceJet {
  Vec3 point, u, v, uu, uv, vv;
};

/// A surface over two parameters, without borders; see `ParametricCurve` for what every call keeps.
class ParametricSurface {
 public:
  virtual ~ParametricSurface() = default;
  ParametricSurface() = default;
  ParametricSurface(const ParametricSurface&) = delete;
  ParametricSurface& operator=(const ParametricSurface&) = delete;
  ParametricSurface(ParametricSurface&&) = delete;
  ParametricSurface& operator=(ParametricSurface&&) = delete;
  virtual SurfaceJet at(Uv uv) const = 0;
  virtual Vec3 point(Uv uv) const { return at(uv).point; }
  /// Parameters of the nearest point, where there is a closed form: planes, cylinders, cones, spheres, tori.
  virtual std::optional<Uv> foot(Vec3 /*point*/) const { return std::nullopt; }
};

/// An edge of a CAD shape as it was read.
struct CadEdgeData {
  std::shared_ptr<const ParametricCurve> curve;
  double begin = 0, end = 0;  ///< parameters of its ends
  double tolerance = 0;       ///< how far it may lie off its faces, as the shape says
  std::array<int, 2> vertex{-1, -1};
};

/// An edge around a face. `material_left`: the face lies to the left of the edge's curve, the surface seen from the
/// side to which u x v points.
struct CadBorder {
  int edge = 0;
  bool material_left = true;
};

/// A face of a CAD shape as it was read: a surface, its borders, and triangles that sample it, as seeds.
struct CadFaceData {
  std::string name;   ///< empty where the shape has none
  std::string color;  ///< "#rrggbb", empty where the shape has none
  std::shared_ptr<const ParametricSurface> surface;
  bool is_reversed = false;  ///< the outside of the body is where -(u x v) points
  bool is_plane = false;
  Uv low, high;                   ///< box of the face's parameters
  Uv period;                      ///< 0: none
  std::vector<CadBorder> border;  ///< without seams and poles
  std::vector<Vec3> pole;         ///< points to which a side of the parameters shrinks
  std::vector<Uv> sample;
  std::vector<std::array<int, 3>> triangle;  ///< of samples
};

/// Where a shape comes from: to read it again in another way.
struct CadOrigin {
  std::shared_ptr<const std::string> text;  ///< null where it was not read
  double scale = 1;                         ///< length units in a millimeter
  bool is_assembly = false;                 ///< the text is that of a `CadAssembly`
};

/// A shape: faces in the order of the file, which numbers them from 1.
struct CadData {
  std::vector<CadFaceData> faces;
  std::vector<CadEdgeData> edges;
  std::vector<Vec3> vertices;
  int n_solids = 0;
  std::string unit_of_file;  ///< length unit in which the file is written; empty where it does not say
  CadOrigin origin;
};

}  // namespace pamr::geometry
