// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_triangles.hpp"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr double max_turn = 0.2;  // radians between normals of neighboring triangles
/// Of a face, as plates with many holes have. OpenCASCADE's usual triangulation of a face with 900 takes a minute and
/// 1.3 GB there, the other one 4 s and 0.1 GB.
constexpr int many_edges = 300;

int max_edges_of_face(const TopoDS_Shape& shape) {
  int most = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    int n = 0;
    for (TopExp_Explorer edge(face.Current(), TopAbs_EDGE); edge.More(); edge.Next()) ++n;
    most = std::max(most, n);
  }
  return most;
}

class Weld {
 public:
  Weld(const TopoDS_Shape& shape, double scale) : scale_(scale) {
    TopExp::MapShapes(shape, TopAbs_FACE, faces_);
    TopExp::MapShapes(shape, TopAbs_VERTEX, vertices_);
    for (int v = 1; v <= vertices_.Size(); ++v) {
      (void)add_point(BRep_Tool::Pnt(TopoDS::Vertex(vertices_(v))));
    }
  }

  CadTriangles triangles() {
    for (int f = 1; f <= faces_.Size(); ++f) add_face(TopoDS::Face(faces_(f)), f);
    CadTriangles result;
    std::vector<int> number(point_.size(), -1);
    for (std::size_t t = 0; t < corner_.size(); ++t) {
      std::array<int, 3> corner{};
      for (std::size_t k = 0; k < 3; ++k) corner[k] = root(corner_[t][k]);
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;  // at a pole
      for (auto& c : corner) {
        auto& n = number[static_cast<std::size_t>(c)];
        if (n < 0) {
          n = static_cast<int>(result.point.size());
          result.point.push_back(point_[static_cast<std::size_t>(c)]);
        }
        c = n;
      }
      result.corner.push_back(corner);
      result.face.push_back(face_[t]);
    }
    return result;
  }

 private:
  int add_point(const gp_Pnt& p) {
    point_.push_back({scale_ * p.X(), scale_ * p.Y(), scale_ * p.Z()});
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  int root(int i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      auto& up = parent_[static_cast<std::size_t>(i)];
      up = parent_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  /// The point with the smaller number stays: vertices come first.
  void unite(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

  void add_face(const TopoDS_Face& oriented, int f) {
    const auto face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
    TopLoc_Location location;
    const auto triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || triangulation->NbTriangles() == 0)
      throw Error(fmt::format("face {}: expected a face that can be triangulated, found a damaged one", f));
    const int first = static_cast<int>(point_.size());
    for (int i = 1; i <= triangulation->NbNodes(); ++i)
      (void)add_point(triangulation->Node(i).Transformed(location.Transformation()));
    const bool is_reversed = oriented.Orientation() == TopAbs_REVERSED;
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      std::array<int, 3> t{};
      triangulation->Triangle(i).Get(t[0], t[1], t[2]);
      if (is_reversed) std::swap(t[1], t[2]);
      for (auto& c : t) c += first - 1;
      corner_.push_back(t);
      face_.push_back(f - 1);
    }
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
      add_edge(TopoDS::Edge(e.Current()), triangulation, location, first);
  }

  void add_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                const TopLoc_Location& location, int first) {
    const auto polygon = BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    if (polygon.IsNull()) return;
    const int n = polygon->NbNodes();
    const auto node = [&](int i) { return first + polygon->Node(i) - 1; };
    TopoDS_Vertex begin, end;
    TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), begin, end);
    if (!begin.IsNull()) unite(node(1), vertices_.FindIndex(begin) - 1);
    if (!end.IsNull()) unite(node(n), vertices_.FindIndex(end) - 1);
    if (BRep_Tool::Degenerated(edge)) {
      for (int i = 2; i < n; ++i) unite(node(1), node(i));
      return;
    }
    const int number = edges_.Add(edge);
    const auto [known, is_new] = polygon_.try_emplace(number);
    if (is_new)
      for (int i = 1; i <= n; ++i) known->second.push_back(node(i));
    if (std::ssize(known->second) != n) return;  // stays open there: it is found to be
    for (int i = 1; i <= n; ++i) unite(known->second[static_cast<std::size_t>(i - 1)], node(i));
  }

  double scale_;
  TopTools_IndexedMapOfShape faces_, vertices_, edges_;
  std::vector<Vec3> point_;
  std::vector<int> parent_;
  std::vector<std::array<int, 3>> corner_;
  std::vector<int> face_;
  std::map<int, std::vector<int>> polygon_;  // of the edges met so far
};

}  // namespace

void triangulate(const TopoDS_Shape& shape, double deflection) {
  BRepLib::BuildCurves3d(shape);
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  if (box.IsVoid()) throw Error("expected a shape with faces, found none");
  double x0 = 0, y0 = 0, z0 = 0, x1 = 0, y1 = 0, z1 = 0;
  box.Get(x0, y0, z0, x1, y1, z1);
  const double size = norm(Vec3{x1 - x0, y1 - y0, z1 - z0});
  if (!(size > 0 && size < max_coordinate)) throw Error(fmt::format("expected a shape of finite size, found {}", size));
  BRepTools::Clean(shape);
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection * size;
  parameters.Angle = max_turn;
  if (max_edges_of_face(shape) > many_edges) parameters.MeshAlgo = IMeshTools_MeshAlgoType_Delabella;
  BRepMesh_IncrementalMesh(shape, parameters);
}

CadTriangles welded_triangles(const TopoDS_Shape& shape, double scale) { return Weld(shape, scale).triangles(); }

}  // namespace pamr::geometry
