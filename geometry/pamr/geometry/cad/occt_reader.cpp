// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_reader.hpp"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/geometry/cad/occt_assembly.hpp"
#include "pamr/geometry/cad/occt_geometry.hpp"
#include "pamr/geometry/cad/occt_shape.hpp"
#include "pamr/geometry/cad/occt_solids.hpp"
#include "pamr/geometry/cad/occt_triangles.hpp"

namespace pamr::geometry {

namespace {

constexpr double sample_deflection = 1e-3;  // of the size: how far the triangles may lie off the faces
constexpr double integration_error = 1e-8;
constexpr double allowed_gap = 1e-5;  // of the size, beside the tolerance that an edge states

/// Turns a shape into what does not need OpenCASCADE's topology.
class Converter {
 public:
  Converter(const OcctShape& read, double scale) : scale_(scale), checks_edges_(read.is_as_written) {
    const auto& shape = read.shape;
    TopExp::MapShapes(shape, TopAbs_FACE, faces_);
    TopExp::MapShapes(shape, TopAbs_EDGE, edges_);
    TopExp::MapShapes(shape, TopAbs_VERTEX, vertices_);
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    if (!box.IsVoid()) size_ = std::sqrt(box.SquareExtent());
  }

  CadData data() {
    CadData result;
    for (int v = 1; v <= vertices_.Size(); ++v)
      result.vertices.push_back(scaled(BRep_Tool::Pnt(TopoDS::Vertex(vertices_(v)))));
    number_.assign(static_cast<std::size_t>(edges_.Size()) + 1, -1);
    for (int e = 1; e <= edges_.Size(); ++e) add_edge(TopoDS::Edge(edges_(e)), e, result);
    for (int f = 1; f <= faces_.Size(); ++f) result.faces.push_back(face(TopoDS::Face(faces_(f)), f));
    return result;
  }
  const TopTools_IndexedMapOfShape& faces() const { return faces_; }

 private:
  Vec3 scaled(const gp_Pnt& p) const { return {scale_ * p.X(), scale_ * p.Y(), scale_ * p.Z()}; }

  void add_edge(const TopoDS_Edge& edge, int e, CadData& result) {
    if (BRep_Tool::Degenerated(edge)) return;
    const auto curve = occt_curve(edge, scale_);
    if (!curve.curve || !(curve.begin < curve.end)) return;
    TopoDS_Vertex first, last;
    TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), first, last);
    const auto number = [this](const TopoDS_Vertex& v) { return v.IsNull() ? -1 : vertices_.FindIndex(v) - 1; };
    number_[static_cast<std::size_t>(e)] = static_cast<int>(result.edges.size());
    result.edges.push_back(
        {curve.curve, curve.begin, curve.end, scale_ * BRep_Tool::Tolerance(edge), {number(first), number(last)}});
  }

