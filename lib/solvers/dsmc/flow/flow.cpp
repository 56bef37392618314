// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/flow/flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/timer.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/halo.hpp"
#include "solvers/dsmc/kernel/numbering.hpp"
#include "solvers/dsmc/kernel/periodic.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// Hits on walls after which the sums on faces are looked at: of typical ones of the heaviest molecules they add up to
/// less than what `SurfaceTally::is_nearly_full` leaves.
constexpr std::int64_t hits_between_checks = std::int64_t{1} << 14U;

/// Speed that hits on walls are measured by: the fastest stream or wall and some thermal speed.
double typical_speed(const Setup& setup) {
  double speed = 1;
  double lightest = setup.gas.species.front().mass;
  for (const auto& s : setup.gas.species) lightest = std::min(lightest, s.mass);
  for (const auto& s : setup.stream)
    speed = std::max(speed, norm(s.velocity) + 3 * most_probable_speed(s.temperature, lightest));
  for (const auto& p : setup.patch)
    if (p.temperature > 0) speed = std::max(speed, norm(p.velocity) + 3 * most_probable_speed(p.temperature, lightest));
  return speed;
}

double max_temperature(const Setup& setup) {
  double t = 0;
  for (const auto& s : setup.stream) t = std::max(t, s.temperature);
  for (const auto& p : setup.patch) t = std::max(t, p.temperature);
  return t > 0 ? t : 300;
}

/// A point of the tetrahedron, uniformly. Source: C. Rocchini, P. Cignoni, "Generating random points in a tetrahedron",
/// J. Graphics Tools 5 (2000).
Vec3 point_in(const TetPoints& corner, Random& random) {
  double s = random.uniform_fine(), t = random.uniform_fine(), u = random.uniform_fine();
  if (s + t > 1) {
    s = 1 - s;
    t = 1 - t;
  }
  if (t + u > 1) {
    const double old = u;
    u = 1 - s - t;
    t = 1 - old;
  } else if (s + t + u > 1) {
    const double old = u;
    u = s + t + u - 1;
    s = 1 - t - old;
  }
  return corner[0] + s * (corner[1] - corner[0]) + t * (corner[2] - corner[0]) + u * (corner[3] - corner[0]);
}

}  // namespace

Flow::Flow(const par::Comm& comm, const mesh::DistMesh& mesh, Setup setup)
    : comm_(&comm),
      setup_(std::move(setup)),
      domain_(make_gas_domain(mesh, setup_.unit, setup_.dt, setup_.fnum, setup_.inner_wall)),
      collider_(setup_.gas, setup_.collisions, setup_.seed) {
  PAMR_EXPECTS(setup_.patch.size() == setup_.patches_on(mesh).size());
  if (!(setup_.dt > 0) || !(setup_.fnum > 0))
    throw Error(fmt::format("expected a positive time step and weight, found {} s and {} molecules a particle",
                            setup_.dt, setup_.fnum));
  particles = Particles(setup_.gas.is_vibrating);
  join_periodic(comm, mesh, setup_.patch, domain_);
  const auto n = at(mesh.n_cells());
  if (!setup_.cell_dt.empty()) {
    PAMR_EXPECTS(setup_.cell_dt.size() == n);
    domain_.uniform_dt = false;
    domain_.dt = setup_.cell_dt;
    for (std::size_t c = 0; c < n; ++c) domain_.fnum[c] = setup_.fnum * (domain_.dt[c] / setup_.dt);
  }
  collisions = start_collisions(setup_.gas, max_temperature(setup_), setup_.seed, domain_.cell_global);
  surface.face.resize(domain_.boundary.size());
  surface.set_units(setup_.gas.species.front().mass, typical_speed(setup_));
  flux = FluxTally(setup_.gas, setup_.patch.size() + setup_.plane.size(), surface);
  planes_ = place_planes(comm, mesh, setup_.unit, setup_.plane);
  cells.clear(n, setup_.gas);
  add_halo(comm, domain_);
  border_.emplace(domain_);
  add_driven_patches();
  inflow_.emplace(comm, rules(), setup_.stream, driven_);
  particles.sort_by_cell(domain_.n_cells());
}

void Flow::add_driven_patches() {
  for (std::size_t p = 0; p < setup_.patch.size(); ++p) {
    const auto& condition = setup_.patch[p];
    if (!condition.is_driven()) continue;
    const auto stream = static_cast<std::size_t>(std::max(0, condition.stream));
    const DrivenPatch::Kind kind{static_cast<int>(p), condition, setup_.stream[stream]};
    driven_.emplace_back(*comm_, domain_, setup_.gas, kind,
                         DrivenPatch::Scale{surface.momentum_unit, surface.energy_unit, setup_.fnum / setup_.dt});
  }
}

std::vector<double> Flow::driven_means() const {
  std::vector<double> means;
  for (const auto& one : driven_) means.insert(means.end(), one.means().begin(), one.means().end());
  return means;
}

void Flow::set_driven_means(std::span<const double> means) {
  std::size_t n = 0;
  for (const auto& one : driven_) n += one.n_words();
  if (means.size() != n)
    throw Error(fmt::format("checkpoint: expected {} averages at inlets and outlets, found {}", n, means.size()));
  for (auto& one : driven_) {
    one.set_means(means.first(one.n_words()));
    means = means.subspan(one.n_words());
  }
}

