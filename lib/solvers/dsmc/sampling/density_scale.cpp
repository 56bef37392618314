// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/density_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr double endless = 1e30;

/// Volume and molecules of the cells around a node, in fixed point.
using Sums = std::array<std::int64_t, 2>;

/// Density at each node.
std::vector<double> at_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const double> density,
                             std::span<const double> volumes) {
  constexpr int term_bits = 48;  // of the largest term: 2^15 of them fit into a sum
  std::array<double, 2> largest{0, 0};
  for (std::size_t c = 0; c < density.size(); ++c) {
    largest[0] = std::max(largest[0], volumes[c]);
    largest[1] = std::max(largest[1], volumes[c] * density[c]);
  }
  for (auto& one : largest) one = comm.max(one);
  const auto fixed = [&](double value, std::size_t k) {
    return largest[k] > 0 ? std::llrint(std::ldexp(value / largest[k], term_bits)) : 0;
  };
  std::vector<Sums> sums(mesh.node_position.size(), Sums{});
  for (std::size_t c = 0; c < density.size(); ++c)
    for (const LocalId node : mesh.cell_to_node[c]) {
      sums[at(node)][0] += fixed(volumes[c], 0);
      sums[at(node)][1] += fixed(volumes[c] * density[c], 1);
    }
  const auto borders = mesh::find_borders(comm, mesh);
  par::fold_shared(par::Exchange(comm, borders.nodes), sums, [](Sums& mine, const Sums& theirs) {
    for (std::size_t i = 0; i < 2; ++i) mine[i] += theirs[i];
  });
  std::vector<double> result(sums.size(), 0.0);
  for (std::size_t n = 0; n < sums.size(); ++n)
    if (sums[n][0] > 0)
      result[n] = static_cast<double>(sums[n][1]) / static_cast<double>(sums[n][0]) * (largest[1] / largest[0]);
  return result;
}

}  // namespace

std::vector<double> density_scale(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const double> density) {
  PAMR_EXPECTS(density.size() == mesh.cell_to_node.size());
  std::vector<double> volumes;
  for (std::size_t c = 0; c < density.size(); ++c) volumes.push_back(volume(mesh.points(static_cast<LocalId>(c))));
  const auto nodal = at_nodes(comm, mesh, density, volumes);
  std::vector<double> scale;
  for (std::size_t c = 0; c < density.size(); ++c) {
    const auto p = mesh.points(static_cast<LocalId>(c));
    double mean = 0;
    Vec3 gradient;  // times 6 volumes
    for (std::size_t i = 0; i < 4; ++i) {
      const double value = nodal[at(mesh.cell_to_node[c][i])];
      const auto& face = mesh::tet::face_to_corner[i];  // its outward normal points away from corner i
      mean += 0.25 * value;
      gradient = gradient - value * cross(p[at(face[1])] - p[at(face[0])], p[at(face[2])] - p[at(face[0])]);
    }
    const double slope = norm(gradient) / (6 * volumes[c]);
    scale.push_back(mean > 0 && mean < endless * slope ? mean / slope : endless);
  }
  return scale;
}

}  // namespace pamr::dsmc
