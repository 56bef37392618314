// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/move.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/base/timer.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::uint32_t max_events = 100000;
constexpr std::int64_t stall_limit = 64;  ///< faces passed without a look at the progress, or without progress

enum class End : std::uint8_t { flies, rests, rests_abroad, leaves_halo, leaves_domain };

/// A flight's way in this step.
struct Path {
  static constexpr auto no_row = std::numeric_limits<std::size_t>::max();
  std::int64_t faces = 0;             ///< passed
  std::int64_t without_progress = 0;  ///< the last ones of them
  std::size_t row =
      no_row;  ///< of the particle in `Particles`, from where only place, velocity and cell were taken yet
};

/// Bits of the faces outside of which the point lies.
inline unsigned outside(const CellPlanes& p, Vec3 point) {
  unsigned bits = 0;
  for (std::size_t f = 0; f < 4; ++f)
    bits |= static_cast<unsigned>(p.nx[f] * point.x + p.ny[f] * point.y + p.nz[f] * point.z > p.d[f]) << f;
  return bits;
}

/// Moves one particle at a time.
class Mover {
 public:
  Mover(const MoveRules& rules, const Particles& particles, const MoveTargets& targets)
      : domain_(rules.domain),
        particles_(&particles),
        gas_(rules.gas),
        patch_(rules.patch),
        seed_(rules.seed),
        step_(rules.step),
        border_(&targets.border),
        tally_(&targets.tally),
        flux_(targets.flux),
        planes_(targets.flux == nullptr ? nullptr : rules.planes) {}

  /// To the end of the flight.
  End fly(Flight& flight, Path& path) {
    for (;;)
      if (const End how = pass_face(flight, outside_at_end(flight), path); how != End::flies) return how;
  }
  /// To the next face. `out`: faces of the particle's cell outside of which the flight ends.
  End pass_face(Flight& flight, unsigned out, Path& path);
  /// Takes the rest of a particle from its row. Most flights end without a need for it.
  void complete(Particle& particle, Path& path) const;
  bool has_planes() const { return planes_ != nullptr; }
  /// Whether a particle that stays in this own cell may pass one.
  bool has_planes(LocalId cell) const { return planes_ != nullptr && planes_->cuts_cell[at(cell)] != 0; }
  /// Counts the planes between the begin of the flight's line and `end`.
  void pass_planes(const Flight& flight, const Path& path, Vec3 end) const;
  MoveCounts counts;

 private:
  struct Exit {
    int slot = -1;
    double time = 0;
  };
  unsigned outside_at_end(const Flight& flight) const {
    const auto& p = flight.particle;
    return outside(domain_->planes[at(p.cell)], p.position + flight.time * p.velocity);
  }
  Exit first_exit(const CellPlanes& planes, const Flight& flight, unsigned out) const;
  Exit drawn_exit(const CellPlanes& planes, const Flight& flight, unsigned out, std::int64_t turn) const;
  End come_to_rest(const Flight& flight, const Path& path);
  bool goes_across(Flight& flight, const Path& path, LocalId& link, double time) const;
  bool meets_boundary(Flight& flight, Path& path, std::size_t face, double time);
  void note_hit(std::size_t face, Vec3 momentum, double energy);
  void count(std::size_t surface, FluxTally::Way way, const Particle& particle, const Path& path) const;

  const GasDomain* domain_;
  const Particles* particles_;
  const Gas* gas_;
  std::span<const BoundaryCondition> patch_;
  std::uint64_t seed_, step_;
  BorderExchange* border_;
  SurfaceTally* tally_;
  FluxTally* flux_;           ///< null: not counted
  const FluxPlanes* planes_;  ///< null: none
};

void Mover::complete(Particle& particle, Path& path) const {
  if (path.row == Path::no_row) return;
  particle.rotation = particles_->rotation[path.row];
  particle.id = particles_->id[path.row];
  particle.species = particles_->species[path.row];
  particle.partner = particles_->partner[path.row];
  particle.levels = particles_->levels_of(path.row);
  path.row = Path::no_row;
}

