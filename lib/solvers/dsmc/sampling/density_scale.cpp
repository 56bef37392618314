// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/density_scale.hpp"

#include <array>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mark/recovery.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr double endless = 1e30;

}  // namespace

std::vector<double> density_scale(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const double> density) {
  PAMR_EXPECTS(density.size() == mesh.cell_to_node.size());
  std::vector<double> volumes;
  for (std::size_t c = 0; c < density.size(); ++c) volumes.push_back(volume(mesh.points(static_cast<LocalId>(c))));
  const auto borders = mesh::find_borders(comm, mesh);
  const auto nodal = mark::nodal_means<double>(par::Exchange(comm, borders.nodes), mesh.node_position.size(),
                                               mesh.cell_to_node, volumes, density);
  std::vector<double> scale;
  for (std::size_t c = 0; c < density.size(); ++c) {
    std::array<double, 4> at_corner{};
    for (std::size_t i = 0; i < 4; ++i) at_corner[i] = nodal[at(mesh.cell_to_node[c][i])];
    const double mean = 0.25 * ((at_corner[0] + at_corner[1]) + (at_corner[2] + at_corner[3]));
    const double slope = norm(mark::linear_gradient(mesh.points(static_cast<LocalId>(c)), at_corner, volumes[c]));
    scale.push_back(mean > 0 && mean < endless * slope ? mean / slope : endless);
  }
  return scale;
}

}  // namespace pamr::dsmc