void Flow::fill(const mesh::DistMesh& mesh) {
  particles.clear();
  const auto n_species = static_cast<std::uint32_t>(setup_.gas.species.size());
  const auto mean_of = [&](const Stream& stream, std::size_t c, std::uint32_t s) {
    return stream.density * stream.fraction[s] * domain_.volume[c] / fnum_of(c, s);
  };
  double expected = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    if (const auto* stream = setup_.stream_at_start(corners(mesh, setup_.unit, cell)))
      for (std::uint32_t s = 0; s < n_species; ++s) expected += mean_of(*stream, at(cell), s);
  // Below each number is its mean rounded up or down, with a standard deviation of a half at most.
  particles.reserve(
      static_cast<std::size_t>(expected + 2 * std::sqrt(static_cast<double>(n_species) * mesh.n_cells())));
  std::vector<std::int64_t> count(static_cast<std::size_t>(mesh.n_cells()), 0);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto c = at(cell);
    const auto corner = corners(mesh, setup_.unit, cell);
    const auto* stream = setup_.stream_at_start(corner);
    if (stream == nullptr) continue;
    Random random(setup_.seed, Purpose::seed, static_cast<std::uint64_t>(domain_.cell_global[c]), steps_done);
    for (std::uint32_t s = 0; s < n_species; ++s) {
      const auto n = static_cast<std::int64_t>(mean_of(*stream, c, s) + random.uniform_fine());
      for (std::int64_t i = 0; i < n; ++i) {
        auto p = draw_particle(setup_.gas, *stream, s, random);
        p.position = point_in(corner, random);
        p.cell = cell;
        particles.append(p);
      }
      count[c] += n;
    }
  }
  const auto n_global = comm_->sum(static_cast<std::int64_t>(mesh.n_cells()));
  const auto first = number_along_cells(*comm_, n_global, domain_.cell_global, count).first;
  std::size_t next = 0;
  for (std::size_t c = 0; c < count.size(); ++c)
    for (std::int64_t i = 0; i < count[c]; ++i) particles.id[next++] = static_cast<std::uint64_t>(first[c] + i);
  particles.sort_by_cell(domain_.n_cells());
}

StepCounts Flow::step(bool wants_stop) {
  StepCounts counts;
  const auto traffic = comm_->traffic();
  std::vector<Flight> entering;
  std::optional<Error> trouble;  // of this rank: thrown once all ranks know of it
  try {
    for (auto& one : driven_) one.begin_step(flux);
    inflow_->draw(steps_done, entering, &flux, driven_);
  } catch (const Error& error) {
    trouble = error;
  }
  counts.entered = static_cast<std::int64_t>(entering.size());
  const auto before = static_cast<std::int64_t>(particles.size()) + counts.entered;
  counts.moved = move(*comm_, rules(), particles, entering, {*border_, surface, &flux});
  flux.fold_if_many();
  hits_unchecked_ += counts.moved.wall_hits;
  if (hits_unchecked_ >= hits_between_checks && !trouble) {
    hits_unchecked_ = 0;
    if (surface.is_nearly_full())
      trouble =
          Error(fmt::format("step {}: expected fewer molecules on each face of a wall between two blocks of the "
                            "averages, found more than can be added up: use shorter blocks, or a greater weight",
                            steps_done));
  }
  const double start = cpu_seconds();
  particles.sort_by_cell(domain_.n_cells());
  counts.particles = static_cast<std::int64_t>(particles.size());
  counts.collided = collider_.collide(domain_, steps_done, particles, collisions);
  if (sampling_) cells.add(particles, setup_.gas);
  counts.compute_seconds = counts.moved.compute_seconds + cpu_seconds() - start;
  counts.all = add_up(counts, before - counts.moved.left - counts.particles, wants_stop, trouble);
  counts.traffic = comm_->traffic() - traffic;
  ++steps_done;
  return counts;
}

/// All that the ranks have to tell each other after a step, in one reduction: that of the inlets and outlets too.
StepTotals Flow::add_up(const StepCounts& here, std::int64_t missing, bool wants_stop,
                        const std::optional<Error>& trouble) {
  std::vector<std::int64_t> sums{
      here.entered,     here.moved.left,       here.moved.wall_hits, here.collided.collisions, here.moved.crossings,
      here.moved.stuck, here.collided.clamped, wants_stop ? 1 : 0,   trouble ? 1 : 0,          missing};
  const auto n_own = sums.size();
  for (const auto& one : driven_) one.append_words(flux, particles, sums);
  comm_->sum_in_place(sums);
  auto rest = std::span<const std::int64_t>(sums).subspan(n_own);
  for (auto& one : driven_) {
    one.end_step(rest.first(one.n_words()));
    rest = rest.subspan(one.n_words());
  }
  const std::int64_t troubled = sums[8], lost = sums[9];
  if (troubled > 0)
    par::agree(*comm_, [&] {
      if (trouble) throw Error(*trouble);
    });
  lost_ += lost;
  if (lost != 0) throw ContractViolation(fmt::format("{} particles were lost in step {}", lost, steps_done));
  return {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6], sums[7] > 0};
}

void Flow::start_sampling() {
  sampling_ = true;
  cells.clear(static_cast<std::size_t>(domain_.n_cells()), setup_.gas);
  for (auto& cell : collisions) {
    cell.separation = 0;
    cell.collisions = 0;
  }
  std::fill(surface.face.begin(), surface.face.end(), SurfaceTally::Sums{});
}

std::vector<SurfaceTally::Sums> Flow::end_block() {
  cells.end_block();
  return std::exchange(surface.face, std::vector<SurfaceTally::Sums>(surface.face.size()));
}

std::int64_t Flow::n_particles() const { return comm_->sum(static_cast<std::int64_t>(particles.size())); }

}  // namespace pamr::dsmc
