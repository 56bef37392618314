// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/second_order.hpp"

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh {

geometry::QuadraticTet quadratic_tet(const DistMesh& mesh, const SecondOrder& second_order, LocalId cell) {
  geometry::QuadraticTet node;
  for (std::size_t i = 0; i < 4; ++i) node[i][i] = second_order.node_position[at(mesh.cell_to_node[at(cell)][i])];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = tet::edge_to_corner[e];
    node[at(a)][at(b)] = node[at(b)][at(a)] = second_order.node_position[at(second_order.cell_to_mid[at(cell)][e])];
  }
  return node;
}

}  // namespace pamr::mesh
