// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/settle.hpp"

#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/refine/interface_nodes.hpp"
#include "pamr/refine/smooth.hpp"
#include "pamr/refine/untangle.hpp"

namespace pamr::refine {

namespace {

void move_to_targets(const std::vector<Movable>& movables, std::vector<geometry::Vec3>& position) {
  for (const auto& m : movables) position[at(m.node)] = m.target;
}

}  // namespace

Settled settle(const par::Comm& comm, const NewLevel& level, std::vector<geometry::Vec3> position,
               std::vector<Movable> movables) {
  Movement movement;
  movement.is_on_any_rank = comm.any(!movables.empty());
  if (!movement.is_on_any_rank) return certify(comm, level, std::move(position), movement);

  movement.nodes = std::move(movables);
  if (level.mesh.info.level0 != nullptr) {  // new nodes lie where they belong, those inside as well
    movement.cells = cells_with_moved_nodes(level, movement.nodes);
    return certify(comm, level, std::move(position), movement);
  }
  movement.held = interface_nodes(comm, level.mesh, level.numbering, level.shared);
  const auto smoothed = smooth_displacement(comm, level, position, movement);
  movement.nodes.insert(movement.nodes.end(), smoothed.followers.begin(), smoothed.followers.end());
  move_to_targets(movement.nodes, position);
  movement.cells = cells_with_moved_nodes(level, movement.nodes);

  const bool is_gentle = smoothed.max_ratio < gentle_ratio;
  auto untangled = untangle(comm, level, position, std::move(movement), is_gentle);
  movement = std::move(untangled.movement);
  auto settled = certify(comm, level, std::move(position), movement);
  settled.certificate.untangling_rounds = untangled.rounds;
  settled.reaches_open = smoothed.reaches_open || untangled.reaches_open;
  return settled;
}

}  // namespace pamr::refine
