// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/quadratic_elements.hpp"

#include <memory>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "solvers/poisson_boltzmann/fem/fem_domain.hpp"

namespace pamr::poisson_boltzmann {

void make_quadratic(const par::Comm& comm, std::span<const int> face_slot, Domain& domain) {
  const auto& mesh = *domain.mesh;
  auto [nodes, report] = curved::curve_cells(comm, mesh);
  QuadraticElements elements;
  elements.report = report;
  elements.n_global_nodes = nodes.n_global_nodes;
  domain.nodes = NodeMap(comm, std::move(nodes.shared), nodes.node_global, nodes.n_global_nodes);
  domain.point.clear();
  for (const auto& p : nodes.node_position) domain.point.push_back(domain.scale * p);
  elements.node_global = std::move(nodes.node_global);
  elements.cell_to_node.resize(mesh.cell_to_node.size());
  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    for (std::size_t k = 0; k < 4; ++k) elements.cell_to_node[c][k] = mesh.cell_to_node[c][k];
    for (std::size_t e = 0; e < 6; ++e) elements.cell_to_node[c][4 + e] = nodes.cell_to_mid[c][e];
  }
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto cell = at(domain.faces[f].cell);
    const auto& corner = mesh::tet::face_to_corner[at(face_slot[f])];
    auto& face = elements.face_to_node.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      face[k] = mesh.cell_to_node[cell][at(corner[k])];
      face[3 + k] = nodes.cell_to_mid[cell][at(mesh::tet::edge_of[at(corner[k])][at(corner[(k + 1) % 3])])];
    }
  }
  domain.quadratic = std::make_shared<const QuadraticElements>(std::move(elements));
}

std::vector<double> on_all_nodes(const Domain& domain, std::span<const double> at_corners) {
  std::vector<double> result(at_corners.begin(), at_corners.end());
  result.resize(domain.point.size(), 0);
  for (const auto& nodes : domain.quadratic->cell_to_node)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [i, j] = mesh::tet::edge_to_corner[e];
      result[at(nodes[4 + e])] = 0.5 * (result[at(nodes[at(i)])] + result[at(nodes[at(j)])]);
    }
  return result;
}

}  // namespace pamr::poisson_boltzmann
