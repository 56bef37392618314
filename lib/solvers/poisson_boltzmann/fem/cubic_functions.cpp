// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/cubic_functions.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Adds the functions of the edges and faces that ranks share to their shared nodes. Both sides of a border list its
/// nodes and its faces in the same order.
par::Pattern shared_functions(const Domain& domain, const std::vector<std::array<LocalId, 4>>& face_of_slot) {
  const auto& nodes = domain.nodes.shared();
  const auto& mesh = *domain.mesh;
  const auto n_corners = mesh.n_nodes();
  const auto n_nodes = static_cast<LocalId>(domain.point.size());
  par::Pattern result;
  for (std::size_t i = 0; i < nodes.rank.size(); ++i) {
    result.rank.push_back(nodes.rank[i]);
    for (auto k = nodes.offset[i]; k < nodes.offset[i + 1]; ++k) result.item.push_back(nodes.item[k]);
    for (auto k = nodes.offset[i]; k < nodes.offset[i + 1]; ++k)
      if (nodes.item[k] >= n_corners) result.item.push_back(n_nodes + nodes.item[k] - n_corners);
    for (std::size_t j = 0; j < mesh.border_rank.size(); ++j) {
      if (mesh.border_rank[j] != nodes.rank[i]) continue;
      for (auto k = mesh.border_offset[j]; k < mesh.border_offset[j + 1]; ++k)
        result.item.push_back(face_of_slot[at(mesh.border_face[k].cell)][at(mesh.border_face[k].slot)]);
    }
    result.offset.push_back(result.item.size());
  }
  return result;
}

/// Function of the face in each slot of each cell, counted from `first`; returns the number after the last.
LocalId number_faces(const mesh::DistMesh& mesh, LocalId first, std::vector<std::array<LocalId, 4>>& face_of_slot) {
  face_of_slot.resize(at(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][slot];
      auto& face = face_of_slot[at(c)][slot];
      if (!mesh.is_own(neighbor) || neighbor > c) {
        face = first++;
        continue;
      }
      const auto& back = mesh.cell_to_cell[at(neighbor)];
      const auto there = std::find(back.begin(), back.end(), c) - back.begin();
      face = face_of_slot[at(neighbor)][static_cast<std::size_t>(there)];
    }
  return first;
}

/// What a patch gives for u at a point.
double given_value(const Problem& problem, const Boundary& b, geometry::Vec3 point) {
  if (b.condition == Condition::potential) return b.value - problem.split_potential(point.z);
  if (b.condition == Condition::manufactured) return manufactured_potential(point);
  return problem.input.split ? 0 : problem.profile.potential(point.z);
}

struct Given {
  double value = 0;
  std::uint8_t is_fixed = 0;
};

}  // namespace

OfCubicCell<double> CubicFunctions::values(std::size_t cell, std::span<const double> coefficient) const {
  OfCubicCell<double> result{};
  for (std::size_t k = 0; k < n_cubic; ++k) result[k] = sign(cell, k) * coefficient[at(cell_to_function[cell][k])];
  return result;
}

CubicAt cubic_at(const PlacedPoint& placed, const OfCellNodes<double>& value, const CubicPoint& cubic) {
  CubicAt result{placed, {}, {}};
  const auto added = gradients(result.placed, cubic);
  for (std::size_t k = 0; k < 10; ++k) {
    result.value[k] = value[k];
    result.value[10 + k] = cubic.value[k];
    result.gradient[k] = result.placed.gradient[k];
    result.gradient[10 + k] = added[k];
  }
  return result;
}

geometry::Vec3 gradient_of(const CubicAt& here, const OfCubicCell<double>& value) {
  geometry::Vec3 sum;
  for (std::size_t k = 0; k < n_cubic; ++k) sum += value[k] * here.gradient[k];
  return sum;
}

OfCubicFace<double> CubicFunctions::face_values(std::size_t face, std::size_t number) const {
  OfCubicFace<double> result{};
  const auto& point = face_points()[number];
  const auto& l = point.barycentric;
  for (std::size_t k = 0; k < 6; ++k) result[k] = point.value[k];
  for (std::size_t k = 0; k < 3; ++k)
    result[6 + k] = face_sign(face, 6 + k) * l[k] * l[(k + 1) % 3] * (l[k] - l[(k + 1) % 3]);
  result[9] = l[0] * l[1] * l[2];
  return result;
}

double CubicFunctions::on_face(std::size_t face, const OfCubicFace<double>& shape,
                               std::span<const double> coefficient) const {
  double sum = 0;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += shape[k] * coefficient[at(face_to_function[face][k])];
  return sum;
}

