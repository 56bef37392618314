// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/forecast.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>

#include "pamr/adapt/depth.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/level0.hpp"
#include "pamr/adapt/part/put_back.hpp"
#include "pamr/adapt/part/split_early.hpp"
#include "pamr/adapt/pass.hpp"
#include "pamr/adapt/take_back.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::adapt {

namespace {

/// For each patch whether new nodes on it will be moved: not if it has no surface or a flat one.
std::vector<bool> curved_patches(const mesh::DistMesh& mesh, const refine::Options& options) {
  std::vector<bool> is_curved(mesh.info.patches.size(), false);
  if (!options.project) return is_curved;
  for (std::size_t p = 0; p < is_curved.size(); ++p)
    if (const auto* surface = mesh.info.surface_of(static_cast<int>(p))) is_curved[p] = !surface->is_flat();
  return is_curved;
}

/// Empty where the mesh is split as it is. Collective.
std::shared_ptr<const mesh::DistMesh> ready_copy(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                 const refine::Options& options) {
  auto ready = with_level0_map(comm, mesh, options);
  if (ready.mesh.is_lent()) return nullptr;
  return std::make_shared<const mesh::DistMesh>(std::move(ready.mesh).take());
}

std::vector<std::uint8_t> sum_of_origins(const std::vector<std::uint8_t>& counts, const std::vector<LocalId>& from,
                                         std::size_t n_origins) {
  std::vector<std::uint8_t> sum(n_origins, 0);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    auto& cells = sum[at(from[c])];
    cells = static_cast<std::uint8_t>(std::min(cells + counts[c], 255));
  }
  return sum;
}

/// A mesh without fields, but for those that splits look at: which nodes lie off their surfaces, where they lie in level 0,
/// which faces inside have a patch.
mesh::DistMesh bare_copy(const mesh::DistMesh& mesh) {
  auto copy = copy_without_fields(mesh, 0, 0);
  for (const auto& field : mesh.node_fields)
    if (field.name == mesh::off_surface_field || field.name == mesh::off_facets_field ||
        field.name == mesh::level0_key_field)
      copy.node_fields.push_back(field);
  for (const auto* name : {mesh::level0_cell_field, mesh::inner_patch_field})
    if (const auto* field = mesh.find_cell_field(name)) copy.cell_fields.push_back(*field);
  return copy;
}

/// What is split.
struct Trial {
  std::shared_ptr<const mesh::DistMesh> made;  ///< a mesh of its own; empty: `mesh` is the caller's
  const mesh::DistMesh& mesh;
  const mesh::Borders& borders;
  std::vector<std::uint8_t> flags;
  std::optional<refine::Closure> closure;  ///< if it is known
};

/// Collective.
Forecast count(const par::Comm& comm, Trial trial, const refine::Options& options) {
  const auto& mesh = trial.mesh;
  const auto limited = limit_depth(mesh, trial.flags);
  auto requests = refine::requests_of_flags(limited.flags);
  Forecast forecast;
  forecast.mesh = trial.made;
  forecast.closure =
      trial.closure ? *std::move(trial.closure) : refine::close(comm, mesh, trial.borders, {requests}, options);
  forecast.report = forecast.closure.report;
  std::vector<LocalId> from;  // this rank's cell that each cell of `forecast.mesh` came from
  if (forecast.closure.has_early) {
    StepTimer timer;
    auto closed = open_pass(comm, mesh, trial.borders, options);
    closed.requests = std::move(requests);
    closed.closure = std::move(forecast.closure);
    closed = split_early(comm, std::move(closed), options, timer);
    forecast.closure = std::move(closed.closure);
    forecast.report = forecast.closure.report;
    from = std::move(closed.input_cell);
    forecast.mesh = std::make_shared<const mesh::DistMesh>(std::move(closed.mesh).take());
  } else {
    refine::find_states(mesh, options, forecast.closure);
    require_depth(comm, mesh, forecast.closure);
  }
  const auto counts = refine::count_children(forecast.closure);
  forecast.cells_on_this_rank = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  forecast.children = from.empty() ? counts : sum_of_origins(counts, from, at(mesh.n_cells()));
  std::array<std::int64_t, 2> sums{forecast.cells_on_this_rank, limited.n_left_out};
  comm.sum_in_place(sums);
  forecast.cells = sums[0];
  forecast.marked_too_deep = sums[1];
  return forecast;
}

}  // namespace

