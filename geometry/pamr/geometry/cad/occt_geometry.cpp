// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_geometry.hpp"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_Curve.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <cmath>
#include <numbers>
#include <utility>

namespace pamr::geometry {

namespace {

class OcctParametricCurve final : public ParametricCurve {
 public:
  OcctParametricCurve(Handle(Geom_Curve) curve, double scale) : curve_(std::move(curve)), scale_(scale) {}
  CurveJet at(double t) const override {
    gp_Pnt p;
    gp_Vec first, second;
    curve_->D2(t, p, first, second);
    const auto scaled = [this](const auto& v) { return Vec3{scale_ * v.X(), scale_ * v.Y(), scale_ * v.Z()}; };
    return {scaled(p), scaled(first), scaled(second)};
  }

 private:
  Handle(Geom_Curve) curve_;
  double scale_;
};

class OcctParametricSurface : public ParametricSurface {
 public:
  OcctParametricSurface(Handle(Geom_Surface) surface, double scale) : surface_(std::move(surface)), scale_(scale) {}
  SurfaceJet at(Uv uv) const override {
    gp_Pnt p;
    gp_Vec u, v, uu, vv, mixed;
    surface_->D2(uv.u, uv.v, p, u, v, uu, vv, mixed);
    return {scaled(p), scaled(u), scaled(v), scaled(uu), scaled(mixed), scaled(vv)};
  }
  Vec3 point(Uv uv) const override {
    gp_Pnt p;
    surface_->D0(uv.u, uv.v, p);
    return scaled(p);
  }

 protected:
  gp_Pnt unscaled(Vec3 p) const { return {p.x / scale_, p.y / scale_, p.z / scale_}; }

 private:
  template <class Triple>
  Vec3 scaled(const Triple& v) const {
    return {scale_ * v.X(), scale_ * v.Y(), scale_ * v.Z()};
  }
  Handle(Geom_Surface) surface_;
  double scale_;
};

/// A plane, cylinder, cone, sphere or torus.
template <class Shape>
class OcctQuadric final : public OcctParametricSurface {
 public:
  OcctQuadric(const Handle(Geom_Surface) & surface, const Shape& shape, double scale)
      : OcctParametricSurface(surface, scale), shape_(shape) {}
  std::optional<Uv> foot(Vec3 point) const override {
    Uv uv;
    ElSLib::Parameters(shape_, unscaled(point), uv.u, uv.v);
    return uv;
  }

 private:
  Shape shape_;
};

/// One nappe of a cone: OpenCASCADE's own closed form takes the other one for points beside and above the apex.
class OcctCone final : public OcctParametricSurface {
 public:
  OcctCone(const Handle(Geom_Surface) & surface, const gp_Cone& cone, double some_v, double scale)
      : OcctParametricSurface(surface, scale),
        cone_(cone),
        side_(cone.RefRadius() + some_v * std::sin(cone.SemiAngle()) < 0 ? -1 : 1) {}
  std::optional<Uv> foot(Vec3 point) const override {
    const gp_Ax3& frame = cone_.Position();
    const gp_Vec p(frame.Location(), unscaled(point));
    const double x = p.Dot(frame.XDirection()), y = p.Dot(frame.YDirection()), z = p.Dot(frame.Direction());
    const double angle = cone_.SemiAngle(), radial = side_ * std::hypot(x, y);
    double u = std::atan2(side_ * y, side_ * x);
    if (u < 0) u += 2 * std::numbers::pi;
    return Uv{u, (radial - cone_.RefRadius()) * std::sin(angle) + z * std::cos(angle)};
  }

 private:
  gp_Cone cone_;
  double side_;
};

Handle(Geom_Surface) untrimmed_surface(const TopoDS_Face& face) {
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  while (!surface.IsNull() && surface->IsKind(STANDARD_TYPE(Geom_RectangularTrimmedSurface)))
    surface = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface)->BasisSurface();
  return surface;
}

template <class Shape>
std::shared_ptr<const ParametricSurface> quadric(const Handle(Geom_Surface) & surface, const Shape& shape,
                                                 double scale) {
  return std::make_shared<OcctQuadric<Shape>>(surface, shape, scale);
}

}  // namespace

bool is_occt_plane(const TopoDS_Face& face) { return untrimmed_surface(face)->IsKind(STANDARD_TYPE(Geom_Plane)); }

std::shared_ptr<const ParametricSurface> occt_surface(const TopoDS_Face& face, double scale) {
  const auto surface = untrimmed_surface(face);
  if (surface.IsNull()) return nullptr;
  if (const auto plane = Handle(Geom_Plane)::DownCast(surface); !plane.IsNull())
    return quadric(surface, plane->Pln(), scale);
  if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(surface); !cylinder.IsNull())
    return quadric(surface, cylinder->Cylinder(), scale);
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull()) {
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    return std::make_shared<OcctCone>(surface, cone->Cone(), 0.5 * (v0 + v1), scale);
  }
  if (const auto sphere = Handle(Geom_SphericalSurface)::DownCast(surface); !sphere.IsNull())
    return quadric(surface, sphere->Sphere(), scale);
  if (const auto torus = Handle(Geom_ToroidalSurface)::DownCast(surface);
      !torus.IsNull() && torus->MajorRadius() > torus->MinorRadius())
    return quadric(surface, torus->Torus(), scale);
  return std::make_shared<OcctParametricSurface>(surface, scale);
}

OcctCurve occt_curve(const TopoDS_Edge& edge, double scale) {
  OcctCurve result;
  Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, result.begin, result.end);
  if (curve.IsNull()) return result;
  while (curve->IsKind(STANDARD_TYPE(Geom_TrimmedCurve)))
    curve = Handle(Geom_TrimmedCurve)::DownCast(curve)->BasisCurve();
  result.curve = std::make_shared<OcctParametricCurve>(curve, scale);
  return result;
}

}  // namespace pamr::geometry
