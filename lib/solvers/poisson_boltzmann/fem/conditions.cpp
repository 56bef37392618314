// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"

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
    with_element(domain_, [&](const auto& element) {
      for (std::size_t f = 0; f < domain_.faces.size(); ++f) add_face(element, f);
      if (problem_.manufactured) add_manufactured_source(element);
    });
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
    std::vector<std::int64_t> contradictions(boundary_.size() + 1, 0);  // on each patch, and in all
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
      if (high - low > 1e-9 * std::max({1.0, std::abs(low), std::abs(high)}) && domain_.nodes.is_owned(i)) {
        ++contradictions.back();
        for (std::size_t p = 0; p < boundary_.size(); ++p)
          contradictions[p] += (domain_.node_patches[i] >> p & 1U) != 0 ? 1 : 0;
      }
    }
    comm.sum_in_place(contradictions);
    result_.n_contradictions = contradictions.back();
    contradictions.pop_back();
    result_.contradictions_on = std::move(contradictions);
  }

  template <class Element>
  void add_face(const Element& element, std::size_t f) {
    const int patch = domain_.faces[f].patch;
    const auto& b = *boundary_[at(patch)];
    const bool is_fixed = claim_of(b, patch) != nobody, is_far = b.condition == Condition::far_field;
    if (is_fixed && !Element::has_lumped_walls) return;
    const auto face = element.face(f);
    face.at_wall_points([&](const auto& point) {
      const double flux = is_fixed ? 0 : given_flux(problem_, profile_, b, point);
      const double alpha =
          is_far && Element::has_lumped_walls ? far_field_coefficient(problem_.spheres, point.middle, point.normal) : 0;
      for (std::size_t k = 0; k < face.nodes.size(); ++k) {
        const auto node = at(face.nodes[k]);
        if (is_fixed) result_.fixed_area[node] += point.area * point.value[k];
        result_.load[node] += flux * point.area * point.value[k];
        result_.robin[node] += alpha * point.area * point.value[k];
      }
    });
  }

  /// The equation becomes lap psi = sinh psi + s with s = lap psi* - sinh psi*, lap psi* = -psi*.
  template <class Element>
  void add_manufactured_source(const Element& element) {
    const auto term = problem_.term();
    const auto source = [&](Vec3 point) {
      const double psi = manufactured_potential(point);
      return psi + term.value(psi, 0);
    };
    if (Element::has_lumped_walls && problem_.solver.quadrature == Quadrature::nodal) {
      for (std::size_t c = 0; c < element.cells().size(); ++c) {
        const double quarter = geometry::volume(domain_.points(c)) / 4;
        for (const auto node : element.cells()[c]) result_.load[at(node)] += quarter * source(domain_.point[at(node)]);
      }
      return;
    }
    for (std::size_t c = 0; c < element.cells().size(); ++c) {
      const auto cell = element.cell(c);
      cell.at_points([&](const auto& point) {
        const double amount = point.weight * source(point.position);
        for (std::size_t k = 0; k < cell.nodes.size(); ++k) result_.load[at(cell.nodes[k])] += amount * point.value[k];
      });
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

double given_flux(const Case& input, const PlateProfile& profile, const Boundary& b, const PlacedFacePoint& point) {
  const double z = point.position.z, slope = point.normal.z * profile.slope(z);
  if (b.condition != Condition::far_field)
    return (b.condition == Condition::charge ? b.charge_at(0) : 0) - (input.split ? slope : 0);
  if (input.split) return 0;
  return far_field_coefficient(input.spheres, point.middle, point.normal) * profile.potential(z) + slope;
}

Conditions make_conditions(const par::Comm& comm, const Domain& domain, const Case& problem) {
  return Builder(domain, problem).build(comm);
}

}  // namespace pamr::poisson_boltzmann