/// The face of `out` that the flight passes first; none when it moves outwards through none of them.
Mover::Exit Mover::first_exit(const CellPlanes& planes, const Flight& flight, unsigned out) const {
  Exit best;
  const auto& p = flight.particle;
  for (; out != 0; out &= out - 1) {
    const int slot = std::countr_zero(out);
    const double speed = dot(planes.normal(slot), p.velocity);
    if (!(speed > 0)) continue;
    const double time = planes.depth(slot, p.position) / speed;
    if (best.slot < 0 || time < best.time) best = {slot, time};
  }
  return best;
}

/// A face of `out` drawn among those that the flight has passed already: a random walk in the mesh towards the end of
/// the flight, which unlike a walk by fixed rules cannot go round in circles for ever.
Mover::Exit Mover::drawn_exit(const CellPlanes& planes, const Flight& flight, unsigned out, std::int64_t turn) const {
  Exit exit = first_exit(planes, flight, out);
  std::uint64_t n = 0;
  for (; out != 0; out &= out - 1) {
    const auto one = first_exit(planes, flight, out & (~out + 1));
    if (one.slot < 0 || one.time > flight.passed) continue;
    ++n;
    if (combine(flight.particle.id, static_cast<std::uint64_t>(turn) * 4 + n) % n == 0) exit = one;
  }
  return exit;
}

/// Adds the particle as it is now to what has passed a patch or, behind the patches, a plane.
void Mover::count(std::size_t surface, FluxTally::Way way, const Particle& particle, const Path& path) const {
  if (flux_ == nullptr) return;
  auto [p, of] = std::pair(particle, path);
  complete(p, of);
  flux_->add(surface, way, p.species, p.velocity, internal_energy(gas_->species[p.species], p.rotation, p.levels));
}

void Mover::pass_planes(const Flight& flight, const Path& path, Vec3 end) const {
  const auto& p = flight.particle;
  const Vec3 begin = flight.begun > 0 ? p.position + flight.begun * p.velocity : p.position;
  for (std::size_t k = 0; k < planes_->plane.size(); ++k)
    if (const int way = planes_->plane[k].crossing(begin, end); way != 0)
      count(patch_.size() + k, way > 0 ? FluxTally::Way::out : FluxTally::Way::in, p, path);
}

/// A flight meets a boundary face after `time`. Of a periodic patch: shifts the place that its line began at, and
/// `link` becomes where it goes on; else false.
bool Mover::goes_across(Flight& flight, const Path& path, LocalId& link, double time) const {
  if (domain_->shift.empty()) return false;
  const auto& face = domain_->boundary_face(at(-link - 1));
  if (face.across < 0) return false;
  auto& p = flight.particle;
  count(at(face.patch), FluxTally::Way::out, p, path);
  count(at(patch_[at(face.patch)].partner), FluxTally::Way::in, p, path);
  if (has_planes()) {
    time = std::clamp(time, flight.begun, flight.time);
    pass_planes(flight, path, p.position + time * p.velocity);
    flight.begun = time;
  }
  p.position = p.position + domain_->shift[at(face.patch)];
  link = face.across;
  return true;
}

/// Adds to a face; what is given to those of other ranks goes by the border.
void Mover::note_hit(std::size_t face, Vec3 momentum, double energy) {
  const auto n_own = domain_->boundary.size();
  if (face >= n_own) {
    border_->add_hit(face - n_own, *tally_, momentum, energy);
    return;
  }
  ++counts.wall_hits;
  tally_->add(face, momentum, energy);
}

