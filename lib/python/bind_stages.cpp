// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bind_stages.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#ifdef PAMR_WITH_MESHING
#include "meshing/associate/associate_surfaces.hpp"
#include "meshing/associate/association_remarks.hpp"
#include "meshing/read_mesh_case.hpp"
#endif
#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/adapt/parent_data.hpp"
#include "pamr/adapt/refine_report.hpp"
#include "pamr/adapt/saved_rows.hpp"
#include "pamr/balance/rebalance.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/check/quality_report.hpp"
#include "pamr/check/report_text.hpp"
#include "pamr/curved/coarse_edges.hpp"
#include "pamr/locate/locate_points.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "python/numpy_arrays.hpp"
#include "python/python_mesh.hpp"

namespace py = pybind11;

namespace pamr::python {

namespace {

using SharedMesh = std::shared_ptr<PythonMesh>;
using Released = py::gil_scoped_release;

SharedMesh same_ranks(const PythonMesh& old, mesh::DistMesh mesh) {
  auto result = std::make_shared<PythonMesh>();
  result->comm = old.comm;
  result->mesh = std::move(mesh);
  return result;
}

/// The numbers of a report as a dictionary of Python.
py::dict to_dict(const nlohmann::json& numbers) { return py::module_::import("json").attr("loads")(numbers.dump()); }

/// The keys of pamr-refine, and those that only Python has.
py::dict to_dict(const adapt::Report& report) {
  auto numbers = adapt::to_json(report);
  numbers["closure_rounds"] = report.closure.rounds;
  numbers["nodes_moved"] = report.certificate.n_moved;
  numbers["nodes_off_surface"] = report.certificate.n_off_surface;
  numbers["cells_moved"] = report.balance.moved_cells;
  numbers["imbalance"] = report.balance.after.imbalance;
  numbers["seconds"] = nlohmann::json::object();
  for (const auto& step : report.steps) numbers["seconds"][step.step] = step.wall;
  return to_dict(numbers);
}

/// Policy and shape floor.
using Closing = std::pair<std::string, double>;
/// Whether new nodes are put onto surfaces, and which edges of level 0 may bend.
using Placing = std::pair<bool, std::string>;

refine::Options options_of(const Closing& closing) {
  refine::Options how;
  how.quality_control = refine::quality_control_named(closing.first);
  how.shape_floor = closing.second;
  refine::require_sound(how);
  return how;
}

/// The mesh lent, and so the cells where they are, or a copy whose cells may move.
adapt::GivenMesh given_mesh(const PythonMesh& old, const adapt::Balancing& balancing) {
  if (old.comm->size() == 1 || balancing.how.method == balance::Method::none) return old.mesh;
  return mesh::DistMesh(old.mesh);
}

/// The balancing that the names stand for. A field of weights is looked at here, because nobody else does where no cell may move.
/// Collective.
adapt::Balancing balancing_of(const PythonMesh& mesh, const std::string& method, const std::string& weights) {
  auto balancing = adapt::balancing_named(method, weights);
  if (balancing.weights == adapt::Weights::field)
    (void)balance::weights_from_field(*mesh.comm, mesh.mesh, balancing.field);
  return balancing;
}

/// Sentences on flags that were not followed and on periodic patches, as pamr-refine has them.
std::vector<std::string> remarks_on(const adapt::Report& report, const adapt::CoarseningReport& coarsening,
                                    const mesh::DistMesh& mesh) {
  std::vector<std::string> remarks{mesh::warning_of_periodic(mesh.info.patches)};
  if (report.marked_too_deep > 0) remarks.push_back(adapt::too_deep_text(report.marked_too_deep));
  remarks.push_back(adapt::nothing_coarsened_text(coarsening));
  std::erase(remarks, "");
  return remarks;
}

/// The new mesh, the report and what else to say.
py::tuple refine(const PythonMesh& old, const Array<std::uint8_t>& flags, const Placing& placing,
                 const Closing& closing, const std::string& method, const std::string& weights) {
  const auto values = rows_of<std::uint8_t>(flags);
  auto refined = [&] {
    const Released released;
    auto how = options_of(closing);
    how.project = placing.first;
    how.bend = refine::bend_named(placing.second);
    const auto balancing = balancing_of(old, method, weights);
    return adapt::refine(*old.comm, given_mesh(old, balancing), values, how, balancing);
  }();
  const auto remarks = remarks_on(refined.report, {}, refined.mesh);
  return py::make_tuple(same_ranks(old, std::move(refined.mesh)), to_dict(refined.report), remarks);
}

/// Likewise.
py::tuple adapt_both_ways(const PythonMesh& old, const Array<std::int8_t>& flags, const Placing& placing,
                          const Closing& closing, const std::string& method, const std::string& weights,
                          const std::vector<std::string>& integrals) {
  const auto values = rows_of<std::int8_t>(flags);
  auto adapted = [&] {
    const Released released;
    adapt::Options how;
    how.refinement = options_of(closing);
    how.refinement.project = placing.first;
    how.refinement.bend = refine::bend_named(placing.second);
    how.balancing = balancing_of(old, method, weights);
    how.refinement.integrals = integrals;
    return adapt::adapt(*old.comm, given_mesh(old, how.balancing), values, how);
  }();
  auto report = to_dict(adapted.report);
  report["coarsening"] = to_dict(adapt::to_json(adapted.coarsening));
  const auto remarks = remarks_on(adapted.report, adapted.coarsening, adapted.mesh);
  return py::make_tuple(same_ranks(old, std::move(adapted.mesh)), report, remarks);
}

SharedMesh balanced(const PythonMesh& old, const Array<double>& weights, const std::string& method) {
  const auto values = rows_of<double>(weights);
  const Released released;
  auto result = balance::rebalance(*old.comm, mesh::DistMesh(old.mesh), std::span<const double>(values),
                                   {.method = balance::method_named(method)});
  return same_ranks(old, std::move(result.mesh));
}

Array<double> indicator(const PythonMesh& mesh, const std::vector<std::pair<std::string, std::string>>& options) {
  const auto applied = [&] {
    const Released released;
    std::vector<mark::Given> given;
    for (const auto& [option, text] : options) given.push_back({option, text});
    return mark::apply(*mesh.comm, mesh.mesh, mark::read_request(given));
  }();
  return copy_out(applied.indicator);
}

/// The most wanted cells within a number of cells after refinement; below 0: all of them.
Array<std::uint8_t> flags_of(const PythonMesh& mesh, const Array<double>& indicator, int max_level,
                             std::int64_t max_cells, const Closing& closing) {
  auto wish = rows_of<double>(indicator);
  const auto marks = [&] {
    const Released released;
    if (max_level >= 0) mark::keep_below_level(mesh.mesh, max_level, wish);
    if (max_cells < 0) return mark::marks_of(wish);
    const adapt::Forecaster forecaster(*mesh.comm, mesh.mesh, options_of(closing));
    return mark::marks_within_budget(*mesh.comm, mesh.mesh, wish, max_cells, [&](std::span<const std::uint8_t> some) {
      return forecaster.forecast(some).cells;
    });
  }();
  return copy_out(marks);
}

py::tuple forecast(const PythonMesh& mesh, const Array<std::int8_t>& flags, const Closing& closing) {
  const auto values = rows_of<std::int8_t>(flags);
  const Released released;
  const adapt::Forecaster forecaster(*mesh.comm, mesh.mesh, options_of(closing));
  const auto result = forecaster.forecast(values);
  const auto nodes = forecaster.nodes(result);
  const py::gil_scoped_acquire held;
  return py::make_tuple(result.cells, nodes);
}

std::string quality(const PythonMesh& mesh) {
  return check::to_json(check::report_quality(*mesh.comm, mesh.mesh)).dump();
}

py::tuple locate_points(PythonMesh& mesh, const Array<double>& points, const Array<std::int32_t>& near) {
  const auto where = rows_of<geometry::Vec3>(points);
  const auto from = rows_of<LocalId>(near);
  const auto found = [&] {
    const Released released;
    if (!mesh.locator) mesh.locator = std::make_unique<locate::Locator>(mesh.mesh);
    return locate::locate_points(*mesh.comm, mesh.mesh, *mesh.locator, where, from);
  }();
  return py::make_tuple(copy_out(found.cell), copy_out(found.rank));
}

/// Rows of bytes, `offset` in bytes, for the cells `wanted`.
py::tuple fetch_rows(const PythonMesh& mesh, GlobalId n_cells, const Array<std::int64_t>& held,
                     const Array<std::int64_t>& offset, const Array<std::uint8_t>& bytes,
                     const Array<std::int64_t>& wanted) {
  const auto ids = rows_of<GlobalId>(held), ask = rows_of<GlobalId>(wanted);
  adapt::CellRows<std::uint8_t> rows{{}, rows_of<std::uint8_t>(bytes)};
  for (const auto begin : rows_of<std::int64_t>(offset)) rows.offset.push_back(static_cast<std::size_t>(begin));
  const auto fetched = [&] {
    const Released released;
    return adapt::fetch_cell_rows<std::uint8_t>(*mesh.comm, {n_cells, mesh.mesh.info.first_id}, ids, rows, ask);
  }();
  const std::vector<std::int64_t> begins(fetched.offset.begin(), fetched.offset.end());
  return py::make_tuple(copy_out(begins), copy_out(fetched.value));
}

void write_rows(const PythonMesh& mesh, const std::string& file, const Array<std::int64_t>& offset,
                const Array<std::uint8_t>& bytes, std::size_t item_bytes, const std::string& description) {
  adapt::CellRows<std::byte> rows{{}, rows_of<std::byte>(bytes)};
  for (const auto begin : rows_of<std::int64_t>(offset)) rows.offset.push_back(static_cast<std::size_t>(begin));
  const Released released;
  adapt::detail::write_cell_rows(*mesh.comm, file, mesh.mesh, {rows.offset, rows.value, item_bytes}, description);
}

/// Description, offsets in items, bytes. `item_bytes` 0: of any size.
py::tuple read_rows(const PythonMesh& mesh, const std::string& file, std::size_t item_bytes) {
  const auto [rows, description] = [&] {
    const Released released;
    return adapt::detail::read_cell_rows(*mesh.comm, file, mesh.mesh, item_bytes);
  }();
  const std::vector<std::int64_t> begins(rows.offset.begin(), rows.offset.end());
  std::vector<std::uint8_t> bytes(rows.value.size());
  if (!bytes.empty()) std::memcpy(bytes.data(), rows.value.data(), bytes.size());
  return py::make_tuple(description, copy_out(begins), copy_out(bytes));
}

/// What to tell a user of edges of level 0 that are long for the radius of their wall.
std::string text_of_coarse_walls(const PythonMesh& mesh) {
  return curved::text_of(curved::find_coarse_edges(*mesh.comm, mesh.mesh));
}

#ifdef PAMR_WITH_MESHING
/// Patch, surface and largest distance of each association, and on the first rank what to tell of them. Collective.
std::pair<std::vector<std::tuple<std::string, std::string, double>>, std::vector<std::string>> associate(
    PythonMesh& mesh, const std::string& toml, const std::vector<std::string>& pairs,
    const std::vector<std::pair<std::string, std::string>>& files, double feature_angle, double tolerance) {
  unshare_field(mesh, false, mesh::off_surface_field);
  const Released released;
  meshing::AssociationRequest request;
  par::agree(*mesh.comm, [&] { request.described = meshing::read_surfaces(toml, "surfaces", mesh.mesh.info.patches); });
  request.pairs = pairs;
  request.files = files;
  request.feature_angle = feature_angle;
  request.tolerance = tolerance;
  std::vector<std::tuple<std::string, std::string, double>> result;
  const auto associations = meshing::associate_surfaces(*mesh.comm, mesh.mesh, request);
  for (const auto& found : associations) result.emplace_back(found.patch, found.surface, found.worst_distance);
  const auto undescribed = mesh::find_undescribed_patches(*mesh.comm, mesh.mesh);
  std::vector<std::string> remarks;
  if (!mesh.comm->is_first()) return {std::move(result), remarks};
  remarks = meshing::remarks_on(associations, *mesh.mesh.info.surfaces);
  for (auto& text : mesh::warnings_of(mesh.mesh.info, undescribed)) remarks.push_back(std::move(text));
  return {std::move(result), std::move(remarks)};
}
#endif

}  // namespace

void bind_stages(py::module_& module) {
  module.def("refine", refine);
  module.def("adapt", adapt_both_ways);
  module.def("balance", balanced);
  module.def("indicator", indicator);
  module.def("flags", flags_of);
  module.def("forecast", forecast);
  module.def("text_of_coarse_walls", text_of_coarse_walls, py::call_guard<py::gil_scoped_release>());
  module.def("quality", quality, py::call_guard<py::gil_scoped_release>());
  module.def("locate", locate_points);
  module.def("fetch_rows", fetch_rows);
  module.def("write_rows", write_rows);
  module.def("read_rows", read_rows);
#ifdef PAMR_WITH_MESHING
  module.def("associate", associate);
#endif
}

}  // namespace pamr::python