  CadFaceData face(const TopoDS_Face& oriented, int number) {
    const auto face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
    CadFaceData result;
    result.surface = occt_surface(face, scale_);
    if (!result.surface) throw Error(fmt::format("face {}: expected a surface, found none", number));
    result.is_reversed = oriented.Orientation() == TopAbs_REVERSED;
    result.is_plane = is_occt_plane(face);
    BRepTools::UVBounds(face, result.low.u, result.high.u, result.low.v, result.high.v);
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    if (surface->IsUPeriodic()) result.period.u = surface->UPeriod();
    if (surface->IsVPeriodic()) result.period.v = surface->VPeriod();
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
      const auto edge = TopoDS::Edge(e.Current());
      if (checks_edges_) require_on_face(face, edge, number);
      add_border(face, edge, result);
    }
    add_samples(face, number, result);
    return result;
  }

  /// An edge is there twice, as a curve in space and as one in the parameters of the face: both must agree. What bounds
  /// a face for us is the first, for OpenCASCADE's triangles the second.
  void require_on_face(const TopoDS_Face& face, const TopoDS_Edge& edge, int number) const {
    if (BRep_Tool::Degenerated(edge) || !BRep_Tool::SameParameter(edge)) return;
    double begin = 0, end = 0, flat_begin = 0, flat_end = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, begin, end);
    const Handle(Geom2d_Curve) flat = BRep_Tool::CurveOnSurface(edge, face, flat_begin, flat_end);
    if (curve.IsNull() || flat.IsNull()) return;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    const double allowed = 2 * BRep_Tool::Tolerance(edge) + allowed_gap * size_;
    constexpr int n = 16;
    for (int i = 0; i <= n; ++i) {
      const double part = static_cast<double>(i) / n;
      const auto uv = flat->Value(flat_begin + part * (flat_end - flat_begin));
      const double gap = curve->Value(begin + part * (end - begin)).Distance(surface->Value(uv.X(), uv.Y()));
      if (!(gap <= allowed))
        throw Error(fmt::format("face {}: expected edges on the face, found one that is {:.3g} of the size off it",
                                number, gap / size_));
    }
  }

  void add_border(const TopoDS_Face& face, const TopoDS_Edge& edge, CadFaceData& result) {
    if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) return;
    if (BRep_Tool::Degenerated(edge)) {
      result.pole.push_back(scaled(BRep_Tool::Pnt(TopExp::FirstVertex(edge))));
      return;
    }
    const int number = number_[static_cast<std::size_t>(edges_.FindIndex(edge))];
    if (number < 0 || BRep_Tool::IsClosed(edge, face)) return;
    result.border.push_back({number, edge.Orientation() == TopAbs_FORWARD});
  }

  static void add_samples(const TopoDS_Face& face, int number, CadFaceData& result) {
    TopLoc_Location location;
    const auto triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || !triangulation->HasUVNodes() || triangulation->NbTriangles() == 0)
      throw Error(fmt::format(
          "face {}: expected a face that can be sampled, found one that OpenCASCADE makes no triangles of", number));
    for (int i = 1; i <= triangulation->NbNodes(); ++i) {
      const auto uv = triangulation->UVNode(i);
      result.sample.push_back({uv.X(), uv.Y()});
    }
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      std::array<int, 3> t{};
      triangulation->Triangle(i).Get(t[0], t[1], t[2]);
      for (auto& corner : t) --corner;
      result.triangle.push_back(t);
    }
  }

  double scale_, size_ = 0;
  bool checks_edges_;
  TopTools_IndexedMapOfShape faces_, edges_, vertices_;
  std::vector<int> number_;  // of edges, by their place in the map; -1: a pole
};

CadData convert(std::string_view text, double scale) {
  auto read = read_occt_shape(text);
  triangulate(read.shape, sample_deflection);
  Converter converter(read, scale);
  auto data = converter.data();
  for (int f = 1; f <= converter.faces().Size(); ++f) {
    auto& face = data.faces[static_cast<std::size_t>(f - 1)];
    face.name = text_of(read.names, converter.faces()(f));
    face.color = text_of(read.colors, converter.faces()(f));
  }
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(read.shape, TopAbs_SOLID, solids);
  data.n_solids = solids.Size();
  data.unit_of_file = std::move(read.unit);
  return data;
}

/// OpenCASCADE's readers share parameters: one at a time, and its exceptions become ours.
template <class Work>
auto with_occt(Work&& work) {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  try {
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
    return work();
  } catch (const Standard_Failure& failure) {
    throw Error(std::string("expected a sound shape, found one on which OpenCASCADE fails: ") +
                one_line(failure.GetMessageString()));
  }
}

CadData read(std::string_view text, double scale) {
  return with_occt([&] { return convert(text, scale); });
}

CadTriangles triangulated(std::string_view text, double scale, double deflection, bool is_assembly) {
  return with_occt([&] {
    const auto read = read_occt_shape(text);
    auto solids = solids_of(read, scale, !is_assembly);
    if (!solids.contact.empty())
      return CadTriangles{.point = {}, .corner = {}, .face = {}, .solids = std::move(solids)};
    triangulate(read.shape, deflection);
    auto result = welded_triangles(read.shape, scale);
    result.solids = std::move(solids);
    return result;
  });
}

CadAssembly assembled(std::string_view text, double scale, std::span<const std::string> chosen) {
  return with_occt([&] { return assembly_of(read_occt_shape(text), scale, chosen); });
}

CadMeasures measured(std::string_view text, double scale) {
  return with_occt([&] {
    const auto shape = read_occt_shape(text).shape;
    CadMeasures result;
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (int f = 1; f <= faces.Size(); ++f) {
      GProp_GProps face;
      BRepGProp::SurfaceProperties(faces(f), face, integration_error);
      result.area.push_back(scale * scale * face.Mass());
    }
    GProp_GProps body;
    BRepGProp::VolumeProperties(shape, body, integration_error);
    result.volume = scale * scale * scale * body.Mass();
    return result;
  });
}

constexpr CadReader by_occt{read, triangulated, assembled, measured};

}  // namespace

}  // namespace pamr::geometry

const pamr::geometry::CadReader* pamr_cad_reader() { return &pamr::geometry::by_occt; }
