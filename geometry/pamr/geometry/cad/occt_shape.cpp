// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_shape.hpp"

#include <fmt/format.h>

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPConstruct_Styles.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepVisual_Colour.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/geometry/cad/occt_iges.hpp"

namespace pamr::geometry {

namespace {

std::string first_of(const Interface_CheckIterator& checks) {
  for (checks.Start(); checks.More(); checks.Next())
    if (const auto& check = checks.Value(); check->HasFailed() && check->NbFails() > 0)
      return one_line(check->CFail(1));
  return {};
}

void read_face_names(STEPControl_Reader& reader, OcctShape& result) {
  const auto transfer = reader.WS()->TransferReader();
  for (TopExp_Explorer e(result.shape, TopAbs_FACE); e.More(); e.Next()) {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(e.Current(), 1));
    if (item.IsNull() || item->Name().IsNull()) continue;
    std::string name = item->Name()->ToCString();
    if (!name.empty() && name != "NONE") result.names.emplace_back(e.Current(), std::move(name));
  }
}

/// Colors of bodies and shells first: those of their faces count more and come later.
void read_face_colors(STEPControl_Reader& reader, OcctShape& result) {
  STEPConstruct_Styles styles(reader.WS());
  if (!styles.LoadStyles()) return;
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  for (const bool of_faces : {false, true})
    for (int i = 1; i <= styles.NbStyles(); ++i) {
      const auto style = styles.Style(i);
      if (style.IsNull() || style->Item().IsNull()) continue;
      Handle(StepVisual_Colour) surface, border, curve, rendering;
      double transparency = 0;
      bool is_component = false;
      Quantity_Color color;
      if (!styles.GetColors(style, surface, border, curve, rendering, transparency, is_component)) continue;
      if (surface.IsNull()) surface = rendering;
      if (surface.IsNull() || !STEPConstruct_Styles::DecodeColor(surface, color)) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, style->Item());
      if (shape.IsNull() || (shape.ShapeType() == TopAbs_FACE) != of_faces) continue;
      std::string text = Quantity_Color::ColorToHex(color).ToCString();
      std::transform(text.begin(), text.end(), text.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) result.colors.emplace_back(e.Current(), text);
    }
}

int count_face_entities(const STEPControl_Reader& reader) {
  const auto model = reader.WS()->Model();
  int n = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) n += model->Value(i)->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
  return n;
}

OcctShape read_step(const std::string& text) {
  OcctShape result;
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
  read_face_colors(reader, result);
  return result;
}

OcctShape read_brep(std::string_view text) {
  OcctShape result;
  std::istringstream stream{std::string(text)};
  BRepTools::Read(result.shape, stream, BRep_Builder());
  result.is_as_written = true;
  if (result.shape.IsNull()) throw Error("expected a shape in BREP format, found none that can be read");
  return result;
}

}  // namespace

OcctShape read_occt_shape(std::string_view text) {
  if (is_iges(text)) return read_iges(text);
  const auto begin = text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (begin.starts_with("DBRep_DrawableShape") || begin.starts_with("CASCADE Topology")) return read_brep(text);
  if (!begin.starts_with("ISO-10303-21") && !begin.starts_with("/*"))
    throw Error(
        "expected a STEP text (it begins with ISO-10303-21), an IGES text (S in column 73 of its first line) or a BREP "
        "text, found another");
  return read_step(std::string(text));
}

}  // namespace pamr::geometry
