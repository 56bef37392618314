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
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepBasic_UncertaintyMeasureWithUnit.hxx>
#include <StepRepr_CharacterizedDefinition.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_PropertyDefinition.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_RepresentationRelationshipWithTransformation.hxx>
#include <StepRepr_RepresentedDefinition.hxx>
#include <StepRepr_ShapeRepresentationRelationship.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepVisual_Colour.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <unordered_set>
#include <utility>
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

/// A name of the file, empty where it says that there is none or its writer made it up.
std::string sound_name(const Handle(TCollection_HAsciiString) & text) {
  if (text.IsNull()) return {};
  auto name = one_line(text->ToCString());
  return name == "NONE" || name.starts_with("Open CASCADE STEP translator") ? std::string() : name;
}

/// The name of the part (product) whose shape has an item in it, empty where there is none. A part may have its solids
/// in a representation that belongs to the one that it names.
std::string part_with(const Interface_Graph& graph, const Handle(Standard_Transient) & item) {
  std::vector<Handle(Standard_Transient)> open{item};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto add = [&](const Handle(Standard_Transient) & entity) {
      if (!entity.IsNull() && std::find(open.begin(), open.end(), entity) == open.end()) open.push_back(entity);
    };
    auto users = graph.Sharings(open[i]);
    for (users.Start(); users.More(); users.Next()) {
      const auto& user = users.Value();
      if (user->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) add(user);
      if (const auto pair = Handle(StepRepr_ShapeRepresentationRelationship)::DownCast(user);
          !pair.IsNull() && !user->IsKind(STANDARD_TYPE(StepRepr_RepresentationRelationshipWithTransformation))) {
        add(pair->Rep1());
        add(pair->Rep2());
      }
      const auto definition = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(user);
      if (definition.IsNull()) continue;
      const auto property = definition->Definition().PropertyDefinition();
      const auto part = property.IsNull() ? nullptr : property->Definition().ProductDefinition();
      if (!part.IsNull() && !part->Formation().IsNull() && !part->Formation()->OfProduct().IsNull())
        return sound_name(part->Formation()->OfProduct()->Name());
    }
  }
  return {};
}

void read_names(const STEPControl_Reader& reader, OcctShape& result) {
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  const Interface_Graph graph(reader.WS()->Model());
  const auto put = [](OcctTexts& texts, const TopoDS_Shape& shape, const std::string& name) {
    if (!name.empty()) texts.try_emplace(shape.TShape().get(), name);
  };
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(process->Mapped(i));
    if (item.IsNull()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, item);
    if (shape.IsNull()) continue;
    if (shape.ShapeType() == TopAbs_FACE) put(result.names, shape, sound_name(item->Name()));
    if (shape.ShapeType() != TopAbs_SOLID) continue;
    put(result.solid_names, shape, sound_name(item->Name()));
    put(result.part_names, shape, part_with(graph, item));
  }
}

/// The largest uncertainty of lengths that the text states, millimeters, if the first unit of lengths is that of all.
double stated_tolerance(const STEPControl_Reader& reader, std::string unit) {
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  constexpr std::array<std::pair<std::string_view, double>, 5> others{
      {{"METRE", 1000.0}, {"CENTIMETRE", 10.0}, {"MICROMETRE", 1e-3}, {"INCH", 25.4}, {"FOOT", 304.8}}};
  double length = 1;
  for (const auto& [name, millimeters] : others)
    if (name == unit) length = millimeters;
  double largest = 0;
  const auto model = reader.WS()->Model();
  for (int i = 1; i <= model->NbEntities(); ++i)
    if (const auto measure = Handle(StepBasic_UncertaintyMeasureWithUnit)::DownCast(model->Value(i)); !measure.IsNull())
      largest = std::max(largest, length * measure->ValueComponent());
  return std::isfinite(largest) ? largest : 0;
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
      for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) result.colors[e.Current().TShape().get()] = text;
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
  result.tolerance = stated_tolerance(reader, result.unit);
  read_names(reader, result);
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

std::string text_of(const OcctTexts& texts, const TopoDS_Shape& shape) {
  const auto found = texts.find(shape.TShape().get());
  return found == texts.end() ? std::string() : found->second;
}

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
