// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/apply_criteria.hpp"

#include <algorithm>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::mark {

namespace {

struct Evaluate {
  const par::Comm* comm;
  const mesh::DistMesh* mesh;
  CellSize size;
  KnownErrors* known;

  Indicator operator()(const AllCells&) const { return mark::all_cells(*mesh); }
  Indicator operator()(const CrossingSphere& rule) const { return mark::crossing_sphere(*mesh, rule.sphere); }
  Indicator operator()(const CentroidShell& rule) const {
    return mark::centroid_in_shell(*mesh, rule.sphere, rule.width);
  }
  Indicator operator()(const Box& rule) const { return mark::centroid_in_box(*mesh, rule.low, rule.high); }
  Indicator operator()(const NearPatch& rule) const { return mark::near_patch(*comm, *mesh, rule.patch, rule.layers); }
  Indicator operator()(const Threshold& rule) const { return mark::beyond_threshold(*comm, *mesh, rule); }
  Indicator operator()(const SizeOver& rule) const {
    return mark::larger_than_length(*comm, *mesh, rule.field, rule.ratio, size);
  }
  Indicator operator()(const BulkOf& rule) const {
    RecoveredError error;
    error.squared = mark::scalar_on_cells(*comm, *mesh, rule.field);
    if (comm->any(std::any_of(error.squared.begin(), error.squared.end(), [](double v) { return v < 0; })))
      throw Error("field \"" + rule.field +
                  "\": expected values of at least 0 to take the bulk of, found negative ones");
    return mark::bulk_of_error(*comm, *mesh, error, rule.fraction);
  }
  Indicator operator()(const ErrorOver& rule) const {
    auto found = known->find(rule.field);
    if (found == known->end())
      found = known->emplace(rule.field, mark::recovered_error(*comm, *mesh, rule.field)).first;
    const auto& error = found->second;
    if (rule.bar == ErrorOver::Bar::bulk) return mark::bulk_of_error(*comm, *mesh, error, rule.value);
    const double theta = rule.bar == ErrorOver::Bar::target ? rule.value * rule.value : rule.value;
    return mark::above_mean_share(error, mesh->info.n_global_cells, theta);
  }
};

/// Cells that are wanted are not coarsened.
void keep_where(const Indicator& wish, std::vector<std::uint8_t>& may_go) {
  for (std::size_t c = 0; c < wish.size(); ++c)
    if (wish[c] > 0) may_go[c] = 0;
}

}  // namespace

Applied apply(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request) {
  KnownErrors known;
  return apply(comm, mesh, request, known);
}

Applied apply(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request, KnownErrors& known) {
  Applied result;
  assign_array(result.indicator, mesh.cell_to_node.size(), 0.0);
  assign_array(result.may_go, mesh.cell_to_node.size(), static_cast<std::uint8_t>(request.coarsens() ? 1 : 0));
  const Evaluate evaluate{&comm, &mesh, request.size, &known};
  for (const auto& criterion : request.criteria) {
    const auto wish = std::visit(evaluate, criterion.rule);
    if (request.coarsens())
      keep_where(
          criterion.coarsen_below ? std::visit(evaluate, with_value(criterion, *criterion.coarsen_below).rule) : wish,
          result.may_go);
    result.cells_of_criterion.push_back(mark::count_marked(comm, mark::marks_of(wish)));
    mark::unite(result.indicator, wish);
  }
  for (const auto& limit : request.only_where) mark::keep_only_where(comm, mesh, limit, result.indicator);
  for (std::size_t c = 0; c < result.may_go.size(); ++c)
    if (mesh.lineage[c].level() <= request.min_level) result.may_go[c] = 0;
  if (request.max_level) mark::keep_below_level(mesh, *request.max_level, result.indicator);
  return result;
}

}  // namespace pamr::mark