CubicFunctions number_cubic(const par::Comm& comm, const Domain& domain) {
  const auto& mesh = *domain.mesh;
  const auto& elements = *domain.quadratic;
  const auto n_nodes = static_cast<LocalId>(domain.point.size()), n_corners = mesh.n_nodes();
  std::vector<std::array<LocalId, 4>> face_of_slot;
  const auto n_functions = number_faces(mesh, 2 * n_nodes - n_corners, face_of_slot);
  const auto edge_of = [&](LocalId middle) { return n_nodes + middle - n_corners; };
  const auto n_outer = comm.sum(std::count_if(domain.faces.begin(), domain.faces.end(),
                                              [](const BoundaryFace& face) { return !face.is_inside; }));
  const auto n_global =
      2 * elements.n_global_nodes - mesh.info.n_global_nodes + (4 * mesh.info.n_global_cells + n_outer) / 2;
  CubicFunctions result{
      NodeMap(comm, shared_functions(domain, face_of_slot), at(n_functions), n_global), {}, {}, {}, {}};

  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    const auto& nodes = elements.cell_to_node[c];
    auto& functions = result.cell_to_function.emplace_back();
    unsigned flips = 0;
    for (std::size_t k = 0; k < 10; ++k) functions[k] = nodes[k];
    for (std::size_t e = 0; e < 6; ++e) {
      functions[10 + e] = edge_of(nodes[4 + e]);
      const auto [a, b] = mesh::tet::edge_to_corner[e];
      if (mesh.node_global[at(nodes[at(a)])] > mesh.node_global[at(nodes[at(b)])]) flips |= 1U << e;
    }
    for (std::size_t f = 0; f < 4; ++f) functions[16 + f] = face_of_slot[c][f];
    result.cell_flips.push_back(static_cast<std::uint8_t>(flips));
  }
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& nodes = elements.face_to_node[f];
    auto& functions = result.face_to_function.emplace_back();
    unsigned flips = 0;
    for (std::size_t k = 0; k < 6; ++k) functions[k] = nodes[k];
    for (std::size_t k = 0; k < 3; ++k) {
      functions[6 + k] = edge_of(nodes[3 + k]);
      if (mesh.node_global[at(nodes[k])] > mesh.node_global[at(nodes[(k + 1) % 3])]) flips |= 1U << k;
    }
    const auto cell = at(domain.faces[f].cell);
    for (std::size_t slot = 0; slot < 4; ++slot)
      if (std::find(nodes.begin(), nodes.begin() + 3, mesh.cell_to_node[cell][slot]) == nodes.begin() + 3)
        functions[9] = face_of_slot[cell][slot];
    result.face_flips.push_back(static_cast<std::uint8_t>(flips));
  }
  return result;
}

CubicConditions cubic_conditions(const par::Comm& comm, const Problem& problem, const CubicFunctions& functions,
                                 std::span<const double> u) {
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  std::vector<Given> given(functions.all.n_nodes());
  for (std::size_t i = 0; i < domain.point.size(); ++i) given[i].is_fixed = problem.conditions.fixed[i];
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& b = problem.boundary_of(domain.faces[f]);
    if (!fixes_potential(b.condition)) continue;
    const auto& nodes = elements.face_to_node[f];
    const auto position = positions(domain, nodes);
    // Where another patch has another potential, the jump is on this face, and nothing smooth is to be added.
    const bool is_alone = std::all_of(nodes.begin(), nodes.end(), [&](LocalId node) {
      return problem.conditions.deciding_patch[at(node)] == domain.faces[f].patch;
    });
    const bool is_smooth = is_alone || problem.conditions.n_contradictions == 0;
    const auto missing = [&](const std::array<double, 3>& barycentric) {
      const auto point = face_point(barycentric);
      double value = given_value(problem, b, place(position, point).position);
      for (std::size_t k = 0; k < 6; ++k) value -= point.value[k] * u[at(nodes[k])];
      return is_smooth ? value : 0;
    };
    const auto& of_face = functions.face_to_function[f];
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> near{}, far{};
      near[k] = far[(k + 1) % 3] = 0.75;
      near[(k + 1) % 3] = far[k] = 0.25;
      const double amplitude = (missing(near) - missing(far)) / (3.0 / 16);  // the function is 3/32 there
      given[at(of_face[6 + k])] = {functions.face_sign(f, 6 + k) * amplitude, 1};
    }
    given[at(of_face[9])] = {27 * missing({1.0 / 3, 1.0 / 3, 1.0 / 3}), 1};
  }
  par::fold_in_rank_order(par::Exchange(comm, functions.all.shared()), given,
                          [](Given a, Given b) { return a.is_fixed != 0 ? a : b; });
  CubicConditions result;
  for (const auto& [value, is_fixed] : given) {
    result.fixed.push_back(is_fixed);
    result.value.push_back(value);
  }
  return result;
}

}  // namespace pamr::poisson_boltzmann
