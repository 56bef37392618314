// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/inflow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/machine.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/numbering.hpp"
#include "solvers/dsmc/kernel/vibrate.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::uint64_t step_bits = 25, face_bits = 24, index_bits = 14;
constexpr std::uint64_t max_entering = std::uint64_t{1} << index_bits;

std::uint64_t id_of(std::uint64_t step, std::uint64_t face, std::uint64_t index) {
  return (std::uint64_t{1} << 63U) | (step & ((1U << step_bits) - 1)) << (face_bits + index_bits) | face << index_bits |
         index;
}

/// Speed towards the inside, in units of the most probable one, of a molecule that passes a plane towards which its gas
/// moves with speed ratio s: density proportional to x exp(-(x - s)^2), x > 0. By rejection under a normal density
/// about the mode for s > -1, under a stretched flux density of a gas at rest below.
double passing_speed(double s, Random& random) {
  if (s > -1) {
    const double mode = 0.5 * (s + std::sqrt(s * s + 2));
    // x exp(-(x-s)^2) <= mode exp(-(mode-s)^2) exp(-(x-mode)^2), because ln x lies under its tangent at the mode.
    for (;;) {
      const double x = mode + std::sqrt(0.5) * random.normal_pair().a;
      if (x <= 0) continue;
      const double log_ratio =
          std::log(x / mode) - (x - s) * (x - s) + (mode - s) * (mode - s) + (x - mode) * (x - mode);
      if (std::log(random.uniform()) < log_ratio) return x;
    }
  }
  // x exp(-x^2 + 2 s x) with s <= -1: x exp(2 s x) is a gamma density; accept with exp(-x^2).
  for (;;) {
    const double x = -(std::log(random.uniform()) + std::log(random.uniform())) / (-2 * s);
    if (std::log(random.uniform()) < -x * x) return x;
  }
}

Vec3 point_on(const std::array<Vec3, 3>& corner, Random& random) {
  double a = random.uniform_fine(), b = random.uniform_fine();
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return corner[0] + a * (corner[1] - corner[0]) + b * (corner[2] - corner[0]);
}

}  // namespace

Particle draw_particle(const Gas& gas, const Stream& stream, std::uint32_t species, Random& random) {
  const auto& kind = gas.species[species];
  const double c = std::sqrt(boltzmann * stream.temperature / kind.mass);
  const auto [p, q] = random.normal_pair();
  Particle particle;
  particle.velocity = stream.velocity + c * Vec3{p, q, random.normal_pair().a};
  particle.rotation = boltzmann * stream.rotational_temperature * random.thermal_energy(kind.rotational_degrees);
  particle.levels = thermal_levels(kind.vibration, stream.vibrational_temperature, random);
  particle.species = species;
  return particle;
}

Inflow::Inflow(const par::Comm& comm, const MoveRules& rules, std::span<const Stream> stream,
               std::span<const DrivenPatch> driven)
    : rules_(rules), stream_(stream.begin(), stream.end()) {
  const auto& domain = *rules.domain;
  const GlobalId n_cells = comm.sum(static_cast<std::int64_t>(domain.n_cells()));
  std::vector<std::int64_t> count;
  std::vector<GlobalId> cell;
  for (std::size_t b = 0; b < domain.boundary.size(); ++b) {
    const auto& face = domain.boundary[b];
    if (!rules.patch[at(face.patch)].brings_gas()) continue;
    const auto global = domain.cell_global[at(face.cell)];
    if (cell.empty() || cell.back() != global) {
      cell.push_back(global);
      count.push_back(0);
    }
    ++count.back();
    const auto found =
        std::find_if(driven.begin(), driven.end(), [&](const auto& d) { return d.patch() == face.patch; });
    face_.push_back({b, 0, found == driven.end() ? -1 : static_cast<int>(found - driven.begin()), {}});
  }
  const auto [first, total] = number_along_cells(comm, n_cells, cell, count);
  if (total >= std::int64_t{1} << face_bits)
    throw Error(fmt::format("expected fewer than {} inflow faces, found {}", std::int64_t{1} << face_bits, total));

  std::size_t k = 0;
  GlobalId current = -1;
  std::uint64_t number = 0;
  for (auto& face : face_) {
    const auto& boundary = domain.boundary[face.boundary];
    const auto c = at(boundary.cell);
    if (domain.cell_global[c] != current) {
      current = domain.cell_global[c];
      number = static_cast<std::uint64_t>(first[k++]);
    }
    face.number = number++;
    for (std::size_t s = 0; s < rules.gas->species.size(); ++s) {
      double flux = 1;
      if (face.driven < 0) {
        const auto& flow = stream_[at(rules.patch[at(boundary.patch)].stream)];
        flux = molecular_flux(flow.density * flow.fraction[s], flow.temperature, rules.gas->species[s].mass,
                              -dot(flow.velocity, boundary.normal));
      }
      face.mean.push_back(flux * boundary.area * domain.dt[c] / (domain.fnum[c] * rules.gas->species[s].weight));
    }
  }
  require_feasible(comm, driven);
}

