// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_contacts.hpp"

#include <BRepBndLib.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <GeomLProp_SLProps.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Dir.hxx>
#include <gp_Vec.hxx>
#include <iterator>
#include <set>
#include <vector>

#include "pamr/base/error.hpp"

namespace pamr::geometry {

namespace {

constexpr double sine_of_5_degrees = 0.08715574274765817, cosine_of_5_degrees = 0.9961946980917455;

/// Whether a vector of surfaces or curves has no length, beside another one.
bool is_null(const gp_Vec& v, const gp_Vec& other) { return v.Magnitude() <= 1e-9 * other.Magnitude(); }

/// The directions out of a face at a point of it: many where one parameter is free there, as at the tip of a cone and
/// at the pole of a ball.
std::vector<gp_Dir> normals_at(const gp_Pnt& point, const TopoDS_Face& face) {
  constexpr int n_around = 8;
  const auto surface = BRep_Tool::Surface(face);
  const GeomAPI_ProjectPointOnSurf foot(point, surface);
  if (foot.NbPoints() == 0) return {};
  double u = 0, v = 0, low[2], high[2];
  foot.LowerDistanceParameters(u, v);
  gp_Pnt at;
  gp_Vec along_u, along_v;
  surface->D1(u, v, at, along_u, along_v);
  BRepTools::UVBounds(face, low[0], high[0], low[1], high[1]);
  const bool is_u_free = is_null(along_u, along_v), is_v_free = is_null(along_v, along_u);
  std::vector<gp_Dir> normals;
  for (int i = 0; i < (is_u_free || is_v_free ? n_around : 1); ++i) {
    const double part = (i + 0.5) / n_around;
    GeomLProp_SLProps properties(surface, is_u_free ? low[0] + part * (high[0] - low[0]) : u,
                                 is_v_free ? low[1] + part * (high[1] - low[1]) : v, 2, Precision::Confusion());
    if (!properties.IsNormalDefined()) return {};
    normals.push_back(face.Orientation() == TopAbs_REVERSED ? properties.Normal().Reversed() : properties.Normal());
  }
  return normals;
}

/// The directions in which an edge leaves a point of it: one at its end, else two.
std::vector<gp_Dir> rays_at(const gp_Pnt& point, const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  if (BRep_Tool::Degenerated(edge)) return {};
  const auto curve = BRep_Tool::Curve(edge, first, last);
  if (curve.IsNull()) return {};
  const double tolerance = BRep_Tool::Tolerance(edge) + Precision::Confusion();
  std::vector<gp_Dir> rays;
  const auto add = [&](double at, double sense) {
    gp_Pnt here;
    gp_Vec along;
    curve->D1(at, here, along);
    if (along.Magnitude() > Precision::Confusion()) rays.emplace_back(sense * along);
  };
  const bool starts = curve->Value(first).Distance(point) <= tolerance;
  const bool ends = curve->Value(last).Distance(point) <= tolerance;
  if (starts) add(first, 1);
  if (ends) add(last, -1);
  if (starts || ends) return rays;
  const GeomAPI_ProjectPointOnCurve foot(point, curve, first, last);
  if (foot.NbPoints() == 0) return {};
  add(foot.LowerDistanceParameter(), 1);
  add(foot.LowerDistanceParameter(), -1);
  return rays;
}

/// Directions at a point of the boundary of a solid.
struct Directions {
  std::vector<gp_Dir> normals;
  std::vector<gp_Dir> rays;
  bool is_smooth = false;  ///< all normals within 5 degrees
};

/// The faces and edges of a solid around points of its boundary.
class Boundary {
 public:
  explicit Boundary(const TopoDS_Shape& solid) {
    TopExp::MapShapes(solid, TopAbs_VERTEX, vertices);
    TopExp::MapShapesAndUniqueAncestors(solid, TopAbs_EDGE, TopAbs_FACE, faces_of_edge_);
    TopExp::MapShapesAndUniqueAncestors(solid, TopAbs_VERTEX, TopAbs_FACE, faces_of_vertex_);
    TopExp::MapShapesAndUniqueAncestors(solid, TopAbs_VERTEX, TopAbs_EDGE, edges_of_vertex_);
  }
  TopTools_IndexedMapOfShape vertices;

  /// Whether an edge at a vertex belongs to both boundaries, as where solids meet around it.
  bool have_an_edge_in_common(const TopoDS_Shape& vertex, const Boundary& other) const {
    const auto& edges = edges_of_vertex_.FindFromKey(vertex);
    return std::any_of(edges.begin(), edges.end(),
                       [&](const TopoDS_Shape& edge) { return other.faces_of_edge_.Contains(edge); });
  }

  /// `support`: the face, edge or vertex on which the point lies.
  Directions at(const gp_Pnt& point, const TopoDS_Shape& support) const {
    TopTools_ListOfShape faces, edges;
    if (support.ShapeType() == TopAbs_FACE) {
      faces.Append(support);
    } else if (support.ShapeType() == TopAbs_EDGE) {
      if (faces_of_edge_.Contains(support)) faces = faces_of_edge_.FindFromKey(support);
      edges.Append(support);
    } else if (faces_of_vertex_.Contains(support)) {
      faces = faces_of_vertex_.FindFromKey(support);
      edges = edges_of_vertex_.FindFromKey(support);
    }
    Directions result;
    result.is_smooth = !faces.IsEmpty();
    for (const auto& face : faces) {
      const auto normals = normals_at(point, TopoDS::Face(face));
      result.is_smooth = result.is_smooth && !normals.empty();
      result.normals.insert(result.normals.end(), normals.begin(), normals.end());
    }
    for (const auto& edge : edges) {
      const auto rays = rays_at(point, TopoDS::Edge(edge));
      result.rays.insert(result.rays.end(), rays.begin(), rays.end());
    }
    for (const auto& normal : result.normals)
      result.is_smooth = result.is_smooth && normal.Dot(result.normals.front()) > cosine_of_5_degrees;
    return result;
  }

