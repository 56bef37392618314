// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/cad_surfaces.hpp"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "meshing/associate/find_cad_faces.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/cad/cad_source.hpp"

namespace pamr::convert {

namespace {

/// Says what of a patch does not lie on the shape.
void warn_of_untied(cli::Session& session, const CadRequest& request, const meshing::CadPatch& patch) {
  if (patch.is_tied()) return;
  if (patch.n_on == 0)
    return session.warn(
        fmt::format("patch '{}': none of its {} faces lies on a face of {} (corners up to {:.3g} off): "
                    "it gets no surface",
                    patch.patch, patch.n_off, request.file, patch.worst_distance));
  const auto remark = fmt::format("patch '{}': {} of its {} faces {} on no face of {} (corners up to {:.3g} off)",
                                  patch.patch, patch.n_off, patch.n_on + patch.n_off, patch.n_off == 1 ? "lies" : "lie",
                                  request.file, patch.worst_distance);
  if (request.is_strict) throw Error(remark);
  session.warn(remark + ": it gets no surface; --tolerance allows more, or make a patch of its own of them");
}

}  // namespace

geometry::SurfaceSet find_cad_surfaces(cli::Session& session, const CadRequest& request, mesh::DistMesh& mesh,
                                       nlohmann::json& report) {
  const auto& comm = session.comm();
  geometry::CadSource source;
  par::agree(comm, [&] {
    if (comm.is_first()) source = geometry::read_cad_source(request.file);
  });
  source.file = comm.broadcast(std::move(source.file));
  source.text = comm.broadcast(std::move(source.text));
  std::shared_ptr<const geometry::CadModel> model;
  par::agree(comm, [&] { model = geometry::make_cad_model(source, request.unit); });
  const auto patches = meshing::find_cad_faces(
      comm, mesh, *model, source, {.unit = request.unit, .tolerance = request.tolerance, .named = request.named});
  auto& json = report["cad"];
  json = {{"file", source.file},
          {"faces", model->faces().size()},
          {"size", model->size()},
          {"unit_of_file", model->unit_of_file()},
          {"largest_edge_tolerance", model->largest_tolerance()},
          {"open_edges", model->n_open_edges()}};
  geometry::CadMeasures measures;
  par::agree(comm, [&] {
    if (comm.is_first()) measures = geometry::measure_cad_source(source, request.unit);
  });
  json["area_of_faces"] = measures.area;
  if (model->n_open_edges() == 0) json["volume"] = measures.volume;
  std::vector<geometry::CadPart> parts;
  for (const auto& patch : patches) {
    if (patch.is_tied()) parts.push_back({patch.patch, patch.faces});
    json["patches"][patch.patch] = {{"faces", patch.faces}, {"on", patch.n_on}, {"off", patch.n_off}};
    warn_of_untied(session, request, patch);
  }
  if (const int n = model->n_open_edges(); n > 0)
    session.warn(
        fmt::format("{}: {} edges belong to one face only (the shape is open, or its faces are not sewn): "
                    "nodes there keep to their faces alone",
                    request.file, n));
  geometry::SurfaceSet set;
  par::agree(comm, [&] { set = geometry::cad_surfaces(source, request.unit, model, parts, "--cad " + request.file); });
  return set;
}

}  // namespace pamr::convert