/// The particle reaches a boundary face after `time`; false when it leaves the domain.
bool Mover::meets_boundary(Flight& flight, Path& path, std::size_t number, double time) {
  const auto& face = domain_->boundary_face(number);
  const auto& condition = patch_[at(face.patch)];
  auto& p = flight.particle;
  time = std::clamp(time, 0.0, flight.time);
  const Vec3 place = p.position + time * p.velocity;
  if (has_planes()) pass_planes(flight, path, place);
  count(at(face.patch), FluxTally::Way::out, p, path);
  if (condition.is_open()) return false;
  complete(p, path);
  p.position = place;
  flight.time -= time;
  flight.passed = 0;
  flight.begun = 0;
  flight.excluded_face = 1U << face.slot;
  const auto& species = gas_->species[p.species];
  Random random(seed_, Purpose::wall, p.id, step_, 8 * flight.events);
  ++flight.events;
  const Motion in{p.velocity, p.rotation, p.levels};
  const auto out = reflect(condition, species, face.normal, in, random);
  if (condition.is_wall()) {
    // Seen from the wall: what a moving wall works is no heat.
    const auto squared = [&](const Motion& m) { return squared_norm(m.velocity - condition.velocity); };
    const double energy = 0.5 * species.mass * (squared(in) - squared(out));
    note_hit(number, (species.weight * species.mass) * (in.velocity - out.velocity),
             species.weight * (energy + (internal_energy(species, in) - internal_energy(species, out))));
  }
  p.velocity = out.velocity;
  p.rotation = out.rotation, p.levels = out.levels;
  count(at(face.patch), FluxTally::Way::in, p, path);
  return true;
}

End Mover::come_to_rest(const Flight& flight, const Path& path) {
  counts.longest = std::max(counts.longest, path.faces);
  return flight.particle.cell < domain_->n_cells() ? End::rests : End::rests_abroad;
}

End Mover::pass_face(Flight& flight, unsigned out, Path& path) {
  auto& p = flight.particle;
  const auto c = at(p.cell);
  const auto& planes = domain_->planes[c];
  out &= ~flight.excluded_face;
  Exit exit;
  if (out != 0) exit = first_exit(planes, flight, out);
  if (exit.slot < 0) {
    const Vec3 end = p.position + flight.time * p.velocity;
    if (has_planes()) pass_planes(flight, path, end);
    p.position = end;
    return come_to_rest(flight, path);
  }
  if (path.faces > stall_limit) {
    path.without_progress = exit.time > flight.passed ? 0 : path.without_progress + 1;
    if (path.without_progress > stall_limit) {
      complete(p, path);
      exit = drawn_exit(planes, flight, out, path.without_progress);
    }
    flight.passed = std::max(flight.passed, exit.time);
  }
  auto link = domain_->link[c][at(exit.slot)];
  if (link < 0 && !goes_across(flight, path, link, exit.time)) {
    if (!meets_boundary(flight, path, static_cast<std::size_t>(-link - 1), exit.time)) return End::leaves_domain;
    if (flight.events < max_events) return End::flies;
    ++counts.stuck;
    return come_to_rest(flight, path);
  }
  ++path.faces;
  ++counts.crossings;
  flight.excluded_face = 0;
  if (!domain_->uniform_dt) flight.passed = std::clamp(exit.time, flight.passed, flight.time);
  p.cell = link;
  if (at(link) >= domain_->planes.size()) {
    flight.dt_from = domain_->dt[c];
    return End::leaves_halo;
  }
  if (!domain_->uniform_dt)
    flight.time = flight.passed + (flight.time - flight.passed) * (domain_->dt[at(link)] / domain_->dt[c]);
  return End::flies;
}

void fly_arrivals(Mover& mover, std::vector<Flight>& flights, Particles& particles, BorderExchange& border) {
  for (auto& flight : flights) {
    Path path;
    switch (mover.fly(flight, path)) {
      case End::rests:
        particles.append(flight.particle);
        break;
      case End::rests_abroad:
        border.add(flight.particle);
        break;
      case End::leaves_halo:
        border.add(flight);
        break;
      case End::leaves_domain:
        ++mover.counts.left;
        break;
      case End::flies:  // no end of `fly`
        break;
    }
  }
  flights.clear();
}

/// Flies the particles that are here already, those that stay in their cell first, many at a time: they need no more
/// than its four planes. The others follow in groups: each passes one face, while what the ones before need behind
/// theirs comes from memory; then those that end there are moved, and the few that are left fly on one by one.
class OwnFlights {
 public:
  OwnFlights(Mover& mover, const GasDomain& domain, Particles& particles, BorderExchange& border)
      : mover_(&mover), domain_(&domain), particles_(&particles), border_(&border) {}

  void fly_all() {
    const auto n = particles_->size();
    for (std::size_t i = 0; i < n;) {
      const auto cell = particles_->cell[i];
      auto end = i + 1;
      while (end < n && end < i + n_block && particles_->cell[end] == cell) ++end;
      fly_within(cell, i, end);
      i = end;
    }
    fly_leaving();
  }

