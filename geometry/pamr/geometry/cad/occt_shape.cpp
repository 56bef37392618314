// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_shape.hpp"

#include <fmt/format.h>

// The second of OpenCASCADE 7.8 needs the first.
// clang-format off
#include <StepData_StepModel.hxx>
#include <STEPConstruct_Styles.hxx>
// clang-format on

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_ShapeRepresentationRelationship.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
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
#include <cstdlib>
#include <sstream>
#include <unordered_set>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/geometry/cad/occt_iges.hpp"

namespace pamr::geometry {

namespace {

/// Numbers of entities of a STEP text.
using Entities = std::unordered_set<int>;

/// Whether shapes, where they are put, or their units begin at an entity. All else (colors, markers, dimensions, notes,
/// construction lines) may be as it is.
bool is_of_shapes(const Handle(Standard_Transient) & entity) {
  return entity->IsKind(STANDARD_TYPE(StepShape_SolidModel)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_FaceBasedSurfaceModel)) ||
         entity->IsKind(STANDARD_TYPE(StepShape_ContextDependentShapeRepresentation)) ||
         entity->IsKind(STANDARD_TYPE(StepRepr_ShapeRepresentationRelationship)) ||
         entity->IsKind(STANDARD_TYPE(StepRepr_MappedItem)) ||
         entity->IsKind(STANDARD_TYPE(StepRepr_RepresentationMap));
}

/// What shapes, the places of parts in assemblies, and their units refer to. A representation, which lists all kinds of
/// things, is not gone through but for its context, where the units are.
Entities entities_of_shapes(const STEPControl_Reader& reader) {
  const auto model = reader.WS()->Model();
  const Interface_Graph graph(model);
  Entities found;
  std::vector<Handle(Standard_Transient)> open;
  const auto add = [&](const Handle(Standard_Transient) & entity) {
    if (!entity.IsNull() && found.insert(model->Number(entity)).second) open.push_back(entity);
  };
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = model->Value(i);
    if (is_of_shapes(entity)) add(entity);
    if (const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(entity); !shape.IsNull())
      add(shape->ContextOfItems());
  }
  while (!open.empty()) {
    const auto entity = open.back();
    open.pop_back();
    if (entity->IsKind(STANDARD_TYPE(StepRepr_Representation))) continue;
    auto shared = graph.Shareds(entity);
    for (shared.Start(); shared.More(); shared.Next()) add(shared.Value());
  }
  return found;
}

/// The number that the text gives the entity of which a failure of the text as a whole speaks ("... Ent.Id.#12 ...");
/// 0: of none.
int entity_named_in(const std::string& failure) {
  constexpr std::string_view before = "Ent.Id.#";
  const auto place = failure.find(before);
  return place == std::string::npos ? 0 : std::atoi(failure.c_str() + place + before.size());
}

/// The first failure of an entity among these, or of the text as a whole.
std::string first_of(const Interface_CheckIterator& checks, const STEPControl_Reader& reader, const Entities& among) {
  const auto model = Handle(StepData_StepModel)::DownCast(reader.WS()->Model());
  Entities labels;
  for (const int i : among)
    if (i > 0 && !model.IsNull()) labels.insert(model->IdentLabel(model->Value(i)));
  for (checks.Start(); checks.More(); checks.Next()) {
    const auto& check = checks.Value();
    for (int i = 1; i <= check->NbFails(); ++i) {
      const auto failure = one_line(check->CFail(i));
      const int label = checks.Number() > 0 ? 0 : entity_named_in(failure);
      if (checks.Number() > 0 ? among.count(checks.Number()) > 0 : label == 0 || labels.count(label) > 0)
        return failure;
    }
  }
  return {};
}

void read_names(STEPControl_Reader& reader, const TopoDS_Shape& shape, TopAbs_ShapeEnum type,
                std::vector<std::pair<TopoDS_Shape, std::string>>& names) {
  const auto transfer = reader.WS()->TransferReader();
  for (TopExp_Explorer e(shape, type); e.More(); e.Next()) {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(e.Current(), 1));
    if (item.IsNull() || item->Name().IsNull()) continue;
    std::string name = item->Name()->ToCString();
    if (!name.empty() && name != "NONE") names.emplace_back(e.Current(), std::move(name));
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

int count_faces(const STEPControl_Reader& reader, const Entities& among) {
  const auto model = reader.WS()->Model();
  return static_cast<int>(std::count_if(among.begin(), among.end(), [&](int i) {
    return i > 0 && model->Value(i)->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
  }));
}

OcctShape read_step(const std::string& text) {
  OcctShape result;
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");  // what a reader leaves behind for the next is set anew
  std::istringstream stream(text);
  if (reader.ReadStream("text", stream) != IFSelect_RetDone)
    throw Error("expected a STEP text, found one that OpenCASCADE cannot read");
  const auto of_shapes = entities_of_shapes(reader);
  if (const auto fail = first_of(reader.WS()->ModelCheckList(), reader, of_shapes); !fail.empty())
    throw Error("expected a sound STEP text, found: " + fail);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  if (lengths.Size() > 0) result.unit = lengths.First().ToCString();
  reader.TransferRoots();
  result.shape = reader.OneShape();
  if (result.shape.IsNull()) throw Error("expected a shape in the STEP text, found none");
  if (const auto fail = first_of(reader.WS()->TransferReader()->LastCheckList(), reader, of_shapes); !fail.empty())
    throw Error("expected a STEP text without faults, found: " + fail);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(result.shape, TopAbs_FACE, faces);
  if (const int n = count_faces(reader, of_shapes); faces.Size() < n)
    throw Error(fmt::format("expected {} faces, as the STEP text has, found {} that could be read", n, faces.Size()));
  read_names(reader, result.shape, TopAbs_FACE, result.names);
  read_names(reader, result.shape, TopAbs_SOLID, result.solid_names);
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
