// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/box_of_nodes.hpp"

#include <array>

namespace pamr::mesh {

geometry::Box box_over_ranks(const par::Comm& comm, const geometry::Box& here) {
  const auto& [low, high] = here;
  std::array<double, 6> bound{-low.x, -low.y, -low.z, high.x, high.y, high.z};
  comm.max_in_place(bound);
  return {{-bound[0], -bound[1], -bound[2]}, {bound[3], bound[4], bound[5]}};
}

geometry::Box box_of_nodes(const par::Comm& comm, const DistMesh& mesh) {
  return box_over_ranks(comm, geometry::box_of(mesh.node_position));
}

}  // namespace pamr::mesh
