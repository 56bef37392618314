// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/adapt_mesh.hpp"

#include <algorithm>
#include <utility>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mesh/require_field.hpp"

namespace pamr::dsmc {

namespace {

const std::string marks_name = "adapt";

mark::Choice choose(const par::Comm& comm, const mesh::DistMesh& mesh, const Adaptation& how) {
  auto applied = mark::apply(comm, mesh, how.request);
  mark::keep_below_level(mesh, mesh::max_level, applied.indicator);
  if (!how.max_cells) return {mark::marks_of(applied.indicator), std::move(applied.may_go), 1};
  const adapt::Forecaster forecaster(comm, mesh);
  const auto size = [&](std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go) {
    std::vector<std::uint8_t> goes(may_go.begin(), may_go.end());
    if (how.request.keep_for > 0) mark::keep_in_trial(comm, mesh, marks_name, how.request.keep_for, goes);
    return forecaster.forecast(adapt::signed_flags(marks, goes)).cells;
  };
  return mark::choose_within_budget(comm, mesh, how.request, applied,
                                    {.max_cells = *how.max_cells, .predicted_cells = size});
}

}  // namespace

void require_criteria(const par::Comm& comm, mesh::DistMesh& mesh, const Adaptation& how,
                      std::vector<mesh::CellField> averages, const std::string& where) {
  auto own_fields = mesh.cell_fields;
  for (auto& field : averages) mesh::put_field(mesh.cell_fields, std::move(field));
  with_file_name(where, [&] { return mark::apply(comm, mesh, how.request); });
  mesh.cell_fields = std::move(own_fields);
}

Adapted adapt_mesh(const par::Comm& comm, mesh::DistMesh mesh, const Adaptation& how,
                   std::vector<mesh::CellField> averages, const std::string& where) {
  const auto idle_name = marks_name + "_idle";
  auto own_fields = mesh.cell_fields;
  for (auto& field : averages) mesh::put_field(mesh.cell_fields, std::move(field));
  auto choice = with_file_name(where, [&] { return choose(comm, mesh, how); });
  if (how.request.keep_for > 0) {
    mark::keep_for_a_while(comm, mesh, marks_name, how.request.keep_for, choice.may_go);
    mesh::put_field(own_fields, *mesh.find_cell_field(idle_name));
  }
  mesh.cell_fields = std::move(own_fields);
  Adapted adapted;
  adapted.cells_marked = mark::count_marked(comm, choice.marks);
  const auto first_id = mesh.info.first_id;
  auto result = adapt::adapt(comm, std::as_const(mesh), adapt::signed_flags(choice.marks, choice.may_go));
  adapted.octets_gone = result.coarsening.octets_gone;
  for (const auto& one : result.merged) adapted.gone.push_back({one.number - first_id, one.into - first_id});
  adapted.mesh = std::move(result.mesh);
  return adapted;
}

}  // namespace pamr::dsmc
