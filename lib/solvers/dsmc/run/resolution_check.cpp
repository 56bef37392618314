// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/resolution_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/run/body_laws.hpp"
#include "solvers/dsmc/run/split_walls.hpp"

namespace pamr::dsmc {

namespace {

/// A run under another setup or on a finer mesh, from the gas of a computation until it has as many averaged steps;
/// none if the observer asked for the end.
std::unique_ptr<Computation> go_on(const Computation& computation, Setup setup, mesh::DistMesh mesh,
                                   const Observer& observer) {
  auto c = computation.the_case();
  const auto& averaging = computation.averaging();
  c.schedule.block = averaging.block_steps();
  c.schedule.sampling = c.schedule.block * static_cast<std::int64_t>(averaging.results().n_blocks);
  c.schedule.stop_error = 0;
  auto run = std::make_unique<Computation>(computation.comm(), c, std::move(setup), std::move(mesh));
  run->transfer_from(computation.snapshot());
  run->keep_cells();
  if (advance(*run, {}, observer).was_stopped) return nullptr;
  run->finish();
  return run;
}

std::uint64_t steps_of(const Computation& run) { return run.flow().steps_done - run.averaging().state().first_step; }

/// Mean distance of the partners in the collisions of these cells, in meters; 0 without collisions. Collective.
double partner_distance(const Flow& flow, const std::vector<std::uint8_t>& cells) {
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c] == 0) continue;
    sums[0].add(flow.collisions[c].separation);
    sums[1].add(static_cast<double>(flow.collisions[c].collisions));
  }
  const auto total = par::reproducible_sums(flow.comm(), sums);
  return total[1] > 0 ? total[0] / total[1] : 0;
}

/// Mean number of particles in these cells as they are now. Collective.
double particles_per_cell(const Flow& flow, const std::vector<std::uint8_t>& cells) {
  std::array<std::int64_t, 2> count{};
  const auto begin = flow.particles.begin();
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c] == 0) continue;
    count[0] += begin[c + 1] - begin[c];
    ++count[1];
  }
  flow.comm().sum_in_place(count);
  return static_cast<double>(count[0]) / static_cast<double>(std::max<std::int64_t>(1, count[1]));
}

/// A coefficient under its name in reports.
struct CoefficientRow {
  const char* name;
  Estimate Results::OfPatch::*estimate;
  double Coefficients::*facets;
  bool is_of_lift;
};
constexpr std::array<CoefficientRow, 4> coefficient_rows{
    {{"C_D", &Results::OfPatch::drag, &Coefficients::drag, false},
     {"C_L", &Results::OfPatch::lift, &Coefficients::lift, true},
     {"C_m", &Results::OfPatch::moment, &Coefficients::moment, true},
     {"C_H", &Results::OfPatch::heat, &Coefficients::heat, false}}};

/// The coefficients with what flat faces add. Collective.
ResolutionCheck check_facets(const Computation& computation) {
  const auto& c = computation.the_case();
  const auto& flow = computation.flow();
  const auto all = computation.averaging().results();
  const auto facets = error_of_facets(computation.comm(), c, flow.setup(), computation.mesh(), flow.domain().boundary);
  ResolutionCheck check;
  for (const auto& row : coefficient_rows)
    if (!row.is_of_lift || c.reference.gives_lift())
      check.coefficients.push_back(
          {row.name, all.body.*row.estimate, student_95(all.groups.n_groups), facets.*row.facets});
  return check;
}

/// The estimate of the coefficient of this name.
const Estimate& estimate_of(const Results& results, const std::string& name) {
  const auto row = std::find_if(coefficient_rows.begin(), coefficient_rows.end(),
                                [&](const CoefficientRow& one) { return one.name == name; });
  return results.body.*row->estimate;
}

/// The run with a quarter of the particles; adds what comes of it to the check. False if it was stopped. Collective.
bool check_particles(const Computation& computation, double separation, const Observer& observer,
                     ResolutionCheck& check) {
  auto setup = computation.flow().setup();
  setup.fnum *= fewer_particles;
  observer.report("the same with a quarter of the particles:");
  const auto second = go_on(computation, std::move(setup), computation.mesh(), observer);
  if (!second) return false;
  check.fewer = {second->flow().n_particles(), steps_of(*second)};
  const auto results = second->averaging().results();
  for (auto& one : check.coefficients)
    one.fewer = {estimate_of(results, one.name), student_95(results.groups.n_groups), separation};
  return true;
}

