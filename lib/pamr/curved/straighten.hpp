// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"

namespace pamr::curved {

struct Options {
  /// Share of the straight cell's Jacobian determinant that a curved cell keeps everywhere, in (0, 1): at 0 cells may
  /// be nearly folded, where derivatives of finite elements have no bound. Gmsh optimizes cells below the same value.
  double min_jacobian = 0.1;
};

/// What straightening took; counts over all ranks.
struct Straightening {
  std::int64_t n_edges = 0;  ///< edges that are less curved than their surfaces, or straight, so that cells keep shape
  std::int64_t n_cells = 0;  ///< cells because of which
  std::int64_t n_cut = 0;    ///< cells that had to be cut into pieces for their proof
  double min_jacobian = 1;   ///< proved of every curved cell: share of the straight cell's that it keeps everywhere
  int rounds = 0;            ///< exchanges with the neighbors
};

/// How far each node of `movables` went, in halvings of its way: 0 all of it, `not_at_all` or more nothing.
inline constexpr std::uint8_t not_at_all = 10;
struct Straightened {
  std::vector<std::uint8_t> step;  ///< of each movable
  Straightening report;
};

/// Takes the curved edges of cells that are not proved positive back towards their chords, by half of what is left each
/// time, at last all of it, until every cell is proved. A cell asks for all its curved edges; an edge goes as far as
/// the cell that asks most. What is reached depends on neither order nor ranks.
///
/// `movables`: mid-edge nodes that are not meant to lie in the middle, ascending, their positions in `nodes` at their
/// targets; `shared`: the nodes that other ranks hold too. Changes positions in `nodes`. Collective: one neighbor
/// exchange and one reduction a round.
Straightened straighten(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<refine::Movable>& movables,
                        const par::Pattern& shared, const Options& options, mesh::SecondOrder& nodes);

}  // namespace pamr::curved
