// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_assembly.hpp"

#include <fmt/format.h>

#include <BRepAlgoAPI_BuilderAlgo.hxx>
#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/cad/occt_contacts.hpp"
#include "pamr/geometry/cad/occt_solids.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr double min_fuzzy = 1e-6, max_fuzzy = 1e-5;  // of the size of the solids
constexpr double max_change = 1e-3;                   // of the volume of a solid, by the fuse

/// Names of the solids of a file: `called` without the number that tells several of one name apart.
struct SolidNames {
  std::vector<std::string> name, called;
};

SolidNames name_solids(const OcctShape& read, const TopTools_IndexedMapOfShape& solids) {
  std::map<std::string, std::set<const TopoDS_TShape*>> solids_of_part;
  for (int s = 1; s <= solids.Size(); ++s)
    solids_of_part[text_of(read.part_names, solids(s))].insert(solids(s).TShape().get());
  SolidNames result;
  std::map<std::string, int> n_called;
  for (int s = 1; s <= solids.Size(); ++s) {
    const auto part = text_of(read.part_names, solids(s)), own = text_of(read.solid_names, solids(s));
    const bool is_all_of_part = !part.empty() && solids_of_part[part].size() == 1;
    result.called.push_back(is_all_of_part || own.empty() ? part : own);
    ++n_called[result.called.back()];
  }
  std::set<std::string> taken;
  for (const auto& [called, n] : n_called)
    if (n == 1) taken.insert(called);
  std::map<std::string, int> n_numbered;
  for (std::size_t s = 0; s < result.called.size(); ++s) {
    auto& called = result.called[s];
    std::string name = called;
    if (called.empty()) {
      called = "solid";
      name = fmt::format("solid_{}", s + 1);
    } else if (n_called[called] > 1) {
      name = fmt::format("{}_{}", called, ++n_numbered[called]);
    }
    while ((name != called || n_called[called] > 1) && !taken.insert(name).second) name += '_';
    result.name.push_back(std::move(name));
  }
  return result;
}

/// The numbers of the chosen solids, from 0 on, ascending; all where none is chosen.
std::vector<std::size_t> choose(const SolidNames& names, std::span<const std::string> chosen) {
  if (names.name.empty()) throw Error("expected solids, found none: surfaces and shells bound no region");
  for (const auto& wanted : chosen)
    if (std::find(names.name.begin(), names.name.end(), wanted) == names.name.end() &&
        std::find(names.called.begin(), names.called.end(), wanted) == names.called.end())
      throw Error(fmt::format("expected names of solids of the file ({}), found \"{}\"", listed(names.name), wanted));
  std::vector<std::size_t> result;
  for (std::size_t s = 0; s < names.name.size(); ++s)
    if (chosen.empty() || std::find(chosen.begin(), chosen.end(), names.name[s]) != chosen.end() ||
        std::find(chosen.begin(), chosen.end(), names.called[s]) != chosen.end())
      result.push_back(s);
  return result;
}

double volume_of(const TopoDS_Shape& solid) {
  GProp_GProps inside;
  BRepGProp::VolumeProperties(solid, inside);
  return std::abs(inside.Mass());
}

/// The general fuse of some solids, with its history. One solid stays as it is.
class Fuse {
 public:
  Fuse(const std::vector<TopoDS_Shape>& solids, double tolerance) : is_one_(solids.size() == 1) {
    if (is_one_) {
      result_ = solids.front();
      return;
    }
    Bnd_Box box;
    TopTools_ListOfShape arguments;
    for (const auto& solid : solids) {
      BRepBndLib::Add(solid, box);
      arguments.Append(solid);
    }
    const double size = box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
    if (!(size > 0) || !std::isfinite(size)) throw Error(fmt::format("expected solids of finite size, found {}", size));
    tolerance_ = std::clamp(tolerance, min_fuzzy * size, max_fuzzy * size);
    fuse_.SetArguments(arguments);
    fuse_.SetFuzzyValue(tolerance_);
    fuse_.SetNonDestructive(true);
    fuse_.SetRunParallel(false);
    fuse_.Build();
    if (fuse_.HasErrors() || fuse_.Shape().IsNull())
      throw Error(
          "expected solids that OpenCASCADE can fuse, found some on which it fails: unite those that belong together, "
          "or take some with --solid");
    result_ = fuse_.Shape();
  }

  const TopoDS_Shape& result() const { return result_; }
  /// How far apart faces may be that count as one.
  double tolerance() const { return tolerance_; }

