// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/occt_iges.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESGraph_Color.hxx>
#include <Interface_Static.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"

namespace pamr::geometry {

namespace {

constexpr double min_sewing = 1e-6, max_sewing = 1e-4;  // tolerance, of the size
constexpr std::size_t column_of_section = 72;

/// A text as a file that has a name while it lives: OpenCASCADE reads IGES from files only.
class NamedText {
 public:
  explicit NamedText(std::string_view text) : file_(memfd_create("iges", MFD_CLOEXEC)) {
    if (file_ < 0) throw Error("expected memory for the text of the IGES file, found none");
    while (!text.empty()) {
      const auto n = write(file_, text.data(), text.size());
      if (n <= 0) throw Error("expected memory for the text of the IGES file, found too little");
      text.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  ~NamedText() {
    if (file_ >= 0) close(file_);
  }
  NamedText(const NamedText&) = delete;
  NamedText& operator=(const NamedText&) = delete;
  NamedText(NamedText&&) = delete;
  NamedText& operator=(NamedText&&) = delete;
  std::string name() const { return fmt::format("/proc/self/fd/{}", file_); }

 private:
  int file_;
};

/// Color of an entity, empty where it has none. The numbers from 1 to 8 are those of the format.
std::string color_of(const Handle(IGESData_IGESEntity) & entity) {
  constexpr std::array<const char*, 9> known{"",        "#000000", "#ff0000", "#00ff00", "#0000ff",
                                             "#ffff00", "#ff00ff", "#00ffff", "#ffffff"};
  const auto own = Handle(IGESGraph_Color)::DownCast(entity->Color());
  if (own.IsNull()) {
    const int rank = entity->RankColor();
    return rank > 0 && rank < static_cast<int>(known.size()) ? known[static_cast<std::size_t>(rank)] : "";
  }
  std::array<double, 3> percent{};
  own->RGBIntensity(percent[0], percent[1], percent[2]);
  std::string text = "#";
  for (const double part : percent)
    text += fmt::format("{:02x}", std::lround(255 * std::clamp(std::isfinite(part) ? part : 0, 0.0, 100.0) / 100));
  return text;
}

void read_face_properties(IGESControl_Reader& reader, OcctShape& result) {
  const auto transfer = reader.WS()->TransferReader();
  for (TopExp_Explorer e(result.shape, TopAbs_FACE); e.More(); e.Next()) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(transfer->EntityFromShapeResult(e.Current(), 1));
    if (entity.IsNull()) continue;
    const auto* key = e.Current().TShape().get();
    if (entity->HasName()) result.names[key] = entity->NameValue()->ToCString();
    if (auto color = color_of(entity); !color.empty()) result.colors[key] = std::move(color);
  }
}

double size_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

/// Sews loose faces; names and colors go with them.
void sew(OcctShape& read, double resolution) {
  const double size = size_of(read.shape);
  if (!(size > 0) || !std::isfinite(size)) throw Error(fmt::format("expected a shape of finite size, found {}", size));
  BRepBuilderAPI_Sewing sewing(std::clamp(10 * resolution, min_sewing * size, max_sewing * size));
  for (TopExp_Explorer e(read.shape, TopAbs_FACE); e.More(); e.Next()) sewing.Add(e.Current());
  sewing.Perform();
  if (sewing.SewedShape().IsNull()) throw Error("expected faces that can be sewn, found none");
  for (TopExp_Explorer e(read.shape, TopAbs_FACE); e.More(); e.Next()) {
    if (!sewing.IsModified(e.Current())) continue;
    const TopoDS_Shape& sewn = sewing.Modified(e.Current());
    for (auto* texts : {&read.names, &read.colors})
      if (auto text = text_of(*texts, e.Current()); !text.empty()) (*texts)[sewn.TShape().get()] = std::move(text);
  }
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (TopExp_Explorer e(sewing.SewedShape(), TopAbs_SHELL); e.More(); e.Next()) {
    if (!BRep_Tool::IsClosed(e.Current())) {
      builder.Add(all, e.Current());
      continue;
    }
    TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(e.Current())).Solid();
    BRepLib::OrientClosedSolid(solid);
    builder.Add(all, solid);
  }
  for (TopExp_Explorer e(sewing.SewedShape(), TopAbs_FACE, TopAbs_SHELL); e.More(); e.Next())
    builder.Add(all, e.Current());
  read.shape = all;
}

}  // namespace

bool is_iges(std::string_view text) {
  const auto line = text.substr(0, text.find_first_of("\r\n"));
  return line.size() > column_of_section && line[column_of_section] == 'S';
}

OcctShape read_iges(std::string_view text) {
  OcctShape result;
  const NamedText file(text);
  IGESControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");  // what a reader leaves behind for the next is set anew
  if (reader.ReadFile(file.name().c_str()) != IFSelect_RetDone)
    throw Error("expected an IGES text, found one that OpenCASCADE cannot read");
  const auto model = reader.IGESModel();
  if (!model.IsNull() && !model->GlobalSection().UnitName().IsNull())
    result.unit = model->GlobalSection().UnitName()->ToCString();
  reader.TransferRoots();
  result.shape = reader.OneShape();
  if (result.shape.IsNull() || !TopExp_Explorer(result.shape, TopAbs_FACE).More())
    throw Error("expected faces in the IGES text, found none: curves alone are no shape; export surfaces or a solid");
  read_face_properties(reader, result);
  const double in_mm = model.IsNull() ? 0 : model->GlobalSection().Resolution() * model->GlobalSection().UnitValue();
  result.tolerance = std::isfinite(in_mm) ? in_mm : 0;
  if (!TopExp_Explorer(result.shape, TopAbs_SOLID).More()) sew(result, result.tolerance);
  return result;
}

}  // namespace pamr::geometry
