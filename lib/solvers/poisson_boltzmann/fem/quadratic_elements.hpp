// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pamr/curved/curve_cells.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_element.hpp"

namespace pamr::poisson_boltzmann {

struct Domain;

/// What cells of second order add to a domain, whose nodes are then the corners, as in the mesh, and after them the
/// mid-edge nodes.
struct QuadraticElements {
  std::vector<OfCellNodes<LocalId>> cell_to_node;  ///< n_cells
  std::vector<OfFaceNodes<LocalId>> face_to_node;  ///< of `Domain::faces`
  std::vector<GlobalId> node_global;               ///< of all nodes
  GlobalId n_global_nodes = 0;
  curved::Report report;  ///< of curving the cells
};

/// Gives the cells of a domain nodes on their edges, and with them its `nodes`, `point` and `quadratic`. `face_slot`:
/// for each of its faces the corner of the cell that lies opposite. Collective.
void make_quadratic(const par::Comm& comm, std::span<const int> face_slot, Domain& domain);

/// What holds at the corners, on all nodes: the mid-edge nodes get the mean of the ends of their edge. Local.
std::vector<double> on_all_nodes(const Domain& domain, std::span<const double> at_corners);

}  // namespace pamr::poisson_boltzmann
