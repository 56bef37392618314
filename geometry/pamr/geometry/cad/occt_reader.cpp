// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_reader.hpp"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <mutex>
#include <sstream>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/geometry/cad/occt_geometry.hpp"

namespace pamr::geometry {

namespace {

constexpr double sample_deflection = 1e-3;  // of the size: how far the triangles may lie off the faces
constexpr double integration_error = 1e-8;
constexpr double sample_angle = 0.2;  // radians between neighbors

/// What a text contains.
struct ReadShape {
  TopoDS_Shape shape;
  std::string unit;
  std::vector<std::pair<TopoDS_Shape, std::string>> names;
};

std::string first_of(const Interface_CheckIterator& checks) {
  for (checks.Start(); checks.More(); checks.Next())
    if (const auto& check = checks.Value(); check->HasFailed() && check->NbFails() > 0)
      return one_line(check->CFail(1));
  return {};
}

void read_face_names(STEPControl_Reader& reader, ReadShape& result) {
  const auto transfer = reader.WS()->TransferReader();
  for (TopExp_Explorer e(result.shape, TopAbs_FACE); e.More(); e.Next()) {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(e.Current(), 1));
    if (item.IsNull() || item->Name().IsNull()) continue;
    std::string name = item->Name()->ToCString();
    if (!name.empty() && name != "NONE") result.names.emplace_back(e.Current(), std::move(name));
  }
}

int count_face_entities(const STEPControl_Reader& reader) {
  const auto model = reader.WS()->Model();
  int n = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) n += model->Value(i)->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
  return n;
}

ReadShape read_step(const std::string& text) {
  ReadShape result;
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");  // what a reader leaves behind for the next is set anew
  std::istringstream stream(text);
  if (reader.ReadStream("text", stream) != IFSelect_RetDone)
    throw Error("expected a STEP text, found one that OpenCASCADE cannot read");
  if (const auto fail = first_of(reader.WS()->ModelCheckList()); !fail.empty())
    throw Error("expected a sound STEP text, found: " + fail);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  if (lengths.Size() > 0) result.unit = lengths.First().ToCString();
  reader.TransferRoots();
  result.shape = reader.OneShape();
  if (result.shape.IsNull()) throw Error("expected a shape in the STEP text, found none");
  if (const auto fail = first_of(reader.WS()->TransferReader()->LastCheckList()); !fail.empty())
    throw Error("expected a STEP text without faults, found: " + fail);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(result.shape, TopAbs_FACE, faces);
  if (const int n = count_face_entities(reader); faces.Size() < n)
    throw Error(fmt::format("expected {} faces, as the STEP text has, found {} that could be read", n, faces.Size()));
  read_face_names(reader, result);
  return result;
}

ReadShape read_shape(std::string_view text) {
  const auto begin = text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (begin.starts_with("DBRep_DrawableShape") || begin.starts_with("CASCADE Topology")) {
    ReadShape result;
    std::istringstream stream{std::string(text)};
    BRepTools::Read(result.shape, stream, BRep_Builder());
    if (result.shape.IsNull()) throw Error("expected a shape in BREP format, found none that can be read");
    return result;
  }
  if (!begin.starts_with("ISO-10303-21") && !begin.starts_with("/*"))
    throw Error("expected a STEP text (it begins with ISO-10303-21) or a BREP text, found another");
  return read_step(std::string(text));
}

/// Turns a shape into what does not need OpenCASCADE's topology.
class Converter {
 public:
  Converter(const TopoDS_Shape& shape, double scale) : scale_(scale) {
    TopExp::MapShapes(shape, TopAbs_FACE, faces_);
    TopExp::MapShapes(shape, TopAbs_EDGE, edges_);
    TopExp::MapShapes(shape, TopAbs_VERTEX, vertices_);
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
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) add_border(face, TopoDS::Edge(e.Current()), result);
    add_samples(face, number, result);
    return result;
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
      throw Error(fmt::format("face {}: expected a face that can be sampled, found a damaged one", number));
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

  double scale_;
  TopTools_IndexedMapOfShape faces_, edges_, vertices_;
  std::vector<int> number_;  // of edges, by their place in the map; -1: a pole
};

void sample(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  if (box.IsVoid()) throw Error("expected a shape with faces, found none");
  double x0 = 0, y0 = 0, z0 = 0, x1 = 0, y1 = 0, z1 = 0;
  box.Get(x0, y0, z0, x1, y1, z1);
  const double size = norm(Vec3{x1 - x0, y1 - y0, z1 - z0});
  if (!(size > 0 && size < 1e100)) throw Error(fmt::format("expected a shape of finite size, found {}", size));
  BRepTools::Clean(shape);
  BRepMesh_IncrementalMesh(shape, sample_deflection * size, false, sample_angle, false);
}

CadData convert(std::string_view text, double scale) {
  auto read = read_shape(text);
  BRepLib::BuildCurves3d(read.shape);
  sample(read.shape);
  Converter converter(read.shape, scale);
  auto data = converter.data();
  for (const auto& [shape, name] : read.names)
    if (const int f = converter.faces().FindIndex(shape); f > 0)
      data.faces[static_cast<std::size_t>(f - 1)].name = name;
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

}  // namespace

CadData occt_read(std::string_view text, double scale) {
  return with_occt([&] { return convert(text, scale); });
}

CadMeasures occt_measure(std::string_view text, double scale) {
  return with_occt([&] {
    const auto shape = read_shape(text).shape;
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

}  // namespace pamr::geometry