  /// The pieces that a solid or a face has become.
  std::vector<TopoDS_Shape> parts_of(const TopoDS_Shape& shape) {
    if (is_one_) return {shape};
    const auto& modified = fuse_.Modified(shape);
    if (!modified.IsEmpty()) return {modified.begin(), modified.end()};
    if (fuse_.IsDeleted(shape)) return {};
    return {shape};
  }

 private:
  bool is_one_;
  double tolerance_ = 0;
  BRepAlgoAPI_BuilderAlgo fuse_;
  TopoDS_Shape result_;
};

class Assembler {
 public:
  Assembler(const OcctShape& read, double scale, std::span<const std::string> chosen) : read_(read), scale_(scale) {
    TopTools_IndexedMapOfShape solids;
    TopExp::MapShapes(read.shape, TopAbs_SOLID, solids);
    const auto names = name_solids(read, solids);
    for (const auto s : choose(names, chosen)) {
      solid_.push_back(solids(static_cast<int>(s) + 1));
      result_.region.push_back(names.name[s]);
    }
    if (chosen.empty()) result_.loose_face = solids_of(read, scale, false).loose_face;
    result_.unit_of_file = read.unit;
  }

  CadAssembly assembly() {
    Fuse fuse(solid_, read_.tolerance);
    find_parts(fuse);
    const auto shape = put_together();
    describe_faces(fuse, shape);
    refuse_touching_edges(shape);
    refuse_tangent_points(shape, fuse.tolerance());
    std::ostringstream text;
    BRepTools::Write(shape, text, false, false, TopTools_FormatVersion_CURRENT);
    result_.text = text.str();
    return std::move(result_);
  }

 private:
  /// The parts that each solid was cut into, and their volumes, which together must be that of the solid.
  void find_parts(Fuse& fuse) {
    TopExp::MapShapes(fuse.result(), TopAbs_SOLID, part_);
    std::vector<double> volume;
    for (int p = 1; p <= part_.Size(); ++p) volume.push_back(volume_of(part_(p)));
    for (std::size_t s = 0; s < solid_.size(); ++s) {
      auto& parts = parts_of_solid_.emplace_back();
      double sum = 0;
      for (const auto& part : fuse.parts_of(solid_[s]))
        if (const int p = part_.FindIndex(part); p > 0 && parts.insert(p).second)
          sum += volume[static_cast<std::size_t>(p) - 1];
      const double whole = volume_of(solid_[s]);
      if (!(std::abs(sum - whole) <= max_change * whole))
        throw Error(fmt::format(
            "expected solids that OpenCASCADE can fuse, found \"{}\" near {} of volume {:.6g}, of "
            "which {:.6g} is left",
            result_.region[s], decimal(middle_of_shape(solid_[s], scale_)), cube(scale_) * whole, cube(scale_) * sum));
    }
  }

  static double cube(double x) { return x * x * x; }

  /// The solid that a part belongs to: of several the one that lies in all others.
  std::size_t owner_of(int part) const {
    std::vector<std::size_t> owners;
    for (std::size_t s = 0; s < solid_.size(); ++s)
      if (parts_of_solid_[s].contains(part)) owners.push_back(s);
    if (owners.empty()) throw Error("expected solids that OpenCASCADE can fuse, found a part that belongs to none");
    std::size_t inner = owners.front();
    for (const auto s : owners)
      if (parts_of_solid_[s].size() < parts_of_solid_[inner].size()) inner = s;
    for (const auto s : owners) {
      const auto& mine = parts_of_solid_[inner];
      const auto& others = parts_of_solid_[s];
      if (s == inner ||
          (mine.size() < others.size() && std::includes(others.begin(), others.end(), mine.begin(), mine.end())))
        continue;
      throw Error(fmt::format(
          "expected solids that are clear of one another, touch, or lie wholly inside of others, found that \"{}\" "
          "and \"{}\" {} at {}: {}",
          result_.region[std::min(inner, s)], result_.region[std::max(inner, s)],
          mine == others ? "are the same solid" : "overlap", decimal(middle_of_shape(part_(part), scale_)),
          mine == others ? "take one out of the file, or name the solids to take (--solid)"
                         : "cut one out of the other, unite them, or name the solids to take (--solid)"));
    }
    return inner;
  }

  /// The parts in the order of their solids, as one shape.
  TopoDS_Compound put_together() {
    std::vector<std::pair<std::size_t, int>> order;
    for (int p = 1; p <= part_.Size(); ++p) order.emplace_back(owner_of(p), p);
    std::sort(order.begin(), order.end());
    BRep_Builder builder;
    TopoDS_Compound shape;
    builder.MakeCompound(shape);
    for (const auto& [owner, p] : order) {
      builder.Add(shape, part_(p));
      result_.region_of_solid.push_back(static_cast<int>(owner));
    }
    return shape;
  }

