// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_solids.hpp"

#include <BRepBndLib.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>

namespace pamr::geometry {

namespace {

constexpr double clearance = 1e-6;  // of the size: solids nearer to each other than that touch
constexpr std::size_t max_contacts = 3;

/// Middle of a shape's box.
gp_Pnt middle_of(const Bnd_Box& box) {
  double x0 = 0, y0 = 0, z0 = 0, x1 = 0, y1 = 0, z1 = 0;
  if (!box.IsVoid()) box.Get(x0, y0, z0, x1, y1, z1);
  return {0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1)};
}

Bnd_Box box_of_shape(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  return box;
}

/// The border of a solid.
TopoDS_Compound border_of(const TopoDS_Shape& solid) {
  BRep_Builder builder;
  TopoDS_Compound shells;
  builder.MakeCompound(shells);
  for (TopExp_Explorer e(solid, TopAbs_SHELL); e.More(); e.Next()) builder.Add(shells, e.Current());
  return shells;
}

class Contacts {
 public:
  Contacts(const TopTools_IndexedMapOfShape& solids, double scale) : solids_(solids), scale_(scale) {
    Bnd_Box all;
    for (int s = 1; s <= solids.Size(); ++s) {
      box_.push_back(box_of_shape(solids(s)));
      all.Add(box_.back());
    }
    touching_ = all.IsVoid() ? 0 : clearance * std::sqrt(all.SquareExtent());
    for (auto& box : box_) box.Enlarge(touching_);
  }

  std::vector<CadContact> find() const {
    std::vector<CadContact> found;
    for (int a = 1; a <= solids_.Size(); ++a)
      for (int b = a + 1; b <= solids_.Size() && found.size() < max_contacts; ++b)
        if (!box_[index(a)].IsOut(box_[index(b)])) look_at(a, b, found);
    return found;
  }

 private:
  static std::size_t index(int solid) { return static_cast<std::size_t>(solid) - 1; }
  Vec3 scaled(const gp_Pnt& p) const { return {scale_ * p.X(), scale_ * p.Y(), scale_ * p.Z()}; }

  void look_at(int a, int b, std::vector<CadContact>& found) const {
    const BRepExtrema_DistShapeShape distance(solids_(a), solids_(b), Extrema_ExtFlag_MIN);
    if (!distance.IsDone() || distance.Value() > touching_) return;
    const BRepExtrema_DistShapeShape borders(border_of(solids_(a)), border_of(solids_(b)), Extrema_ExtFlag_MIN);
    if (borders.IsDone() && borders.NbSolution() > 0 && borders.Value() <= touching_) {
      found.push_back({a, b, false, scaled(borders.PointOnShape1(1))});
      return;
    }
    const bool a_is_larger = box_[index(a)].SquareExtent() > box_[index(b)].SquareExtent();
    const int outer = a_is_larger ? a : b, inner = a_is_larger ? b : a;
    found.push_back({inner, outer, true, scaled(middle_of(box_[index(inner)]))});
  }

  const TopTools_IndexedMapOfShape& solids_;
  double scale_, touching_ = 0;
  std::vector<Bnd_Box> box_;
};

}  // namespace

Vec3 middle_of_shape(const TopoDS_Shape& shape, double scale) {
  const auto p = middle_of(box_of_shape(shape));
  return {scale * p.X(), scale * p.Y(), scale * p.Z()};
}

CadSolids solids_of(const OcctShape& read, double scale, bool with_contacts) {
  CadSolids result;
  TopTools_IndexedMapOfShape solids, faces, of_solids;
  TopExp::MapShapes(read.shape, TopAbs_SOLID, solids);
  TopExp::MapShapes(read.shape, TopAbs_FACE, faces);
  for (int s = 1; s <= solids.Size(); ++s) {
    TopExp::MapShapes(solids(s), TopAbs_FACE, of_solids);
    auto& solid = result.solid.emplace_back();
    solid.name = text_of(read.solid_names, solids(s));
    solid.middle = middle_of_shape(solids(s), scale);
    for (TopExp_Explorer e(solids(s), TopAbs_FACE); e.More(); e.Next()) {
      const int f = faces.FindIndex(e.Current());
      solid.sides.push_back({f - 1, e.Current().Orientation() != faces(f).Orientation()});
    }
    GProp_GProps inside;
    BRepGProp::VolumeProperties(solids(s), inside);
    solid.volume = scale * scale * scale * std::abs(inside.Mass());
    result.volume += solid.volume;
  }
  for (int f = 1; f <= faces.Size(); ++f)
    if (!of_solids.Contains(faces(f))) result.loose_face.push_back({f - 1, middle_of_shape(faces(f), scale)});
  if (with_contacts && solids.Size() > 1) result.contact = Contacts(solids, scale).find();
  return result;
}

}  // namespace pamr::geometry