 private:
  static constexpr std::size_t n_block = 64;
  struct Leaving {
    Vec3 position;  ///< that it flies from
    std::size_t row = 0;
    unsigned out = 0;
  };
  struct OnItsWay {
    Flight flight;
    Path path;
    End how = End::flies;
  };

  /// Particles `begin` to `end` of a cell, at most a block of them: those that stay in it are moved.
  void fly_within(LocalId cell, std::size_t begin, std::size_t end) {
    const auto& planes = domain_->planes[at(cell)];
    const double dt = domain_->dt[at(cell)];
    const auto n = end - begin;
    double* const x = particles_->x.data() + begin;
    double* const y = particles_->y.data() + begin;
    double* const z = particles_->z.data() + begin;
    const double* const u = particles_->u.data() + begin;
    const double* const v = particles_->v.data() + begin;
    const double* const w = particles_->w.data() + begin;
    for (std::size_t k = 0; k < n; ++k) {
      to_x_[k] = x[k] + dt * u[k];
      to_y_[k] = y[k] + dt * v[k];
      to_z_[k] = z[k] + dt * w[k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      std::int64_t bits = 0;
      for (std::size_t f = 0; f < 4; ++f)
        bits |= planes.nx[f] * to_x_[k] + planes.ny[f] * to_y_[k] + planes.nz[f] * to_z_[k] > planes.d[f]
                    ? std::int64_t{1} << f
                    : std::int64_t{0};
      out_[k] = bits;
    }
    if (mover_->has_planes(cell)) pass_planes_within(begin, n);
    for (std::size_t k = 0; k < n; ++k) {  // without a branch, which nobody could foretell
      leaving_[n_leaving_] = {{x[k], y[k], z[k]}, begin + k, static_cast<unsigned>(out_[k])};
      n_leaving_ += out_[k] != 0 ? 1U : 0U;
    }
    std::copy_n(to_x_.begin(), n, x);
    std::copy_n(to_y_.begin(), n, y);
    std::copy_n(to_z_.begin(), n, z);
    if (n_leaving_ >= n_block) fly_leaving();
  }

  /// Of those of the block that stay in the cell, before they are moved.
  void pass_planes_within(std::size_t begin, std::size_t n) const {
    for (std::size_t k = 0; k < n; ++k) {
      if (out_[k] != 0) continue;
      Flight flight;
      flight.particle.position = particles_->position(begin + k);
      flight.particle.velocity = particles_->velocity(begin + k);
      mover_->pass_planes(flight, {0, 0, begin + k}, {to_x_[k], to_y_[k], to_z_[k]});
    }
  }

  void fly_leaving() {
    for (std::size_t begin = 0; begin < n_leaving_; begin += n_block) {
      const auto n = std::min(n_block, n_leaving_ - begin);
      for (std::size_t k = 0; k < n; ++k) pass_first_face(leaving_[begin + k], group_[k]);
      std::size_t n_going_on = 0;
      for (std::size_t k = 0; k < n; ++k) {
        going_on_[n_going_on] = k;
        n_going_on += ends_here(leaving_[begin + k].row, group_[k]) ? 0U : 1U;
      }
      if (n_going_on < n) mover_->counts.longest = std::max<std::int64_t>(mover_->counts.longest, 1);
      for (const auto k : std::span(going_on_).first(n_going_on)) {
        auto& one = group_[k];
        if (one.how == End::flies) one.how = mover_->fly(one.flight, one.path);
        finish(leaving_[begin + k].row, one);
      }
    }
    n_leaving_ = 0;
  }

  void pass_first_face(const Leaving& from, OnItsWay& one) {
    auto& p = one.flight.particle;
    p.position = from.position;
    p.velocity = particles_->velocity(from.row);
    p.cell = particles_->cell[from.row];
    one.flight.time = domain_->dt[at(p.cell)];
    one.flight.passed = 0;
    one.flight.events = 0;
    one.flight.excluded_face = 0;
    one.flight.begun = 0;
    one.path = {0, 0, from.row};
    one.how = mover_->pass_face(one.flight, from.out, one.path);
    if (one.how != End::flies) return;
    const auto cell = at(p.cell);
    prefetch(&domain_->planes[cell].nx);
    prefetch(&domain_->planes[cell].nz);
    prefetch(&domain_->link[cell]);
  }

  /// True where a flight that has passed one face ends in the cell behind it, as most do. Writes its end in any case,
  /// again without a branch: what goes on is written once more.
  bool ends_here(std::size_t row, const OnItsWay& one) {
    const auto& p = one.flight.particle;
    const bool is_plain = one.how == End::flies && one.flight.events == 0 && p.cell < domain_->n_cells();
    const auto cell = is_plain ? p.cell : 0;
    const Vec3 end = p.position + one.flight.time * p.velocity;
    particles_->x[row] = end.x;
    particles_->y[row] = end.y;
    particles_->z[row] = end.z;
    particles_->cell[row] = cell;
    const bool is_here = is_plain && outside(domain_->planes[at(cell)], end) == 0;
    if (mover_->has_planes() && is_here) mover_->pass_planes(one.flight, one.path, end);
    return is_here;
  }

  void finish(std::size_t row, OnItsWay& one) {
    auto& to = *particles_;
    auto& p = one.flight.particle;
    if (one.how == End::rests) {
      to.x[row] = p.position.x;
      to.y[row] = p.position.y;
      to.z[row] = p.position.z;
      to.cell[row] = p.cell;
      if (one.flight.events == 0) return;
      to.u[row] = p.velocity.x, to.v[row] = p.velocity.y, to.w[row] = p.velocity.z;
      to.rotation[row] = p.rotation;
      if (to.vibrate()) to.levels[row] = p.levels;
      return;
    }
    to.cell[row] = Particles::gone;
    if (one.how == End::leaves_domain) {
      ++mover_->counts.left;
      return;
    }
    mover_->complete(p, one.path);
    if (one.how == End::rests_abroad)
      border_->add(p);
    else
      border_->add(one.flight);
  }

  Mover* mover_;
  const GasDomain* domain_;
  Particles* particles_;
  BorderExchange* border_;
  std::array<double, n_block> to_x_{}, to_y_{}, to_z_{};  ///< where they end
  std::array<std::int64_t, n_block> out_{};               ///< faces of the cell outside of which that is
  std::array<Leaving, 2 * n_block> leaving_;
  std::size_t n_leaving_ = 0;
  std::array<OnItsWay, n_block> group_;
  std::array<std::size_t, n_block> going_on_{};
};

}  // namespace