  void describe_faces(Fuse& fuse, const TopoDS_Compound& shape) {
    TopTools_IndexedMapOfShape faces, of_file, solids;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    TopExp::MapShapes(shape, TopAbs_SOLID, solids);
    result_.face.resize(static_cast<std::size_t>(faces.Size()));
    std::vector<std::vector<int>> regions(result_.face.size());
    for (int s = 1; s <= solids.Size(); ++s)
      for (TopExp_Explorer e(solids(s), TopAbs_FACE); e.More(); e.Next())
        regions[at(faces.FindIndex(e.Current()))].push_back(result_.region_of_solid[at(s)]);
    for (std::size_t f = 0; f < regions.size(); ++f) {
      auto& sides = regions[f];
      std::sort(sides.begin(), sides.end());
      if (sides.empty() || sides.size() > 2 || (sides.size() == 2 && sides[0] == sides[1]))
        throw Error(fmt::format("expected faces that bound one solid or two, found one inside of \"{}\" near {}",
                                result_.region[static_cast<std::size_t>(sides.empty() ? 0 : sides[0])],
                                decimal(middle_of_shape(faces(static_cast<int>(f) + 1), scale_))));
      result_.face[f].region = {sides[0], sides.size() == 2 ? sides[1] : -1};
    }
    TopExp::MapShapes(read_.shape, TopAbs_FACE, of_file);
    for (const auto& solid : solid_)
      for (TopExp_Explorer e(solid, TopAbs_FACE); e.More(); e.Next())
        for (const auto& part : fuse.parts_of(e.Current()))
          if (const int f = faces.FindIndex(part); f > 0 && result_.face[at(f)].number == 0) {
            auto& face = result_.face[at(f)];
            face.number = of_file.FindIndex(e.Current());
            face.name = text_of(read_.names, e.Current());
            face.color = text_of(read_.colors, e.Current());
          }
  }

  /// Along an edge that they have in common, but no face, the boundary of two solids would touch itself.
  void refuse_touching_edges(const TopoDS_Compound& shape) const {
    TopTools_IndexedMapOfShape faces;
    TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
    for (int e = 1; e <= faces_of_edge.Size(); ++e) {
      std::set<int> outer, regions;
      for (const auto& face : faces_of_edge(e))
        if (const int f = faces.FindIndex(face); result_.face[at(f)].region[1] < 0) {
          outer.insert(f);
          regions.insert(result_.face[at(f)].region[0]);
        }
      if (outer.size() <= 2 || regions.size() < 2) continue;
      throw Error(fmt::format(
          "expected solids that have a face in common where they touch, found that \"{}\" and \"{}\" touch along an "
          "edge alone at {}: move one of them, unite them, or name the solids to take (--solid)",
          result_.region[static_cast<std::size_t>(*regions.begin())],
          result_.region[static_cast<std::size_t>(*regions.rbegin())],
          decimal(middle_of_shape(faces_of_edge.FindKey(e), scale_))));
    }
  }

  /// Around a point in which two boundaries touch and are tangent the gap between them is thinner than any edge.
  void refuse_tangent_points(const TopoDS_Compound& shape, double tolerance) const {
    const auto found = find_tangent_point(shape, tolerance);
    if (!found) return;
    const auto region = [&](int solid) {
      return result_.region[static_cast<std::size_t>(result_.region_of_solid[at(solid)])];
    };
    throw Error(fmt::format(
        "expected solids that have a face in common where they touch, found that \"{}\" and \"{}\" are tangent at {} "
        "without one: move one of them, unite them, or name the solids to take (--solid)",
        region(found->solid[0]), region(found->solid[1]),
        decimal(scale_ * Vec3{found->point.X(), found->point.Y(), found->point.Z()})));
  }

  static std::size_t at(int index) { return static_cast<std::size_t>(index) - 1; }  // of maps, which count from 1

  const OcctShape& read_;
  double scale_;
  std::vector<TopoDS_Shape> solid_;
  TopTools_IndexedMapOfShape part_;
  std::vector<std::set<int>> parts_of_solid_;
  CadAssembly result_;
};

}  // namespace

CadAssembly assembly_of(const OcctShape& read, double scale, std::span<const std::string> chosen) {
  return Assembler(read, scale, chosen).assembly();
}

}  // namespace pamr::geometry
