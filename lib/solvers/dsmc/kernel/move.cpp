// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/move.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/timer.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::uint32_t max_events = 100000;
constexpr std::int64_t stall_limit = 64;  ///< faces passed without a look at the progress, or without progress

enum class End : std::uint8_t { rests, rests_abroad, leaves_halo, leaves_domain };

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
  Mover(const MoveRules& rules, std::uint64_t step, BorderExchange& border, SurfaceTally& tally)
      : domain_(rules.domain),
        gas_(rules.gas),
        patch_(rules.patch),
        seed_(rules.seed),
        step_(step),
        border_(&border),
        tally_(&tally) {}

  End fly(Flight& flight) { return fly(flight, outside_at_end(flight)); }
  /// `out`: faces of the particle's cell outside of which the flight ends.
  End fly(Flight& flight, unsigned out);
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
  bool goes_across(Vec3& position, LocalId& link) const;
  bool meets_boundary(Flight& flight, std::size_t face, double time);
  void note_hit(std::size_t face, Vec3 momentum, double energy);

  const GasDomain* domain_;
  const Gas* gas_;
  std::span<const BoundaryCondition> patch_;
  std::uint64_t seed_, step_;
  BorderExchange* border_;
  SurfaceTally* tally_;
};

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

/// A flight meets a boundary face. Of a periodic patch: shifts the place that its line began at, and `link` becomes
/// where it goes on; else false.
bool Mover::goes_across(Vec3& position, LocalId& link) const {
  if (domain_->shift.empty()) return false;
  const auto& face = domain_->boundary_face(at(-link - 1));
  if (face.across < 0) return false;
  position = position + domain_->shift[at(face.patch)];
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
bool Mover::meets_boundary(Flight& flight, std::size_t number, double time) {
  const auto& face = domain_->boundary_face(number);
  const auto& condition = patch_[at(face.patch)];
  if (condition.is_open()) return false;
  auto& p = flight.particle;
  time = std::clamp(time, 0.0, flight.time);
  p.position = p.position + time * p.velocity;
  flight.time -= time;
  flight.passed = 0;
  flight.excluded_face = 1U << face.slot;
  const auto& species = gas_->species[p.species];
  Random random(seed_, Purpose::wall, p.id, step_, 8 * flight.events);
  ++flight.events;
  const auto out = reflect(condition, species, face.normal, {p.velocity, p.rotation}, random);
  if (condition.is_wall()) {
    // Seen from the wall: what a moving wall works is no heat.
    const double energy =
        0.5 * species.mass *
        (squared_norm(p.velocity - condition.velocity) - squared_norm(out.velocity - condition.velocity));
    note_hit(number, (species.weight * species.mass) * (p.velocity - out.velocity),
             species.weight * (energy + (p.rotation - out.rotation)));
  }
  p.velocity = out.velocity;
  p.rotation = out.rotation;
  return true;
}

End Mover::fly(Flight& flight, unsigned out) {
  auto& p = flight.particle;
  std::int64_t passed_faces = 0, without_progress = 0;
  for (;; out = outside_at_end(flight)) {
    const auto c = at(p.cell);
    const auto& planes = domain_->planes[c];
    out &= ~flight.excluded_face;
    Exit exit;
    if (out != 0) exit = first_exit(planes, flight, out);
    if (exit.slot < 0) {
      p.position = p.position + flight.time * p.velocity;
      break;
    }
    if (passed_faces > stall_limit) {
      without_progress = exit.time > flight.passed ? 0 : without_progress + 1;
      if (without_progress > stall_limit) exit = drawn_exit(planes, flight, out, without_progress);
      flight.passed = std::max(flight.passed, exit.time);
    }
    auto link = domain_->link[c][at(exit.slot)];
    if (link < 0 && !goes_across(p.position, link)) {
      if (!meets_boundary(flight, static_cast<std::size_t>(-link - 1), exit.time)) return End::leaves_domain;
      if (flight.events < max_events) continue;
      ++counts.stuck;
      break;
    }
    ++passed_faces;
    ++counts.crossings;
    flight.excluded_face = 0;
    if (!domain_->uniform_dt) flight.passed = std::clamp(exit.time, flight.passed, flight.time);
    if (at(link) >= domain_->planes.size()) {
      flight.dt_from = domain_->dt[c];
      p.cell = link;
      return End::leaves_halo;
    }
    if (!domain_->uniform_dt)
      flight.time = flight.passed + (flight.time - flight.passed) * (domain_->dt[at(link)] / domain_->dt[c]);
    p.cell = link;
  }
  counts.longest = std::max(counts.longest, passed_faces);
  return p.cell < domain_->n_cells() ? End::rests : End::rests_abroad;
}

void fly_all(Mover& mover, std::vector<Flight>& flights, Particles& particles, BorderExchange& border) {
  for (auto& flight : flights) switch (mover.fly(flight)) {
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
    }
  flights.clear();
}

/// The particles that are here already; most stay in their cell.
void fly_own(Mover& mover, const GasDomain& domain, Particles& particles, BorderExchange& border) {
  const auto n = particles.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto cell = particles.cell[i];
    const auto c = at(cell);
    const double dt = domain.dt[c];
    const Vec3 end = particles.position(i) + dt * particles.velocity(i);
    const unsigned out = outside(domain.planes[c], end);
    if (out == 0) {
      particles.x[i] = end.x;
      particles.y[i] = end.y;
      particles.z[i] = end.z;
      continue;
    }
    Flight flight;
    flight.particle = particles.get(i);
    flight.time = dt;
    const auto how = mover.fly(flight, out);
    const auto& p = flight.particle;
    if (how == End::rests) {
      particles.x[i] = p.position.x;
      particles.y[i] = p.position.y;
      particles.z[i] = p.position.z;
      particles.cell[i] = p.cell;
      if (flight.events == 0) continue;
      particles.u[i] = p.velocity.x;
      particles.v[i] = p.velocity.y;
      particles.w[i] = p.velocity.z;
      particles.rotation[i] = p.rotation;
    } else {
      particles.cell[i] = Particles::gone;
      if (how == End::rests_abroad)
        border.add(flight.particle);
      else if (how == End::leaves_halo)
        border.add(flight);
      else
        ++mover.counts.left;
    }
  }
}

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

MoveCounts move(const par::Comm& comm, const MoveRules& rules, std::uint64_t step, Particles& particles,
                std::vector<Flight>& entering, BorderExchange& border, SurfaceTally& tally) {
  Mover mover(rules, step, border, tally);
  double start = cpu_seconds();
  fly_own(mover, *rules.domain, particles, border);
  fly_all(mover, entering, particles, border);
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
    fly_all(mover, arrived.flying, particles, border);
    mover.counts.compute_seconds += cpu_seconds() - start;
  }
  return mover.counts;
}

}  // namespace pamr::dsmc