Forecaster::Forecaster(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Options& options)
    : comm_(&comm),
      ready_(ready_copy(comm, mesh, options)),
      mesh_(ready_ ? ready_.get() : &mesh),
      options_(options),
      borders_(mesh::find_borders(comm, *mesh_)),
      is_curved_(curved_patches(*mesh_, options)) {}

Forecast Forecaster::forecast(std::span<const std::uint8_t> flags) const { return forecast(signed_flags(flags)); }

Forecast Forecaster::forecast(std::span<const std::int8_t> flags) const {
  auto signs = checked_signs(*comm_, *mesh_, flags, options_);
  if (comm_->any(has_sign(signs, -1))) return after_taking_back(std::move(signs));
  return count(*comm_, {{}, *mesh_, borders_, splits_of(signs), {}}, options_);
}

Forecast Forecaster::after_taking_back(std::vector<std::int8_t> signs) const {
  std::shared_ptr<const mesh::DistMesh> gathered;
  mesh::Borders found;
  const auto gathering = find_gathering(*comm_, *mesh_, signs);
  if (gathering.cells_moved > 0) {
    gathered = std::make_shared<const mesh::DistMesh>(gather(*comm_, bare_copy(*mesh_), gathering, signs));
    found = mesh::find_borders(*comm_, *gathered);
  }
  const auto& mesh = gathered ? *gathered : *mesh_;
  const auto& borders = gathered ? found : borders_;
  StepTimer timer;
  auto coarse = make_coarse_mesh(*comm_, {mesh, borders, signs}, options_, timer);
  Forecast forecast;
  if (coarse.made) {
    std::optional<refine::Closure> closure;
    if (coarse.closure) {
      found = std::move(coarse.closure->borders);
      closure = std::move(coarse.closure->closure);
      if (closure->has_early) carry_fields(*comm_, mesh, options_, coarse);
    } else {
      found = mesh::find_borders(*comm_, coarse.made->mesh);
    }
    const auto made = std::make_shared<const mesh::DistMesh>(std::move(coarse.made->mesh));
    forecast = count(*comm_, {made, *made, found, std::move(coarse.made->flags), std::move(closure)}, options_);
  } else {
    forecast = count(*comm_, {gathered, mesh, borders, splits_of(signs), {}}, options_);
  }
  forecast.children.clear();
  forecast.coarsening = coarse.report;
  forecast.coarsening.cells_moved = gathering.cells_moved;
  return forecast;
}

std::int64_t Forecaster::nodes(const Forecast& forecast) const {
  if (forecast.mesh == nullptr) return refine::number(*comm_, *mesh_, borders_, forecast.closure).n_global_nodes;
  const auto borders = mesh::find_borders(*comm_, *forecast.mesh);
  return refine::number(*comm_, *forecast.mesh, borders, forecast.closure).n_global_nodes;
}

/// The number of children, two more where a cell is closed (its edges are walked for few children), and five quarters
/// more at a curved wall, where nodes are moved and what moves with them is smoothed and checked.
/// Source: processor times of 64 ranks of bench/scaling.sh, fitted.
std::vector<std::uint8_t> Forecaster::work(const Forecast& forecast) const {
  std::vector<std::uint8_t> work(forecast.children.size());
  for (std::size_t c = 0; c < work.size(); ++c) {
    const int children = forecast.children[c];
    const auto& slots = mesh_->cell_to_cell[c];
    const bool at_wall = children > 1 && std::any_of(slots.begin(), slots.end(), [&](LocalId slot) {
                           return slot < 0 && is_curved_[at(mesh::slot_to_patch(slot))];
                         });
    const bool is_closed = children > 1 && children < refine::max_children;
    work[c] = static_cast<std::uint8_t>(
        std::clamp(children + (is_closed ? 2 : 0) + (at_wall ? 5 * children / 4 : 0), 1, 255));
  }
  return work;
}

}  // namespace pamr::adapt