 private:
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge_, faces_of_vertex_, edges_of_vertex_;
};

/// Whether a face or an edge of `other` is tangent to the boundary of `smooth`, which is smooth there.
bool lies_along(const Directions& smooth, const Directions& other) {
  if (!smooth.is_smooth) return false;
  const auto& normal = smooth.normals.front();
  return std::any_of(other.normals.begin(), other.normals.end(),
                     [&](const gp_Dir& n) { return std::abs(n.Dot(normal)) > cosine_of_5_degrees; }) ||
         std::any_of(other.rays.begin(), other.rays.end(),
                     [&](const gp_Dir& ray) { return std::abs(ray.Dot(normal)) < sine_of_5_degrees; });
}

bool are_tangent(const Directions& a, const Directions& b) {
  if (lies_along(a, b) || lies_along(b, a)) return true;
  for (const auto& of_a : a.rays)
    for (const auto& of_b : b.rays)
      if (of_a.Dot(of_b) > cosine_of_5_degrees) return true;
  return false;
}

/// A face of fused solids.
struct Face {
  TopoDS_Face shape;
  std::vector<int> solids;  ///< one or two, ascending
  Bnd_Box box;
  TopTools_IndexedMapOfShape vertices;  ///< of its edges, without those that the fuse put inside
};

class Search {
 public:
  Search(const TopoDS_Shape& shape, double tolerance) : tolerance_(tolerance) {
    TopTools_IndexedMapOfShape solids, faces;
    TopExp::MapShapes(shape, TopAbs_SOLID, solids);
    for (int s = 1; s <= solids.Size(); ++s) {
      boundary_.emplace_back(solids(s));
      for (TopExp_Explorer e(solids(s), TopAbs_FACE); e.More(); e.Next()) {
        const int f = faces.Add(e.Current());
        if (f > std::ssize(face_)) {
          auto& face = face_.emplace_back();
          face.shape = TopoDS::Face(e.Current());
          BRepBndLib::Add(face.shape, face.box);
          face.box.Enlarge(tolerance);
          for (TopExp_Explorer edge(face.shape, TopAbs_EDGE); edge.More(); edge.Next())
            TopExp::MapShapes(edge.Current(), TopAbs_VERTEX, face.vertices);
        }
        face_[static_cast<std::size_t>(f) - 1].solids.push_back(s);
      }
    }
    for (const auto& face : face_)
      if (face.solids.size() > 1) joined_.insert({face.solids[0], face.solids[1]});
  }

  std::optional<TangentPoint> find() const {
    for (std::size_t f = 0; f < face_.size(); ++f)
      for (std::size_t g = f + 1; g < face_.size(); ++g)
        if (may_touch(face_[f], face_[g]))
          if (auto found = between(face_[f], face_[g])) return found;
    for (int a = 1; a <= std::ssize(boundary_); ++a)
      for (int b = a + 1; b <= std::ssize(boundary_); ++b)
        if (!joined_.contains({a, b}))
          if (auto found = at_vertices(a, b)) return found;
    return std::nullopt;
  }

 private:
  const Boundary& boundary(int solid) const { return boundary_[static_cast<std::size_t>(solid) - 1]; }

  static bool may_touch(const Face& f, const Face& g) {
    if (f.solids == g.solids || f.box.IsOut(g.box)) return false;
    for (int v = 1; v <= f.vertices.Size(); ++v)
      if (g.vertices.Contains(f.vertices(v))) return false;
    return true;
  }

  std::optional<TangentPoint> between(const Face& f, const Face& g) const {
    const BRepExtrema_DistShapeShape distance(f.shape, g.shape);
    if (!distance.IsDone()) throw Error("expected faces whose distance OpenCASCADE finds, found two where it fails");
    if (distance.Value() > tolerance_) return std::nullopt;
    for (int i = 1; i <= distance.NbSolution(); ++i)
      for (const int a : f.solids)
        for (const int b : g.solids)
          if (are_tangent(boundary(a).at(distance.PointOnShape1(i), distance.SupportOnShape1(i)),
                          boundary(b).at(distance.PointOnShape2(i), distance.SupportOnShape2(i))))
            return TangentPoint{
                {std::min(f.solids.back(), g.solids.back()), std::max(f.solids.back(), g.solids.back())},
                distance.PointOnShape1(i)};
    return std::nullopt;
  }

  /// At the vertices that two solids without a common face have in common.
  std::optional<TangentPoint> at_vertices(int a, int b) const {
    for (int v = 1; v <= boundary(a).vertices.Size(); ++v) {
      const auto& vertex = boundary(a).vertices(v);
      if (!boundary(b).vertices.Contains(vertex) || boundary(a).have_an_edge_in_common(vertex, boundary(b))) continue;
      const auto point = BRep_Tool::Pnt(TopoDS::Vertex(vertex));
      if (are_tangent(boundary(a).at(point, vertex), boundary(b).at(point, vertex))) return TangentPoint{{a, b}, point};
    }
    return std::nullopt;
  }

  double tolerance_;
  std::vector<Boundary> boundary_;
  std::vector<Face> face_;
  std::set<std::array<int, 2>> joined_;
};

}  // namespace

std::optional<TangentPoint> find_tangent_point(const TopoDS_Shape& solids, double tolerance) {
  return Search(solids, tolerance).find();
}

}  // namespace pamr::geometry