/// The run with cells at the walls split; adds what comes of it to the check. False if it was stopped. Collective.
bool check_cells(const Computation& computation, double size, const Observer& observer, ResolutionCheck& check) {
  auto walls = split_walls(computation.comm(), computation.mesh(), computation.flow());
  auto setup = computation.flow().setup();
  setup.cell_dt = std::move(walls.cell_dt);
  SplitRun run{walls.n_split, walls.mesh.info.n_global_cells};
  observer.report(fmt::format("the same with {} cells, the {} at walls split:", run.n_cells, run.n_split));
  const auto second = go_on(computation, std::move(setup), std::move(walls.mesh), observer);
  if (!second) return false;
  run.n_particles = second->flow().n_particles();
  run.n_steps = steps_of(*second);
  run.particles_per_piece = particles_per_cell(second->flow(), walls.comes_from_wall);
  const double before = partner_distance(computation.flow(), walls.is_at_wall);
  const double now = partner_distance(second->flow(), walls.comes_from_wall);
  const bool by_particles = computation.the_case().collisions.partner != CollisionOptions::Partner::any;
  if (by_particles && before > 0 && now > 0) run.distance = now / before;  // else it is the cells that part partners
  const auto results = second->averaging().results();
  for (auto& one : check.coefficients)
    one.split = {estimate_of(results, one.name), student_95(results.groups.n_groups), size, run.distance};
  check.split = run;
  return true;
}

}  // namespace

void require_checkable(const Case& c, bool cells) {
  if (c.schedule.window > 0)
    throw Error(
        fmt::format("{}: expected no window in [run] beside --check-resolution, which needs averages of a steady "
                    "flow, found window = {}",
                    c.where, c.schedule.window));
  const auto& schedule = c.schedule;
  if (schedule.block > 0 && schedule.sampling < 2 * schedule.block)
    throw Error(
        fmt::format("{}: expected two blocks in [run] at least beside --check-resolution, found sampling = {} and "
                    "block = {}",
                    c.where, schedule.sampling, schedule.block));
  if (schedule.sampling < 2)
    throw Error(fmt::format("{}: expected sampling of two steps at least in [run] beside --check-resolution, found {}",
                            c.where, schedule.sampling));
  if (!cells) return;
  if (!c.collisions.enabled)
    throw Error(
        fmt::format("{}: expected collisions beside --check-cells, because the size of cells adds no error without "
                    "them, found none",
                    c.where));
  if (!c.partner.empty())
    throw Error(
        fmt::format("{}: expected no periodic patch beside --check-cells, because split faces of it need not match, "
                    "found \"{}\"",
                    c.boundary_at.at(c.partner.begin()->first), c.partner.begin()->first));
}

void require_walls(const Computation& computation) {
  const auto& flow = computation.flow();
  const auto& faces = flow.domain().boundary;
  const bool here = std::any_of(faces.begin(), faces.end(),
                                [&](const BoundaryFace& face) { return flow.setup().patch[at(face.patch)].is_wall(); });
  if (!computation.comm().any(here))
    throw Error(
        fmt::format("{}: expected faces on a wall beside --check-cells, found none", computation.the_case().where));
}

std::optional<ResolutionCheck> check_resolution(const Computation& computation, const CellResolution& resolution,
                                                bool cells, const Observer& observer) {
  require_checkable(computation.the_case(), cells);
  if (computation.averaging().results().groups.n_groups < 2)
    throw Error(
        "--check-resolution: expected two blocks of averages at least, found fewer: use more sampling in [run]");
  if (cells) require_walls(computation);
  auto check = check_facets(computation);
  if (!computation.the_case().collisions.enabled) return check;
  if (!check_particles(computation, resolution.wall_separation, observer, check)) return {};
  if (cells && !check_cells(computation, resolution.wall_cell_size, observer, check)) return {};
  return check;
}

nlohmann::json to_json(const ResolutionCheck& check) {
  nlohmann::json shown = nlohmann::json::object();
  if (check.fewer) shown = {{"particles", check.fewer->n_particles}, {"steps", check.fewer->n_steps}};
  if (check.split)
    shown["cells"] = {{"split", check.split->n_split},
                      {"cells", check.split->n_cells},
                      {"particles", check.split->n_particles},
                      {"steps", check.split->n_steps},
                      {"particles_per_piece", check.split->particles_per_piece},
                      {"partner_distance", check.split->distance}};
  for (const auto& one : check.coefficients) shown[one.name] = to_json(one);
  return shown;
}

std::vector<std::string> describe(const ResolutionCheck& check) {
  std::vector<std::string> lines;
  for (const auto& one : check.coefficients) lines.push_back(describe(one));
  constexpr double few = 5;
  if (check.split && check.split->particles_per_piece < few)
    lines.push_back(
        fmt::format("split cells hold {:.2g} particles, fewer than {:g}: the error of coarse cells may be greater",
                    check.split->particles_per_piece, few));
  return lines;
}

}  // namespace pamr::dsmc
