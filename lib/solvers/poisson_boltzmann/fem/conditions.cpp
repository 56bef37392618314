// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_stiffness.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

constexpr int nobody = std::numeric_limits<int>::max();

/// Order in which patches decide a node that several of them fix; `nobody` for those that do not.
int claim_of(const Boundary& boundary, int patch) {
  switch (boundary.condition) {
    case Condition::potential:
      return patch;
    case Condition::manufactured:
      return 1000 + patch;
    case Condition::plate_profile:
      return 2000 + patch;
    default:
      return nobody;
  }
}

class Builder {
 public:
  Builder(const Domain& domain, const Case& problem) : domain_(domain), problem_(problem), profile_(problem.profile()) {
    for (const auto& patch : domain.mesh->info.patches) boundary_.push_back(problem.find_boundary(patch.name));
  }

  Conditions build(const par::Comm& comm) {
    const auto n = domain_.point.size();
    result_.psi0.assign(n, 0);
    if (problem_.split) split_off_profile();
    result_.robin.assign(n, 0);
    result_.load.assign(n, 0);
    result_.fixed_area.assign(n, 0);
    fix_nodes(comm);
    if (domain_.quadratic) {
      result_.load = quadratic_load(domain_, problem_);
    } else {
      for (const auto& face : domain_.faces) add_face(face);
      if (problem_.manufactured) add_manufactured_source();
    }
    domain_.nodes.sum_copies(comm, result_.robin);
    domain_.nodes.sum_copies(comm, result_.load);
    domain_.nodes.sum_copies(comm, result_.fixed_area);
    return std::move(result_);
  }

 private:
  /// Nodes of the plate have its potential to the last bit: a high potential falls by many digits over a distance that
  /// rounding of their heights is worth.
  void split_off_profile() {
    const int plate = domain_.patch_number(problem_.plate->patch);
    for (std::size_t i = 0; i < result_.psi0.size(); ++i)
      result_.psi0[i] = (domain_.node_patches[i] >> static_cast<unsigned>(plate) & 1U) != 0
                            ? problem_.plate->potential
                            : profile_.potential(domain_.point[i].z);
  }

  double fixed_value(int patch, std::size_t node) const {
    const auto& b = *boundary_[at(patch)];
    const auto point = domain_.point[node];
    if (b.condition == Condition::potential) return b.value - result_.psi0[node];
    if (b.condition == Condition::manufactured) return manufactured_potential(point);
    return problem_.split ? 0 : profile_.potential(point.z);
  }

  void fix_nodes(const par::Comm& comm) {
    const auto n = domain_.point.size();
    result_.fixed.assign(n, 0);
    result_.value.assign(n, 0);
    result_.deciding_patch.assign(n, -1);
    std::int64_t n_contradictions = 0;
    for (std::size_t i = 0; i < n; ++i) {
      int best = nobody;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t p = 0; p < boundary_.size(); ++p) {
        if ((domain_.node_patches[i] >> p & 1U) == 0) continue;
        const int claim = claim_of(*boundary_[p], static_cast<int>(p));
        best = std::min(best, claim);
        if (claim == nobody) continue;
        const double value = fixed_value(static_cast<int>(p), i);
        low = std::min(low, value);
        high = std::max(high, value);
      }
      if (best == nobody) continue;
      result_.fixed[i] = 1;
      result_.deciding_patch[i] = best % 1000;
      result_.value[i] = fixed_value(best % 1000, i);
      if (high - low > 1e-9 * std::max({1.0, std::abs(low), std::abs(high)}) && domain_.nodes.is_owned(i))
        ++n_contradictions;
    }
    result_.n_contradictions = comm.sum(n_contradictions);
  }

  void add_face(const BoundaryFace& face) {
    const auto& b = *boundary_[at(face.patch)];
    const double third = face.area / 3;
    if (claim_of(b, face.patch) != nobody) {
      for (const auto node : face.node) result_.fixed_area[at(node)] += third;
      return;
    }
    double alpha = 0;
    if (b.condition == Condition::far_field) {
      Vec3 middle;
      for (const auto node : face.node) middle += (1.0 / 3) * domain_.point[at(node)];
      alpha = far_field_coefficient(problem_.spheres, middle, face.normal);
    }
    for (const auto node : face.node) {
      const auto i = at(node);
      const double z = domain_.point[i].z, slope = face.normal.z * profile_.slope(z);
      result_.robin[i] += alpha * third;
      if (b.condition == Condition::far_field) {
        if (!problem_.split) result_.load[i] += third * (alpha * profile_.potential(z) + slope);
      } else {
        const double charge = b.condition == Condition::charge ? b.value : 0;
        result_.load[i] += third * (charge - (problem_.split ? slope : 0));
      }
    }
  }

  /// The equation becomes lap psi = sinh psi + s with s = lap psi* - sinh psi*, lap psi* = -psi*.
  void add_manufactured_source() {
    const auto term = problem_.term();
    const auto source = [&](Vec3 point) {
      const double psi = manufactured_potential(point);
      return -psi - term.value(psi, 0);
    };
    const auto& cells = domain_.mesh->cell_to_node;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto p = domain_.points(c);
      const double volume = geometry::volume(p);
      if (problem_.solver.quadrature == Quadrature::nodal) {
        for (std::size_t k = 0; k < 4; ++k) result_.load[at(cells[c][k])] -= volume / 4 * source(p[k]);
        continue;
      }
      for (const auto& gauss : gauss_points) {
        Vec3 point;
        for (std::size_t k = 0; k < 4; ++k) point += gauss.weight_of_corner[k] * p[k];
        const double amount = volume * gauss.weight * source(point);
        for (std::size_t k = 0; k < 4; ++k) result_.load[at(cells[c][k])] -= amount * gauss.weight_of_corner[k];
      }
    }
  }

  const Domain& domain_;
  const Case& problem_;
  PlateProfile profile_;
  std::vector<const Boundary*> boundary_;
  Conditions result_;
};

}  // namespace

double manufactured_potential(Vec3 p) { return 2 * std::sin(p.x) * std::cos(p.y) * std::exp(-p.z); }

Vec3 manufactured_gradient(Vec3 p) {
  const double decay = 2 * std::exp(-p.z);
  return {decay * std::cos(p.x) * std::cos(p.y), -decay * std::sin(p.x) * std::sin(p.y),
          -decay * std::sin(p.x) * std::cos(p.y)};
}

double far_field_coefficient(const std::vector<Sphere>& spheres, Vec3 point, Vec3 normal) {
  if (spheres.empty()) return 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& s : spheres) nearest = std::min(nearest, norm(point - s.center) - s.radius);
  double sum = 0, slope = 0;
  for (const auto& s : spheres) {
    const auto away = point - s.center;
    const double distance = norm(away);
    const double share = s.radius * std::exp(nearest - (distance - s.radius)) / distance;
    sum += share;
    slope += share * (1 + 1 / distance) * dot(away, normal) / distance;
  }
  return std::max(0.0, slope / sum);
}

Conditions make_conditions(const par::Comm& comm, const Domain& domain, const Case& problem) {
  return Builder(domain, problem).build(comm);
}

}  // namespace pamr::poisson_boltzmann
