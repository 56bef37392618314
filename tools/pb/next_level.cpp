// SPDX-License-Identifier: GPL-3.0-or-later
#include "pb/next_level.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "adapt/flat_patches.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mark/indicator.hpp"

namespace pamr::tools {

namespace {

/// The marks, and how many cells would have been marked without a limit.
struct Marks {
  std::vector<std::uint8_t> marks;
  std::int64_t n_marked = 0, n_wanted = 0;
};

Marks mark_cells(const par::Comm& comm, const mesh::DistMesh& mesh, int level, std::int64_t max_cells,
                 const refine::Options& how) {
  const bool has_goals = mesh.find_cell_field("goal_error") != nullptr;
  const double share = level == 0 ? 0.6 : has_goals ? 0.5 : 0.3;
  mark::Request request;
  request.criteria.push_back({"--bulk-of", mark::BulkOf{has_goals ? "goal_error" : "indicator", share}});
  auto indicator = mark::apply(comm, mesh, request).indicator;
  mark::keep_below_level(mesh, mesh::max_level, indicator);
  const adapt::Forecaster forecaster(comm, mesh, how);
  Marks marks;
  marks.n_wanted = mark::count_marked(comm, mark::marks_of(indicator));
  marks.marks = mark::marks_within_budget(comm, mesh, indicator, max_cells, [&](std::span<const std::uint8_t> some) {
    return forecaster.forecast(some).cells;
  });
  marks.n_marked = mark::count_marked(comm, marks.marks);
  return marks;
}

}  // namespace

std::optional<mesh::DistMesh> next_level(cli::Session& session, mesh::DistMesh mesh, int level,
                                         std::int64_t max_cells) {
  const auto& comm = session.comm();
  session.step(fmt::format("marking {} cells", mesh.info.n_global_cells));
  refine::Options how;
  how.parent_field = false;
  std::erase_if(mesh.cell_fields, [](const mesh::CellField& field) { return field.name == mesh::parent_field; });
  if (level == 0) keep_flat_patches(session, mesh);
  const auto [marks, n_marked, n_wanted] = mark_cells(comm, mesh, level, max_cells, how);
  if (n_marked == 0) {
    session.note(n_wanted == 0 ? "the estimated error is 0 in all cells: nothing is refined"
                               : fmt::format("level {} is the last: the next one would have more than {} cells", level,
                                             max_cells));
    return std::nullopt;
  }
  const auto before = mesh.info.n_global_cells;
  session.step(fmt::format("refining {} cells", before));
  auto result = adapt::refine(comm, std::move(mesh), marks, how);
  const auto& report = result.report;
  if (level == 0 && !report.level0.trouble.empty())
    session.warn(report.level0.trouble + ": cells there may lose shape from level to level");
  session.summary(
      fmt::format("level {}: {} of {} cells marked{}, {} cells{}", level + 1, n_marked, before,
                  n_wanted > n_marked ? fmt::format(" (of {} wanted, by --max-cells)", n_wanted) : "", report.cells_out,
                  report.certificate.n_off_surface > 0
                      ? ", " + counted(report.certificate.n_off_surface, "node is", "nodes are") + " off their surface"
                      : ""));
  return std::move(result.mesh);
}

}  // namespace pamr::tools