void MoveCounts::add(const MoveCounts& other) {
  crossings += other.crossings;
  wall_hits += other.wall_hits;
  left += other.left;
  sent += other.sent;
  stuck += other.stuck;
  compute_seconds += other.compute_seconds;
  longest = std::max(longest, other.longest);
}

MoveCounts move(const par::Comm& comm, const MoveRules& rules, Particles& particles, std::vector<Flight>& entering,
                const MoveTargets& targets) {
  auto& border = targets.border;
  auto& tally = targets.tally;
  Mover mover(rules, particles, targets);
  double start = cpu_seconds();
  OwnFlights(mover, *rules.domain, particles, border).fly_all();
  fly_arrivals(mover, entering, particles, border);
  mover.counts.compute_seconds = cpu_seconds() - start;
  if (comm.size() == 1) return mover.counts;
  // Something leaves some rank in almost every step: to ask beforehand costs more than to deliver.
  for (int round = 0; round == 0 || comm.any(!border.is_empty()); ++round) {
    auto arrived = border.deliver(comm, round);
    start = cpu_seconds();
    mover.counts.sent += static_cast<std::int64_t>(arrived.resting.size() + arrived.flying.size());
    for (const auto& particle : arrived.resting) particles.append(particle);
    for (const auto& [face, sums] : arrived.hits) {
      mover.counts.wall_hits += sums.hits;
      tally.face[static_cast<std::size_t>(face)].add(sums);
    }
    fly_arrivals(mover, arrived.flying, particles, border);
    mover.counts.compute_seconds += cpu_seconds() - start;
  }
  return mover.counts;
}

}  // namespace pamr::dsmc