/// Throws `Error` on every rank when the particles of a step cannot be numbered or do not fit into memory.
void Inflow::require_feasible(const par::Comm& comm, std::span<const DrivenPatch> driven) const {
  par::agree(comm, [&] {
    for (const auto& face : face_) {
      double sum = 0;
      for (std::size_t s = 0; s < face.mean.size(); ++s) sum += mean_of(face, s, driven);
      if (!(sum < max_entering + 1.0)) refuse(face);
    }
    const double bytes = expected(driven) * static_cast<double>(sizeof(Flight));
    const auto memory = static_cast<double>(std::min(memory_of_machine(), memory_of_process()));
    if (!(bytes < memory))
      throw Error(
          fmt::format("expected particles that fit into {:.4g} GB of memory, found {:.4g} GB of them in a step "
                      "through the inflow faces of rank {}: use a shorter time step or a greater weight",
                      1e-9 * memory, 1e-9 * bytes, comm.rank()));
  });
}

void Inflow::refuse(const Face& face) const {
  throw Error(
      fmt::format("expected at most {} particles a step through each inflow face, found more on a face "
                  "of the cell {} places after the first: use a shorter time step or a greater weight",
                  max_entering, rules_.domain->cell_global[at(rules_.domain->boundary[face.boundary].cell)]));
}

/// Particles of a species that enter through a face in a step.
double Inflow::mean_of(const Face& face, std::size_t species, std::span<const DrivenPatch> driven) {
  if (face.driven < 0) return face.mean[species];
  return face.mean[species] * driven[at(face.driven)].entering().species[species].rate;
}

double Inflow::expected(std::span<const DrivenPatch> driven) const {
  double sum = 0;
  for (const auto& face : face_)
    for (std::size_t s = 0; s < face.mean.size(); ++s) sum += mean_of(face, s, driven);
  return sum;
}

void Inflow::draw(std::uint64_t step, std::vector<Flight>& entering, FluxTally* flux,
                  std::span<const DrivenPatch> driven) const {
  for (const auto& face : face_) {
    const auto& boundary = rules_.domain->boundary[face.boundary];
    const auto c = at(boundary.cell);
    const auto* gas = face.driven < 0 ? nullptr : &driven[at(face.driven)].entering();
    const auto& flow = gas != nullptr ? gas->gas : stream_[at(rules_.patch[at(boundary.patch)].stream)];
    Random counting(rules_.seed, Purpose::inflow, face.number, step);
    std::uint64_t index = 0;
    for (std::uint32_t s = 0; s < face.mean.size(); ++s) {
      const double mean = mean_of(face, s, driven);
      if (!(mean < max_entering + 1.0)) refuse(face);
      const auto n = static_cast<std::uint64_t>(mean + counting.uniform_fine());
      const double c_m = most_probable_speed(flow.temperature, rules_.gas->species[s].mass);
      const double ratio = (gas != nullptr ? gas->species[s].speed : -dot(flow.velocity, boundary.normal)) / c_m;
      for (std::uint64_t i = 0; i < n; ++i, ++index) {
        if (index >> index_bits != 0) refuse(face);
        const auto id = id_of(step, face.number, index);
        Random random(rules_.seed, Purpose::inflow_particle, id, step);
        Flight flight;
        flight.particle = draw_particle(*rules_.gas, flow, s, random);
        flight.particle.id = id;
        flight.particle.cell = boundary.cell;
        flight.particle.position = point_on(boundary.corner, random);
        auto& v = flight.particle.velocity;
        const double inwards = c_m * passing_speed(ratio, random);
        v = v - (dot(v, boundary.normal) + inwards) * boundary.normal;
        flight.time = rules_.domain->dt[c] * random.uniform_fine();
        entering.push_back(flight);
        if (flux == nullptr) continue;
        const auto& p = flight.particle;
        flux->add(at(boundary.patch), FluxTally::Way::in, s, v,
                  internal_energy(rules_.gas->species[s], p.rotation, p.levels));
      }
    }
  }
}

}  // namespace pamr::dsmc
