// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/loads.hpp"

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::size_t n_parts = 7;  ///< force, moment, heat

/// Adds up `part(face)` over all faces of each patch, without rounding.
template <class Part>
std::vector<Load> add_up(const par::Comm& comm, const std::vector<BoundaryFace>& faces, std::size_t n_patches,
                         Vec3 point, Part part) {
  std::vector<par::ExactSum> sums(n_parts * n_patches);
  for (std::size_t b = 0; b < faces.size(); ++b) {
    const auto& face = faces[b];
    const auto [force, heat] = part(b);
    const Vec3 moment = cross(face.center() - point, force);
    auto* sum = sums.data() + n_parts * static_cast<std::size_t>(face.patch);
    const double row[n_parts] = {force.x, force.y, force.z, moment.x, moment.y, moment.z, heat};
    for (std::size_t k = 0; k < n_parts; ++k) sum[k].add(row[k]);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  std::vector<Load> loads(n_patches);
  for (std::size_t p = 0; p < n_patches; ++p) {
    const double* t = totals.data() + n_parts * p;
    loads[p] = {{t[0], t[1], t[2]}, {t[3], t[4], t[5]}, t[6]};
  }
  return loads;
}

double density_of(const Gas& gas, const Stream& stream) {
  double sum = 0;
  for (std::size_t s = 0; s < gas.species.size(); ++s) sum += stream.fraction[s] * gas.species[s].mass;
  return sum * stream.density;
}

}  // namespace

Load& Load::operator+=(const Load& other) {
  force = force + other.force;
  moment = moment + other.moment;
  heat += other.heat;
  return *this;
}

std::vector<Load> patch_loads(const par::Comm& comm, const GasDomain& domain, const FaceSums& sums, Vec3 point,
                              std::size_t n_patches) {
  const double per_step = sums.fnum_per_time / static_cast<double>(std::max<std::int64_t>(1, sums.n_steps));
  const double momentum = sums.units.momentum_unit * per_step, energy = sums.units.energy_unit * per_step;
  return add_up(comm, domain.boundary, n_patches, point, [&](std::size_t b) {
    const auto& m = sums.face[b].momentum;
    const Vec3 force{static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
    return std::pair<Vec3, double>{momentum * force, energy * static_cast<double>(sums.face[b].energy)};
  });
}

std::vector<Load> integrate_law(const par::Comm& comm, const std::vector<BoundaryFace>& faces, const SurfaceLaw& law,
                                Vec3 point, std::size_t n_patches) {
  return add_up(comm, faces, n_patches, point, [&](std::size_t b) {
    const auto& face = faces[b];
    const auto [stress, heat] = law(face);
    return std::pair<Vec3, double>{face.area * stress, face.area * heat};
  });
}

Scale::Scale(const Gas& gas, const Stream& stream, const Reference& reference) : reference_(reference) {
  speed_ = norm(stream.velocity);
  drag_ = speed_ > 0 ? (1 / speed_) * stream.velocity : Vec3{1, 0, 0};
  lift_ = cross(drag_, reference.pitch_axis);
  const double length = norm(lift_);
  lift_ = length > 1e-12 ? (1 / length) * lift_ : tangents(drag_).a;
  if (speed_ == 0) speed_ = most_probable_speed(stream.temperature, mean_species(gas).mass);
  pressure_ = 0.5 * density_of(gas, stream) * speed_ * speed_;
}

Coefficients Scale::coefficients(const Load& load) const {
  if (!(pressure_ > 0)) return {};
  const double force = reference_.multiplier / (pressure_ * reference_.area);
  return {force * dot(load.force, drag_), force * dot(load.force, lift_),
          force / reference_.length * dot(load.moment, reference_.pitch_axis), force / speed_ * load.heat};
}

std::vector<int> walls_named(const std::string& name, const std::vector<mesh::Patch>& patches,
                             const std::vector<BoundaryCondition>& conditions) {
  auto found = mesh::find_patches(patches, name);
  std::erase_if(found, [&](int patch) { return !conditions[at(patch)].is_wall(); });
  return found;
}

std::vector<bool> reference_patches(const Reference& reference, const std::vector<mesh::Patch>& patches,
                                    const std::vector<BoundaryCondition>& conditions) {
  std::vector<bool> wanted(patches.size(), false);
  for (std::size_t p = 0; p < patches.size(); ++p) wanted[p] = reference.patches.empty() && conditions[p].is_wall();
  for (const auto& name : reference.patches)
    for (const int patch : walls_named(name, patches, conditions)) wanted[at(patch)] = true;
  return wanted;
}

Load sum_of(const std::vector<Load>& patch, const std::vector<bool>& wanted) {
  Load sum;
  for (std::size_t p = 0; p < patch.size(); ++p)
    if (wanted[p]) sum += patch[p];
  return sum;
}

SurfaceLaw newtonian_law(const Gas& gas, const Stream& stream) {
  return [=](const BoundaryFace& face) -> std::pair<Vec3, double> {
    const double towards = dot(stream.velocity, face.normal);
    if (towards <= 0) return {};
    return {(density_of(gas, stream) * towards * towards) * face.normal, 0};
  };
}

}  // namespace pamr::dsmc
