// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"

namespace pamr::poisson_boltzmann {

/// Ratios up to which a layer counts as resolved, and beyond which charges and surface forms of a patch are not given.
inline constexpr double largest_resolved_layer_ratio = 1, largest_layer_ratio = 3;

/// How the cells on a patch compare with the layer of counterions in front of it.
struct Layer {
  double thickness = 0;  ///< the thinnest, Debye lengths: `layer_thickness` of the potential there
  double height = 0;     ///< of the cells over their faces: root of the mean square, Debye lengths
  /// Height over thickness, root of the mean square over the area. At 1 a charge is some 30 % off, at 0.5 some 7 %.
  double ratio = 0;
  double n_cells = 0;     ///< that a resolved layer would take on the meshed part: ten a squared thickness
  bool is_known = false;  ///< the plate's own layer, which is split off exactly: only surface forms need the cells
  bool is_lost = false;   ///< nothing that is taken at the patch means anything: `ratio` or `n_cells` is too large

  /// By which a charge of first order is too large at such a ratio.
  double excess_percent() const { return 30 * ratio * ratio; }
  bool is_resolved() const { return ratio <= largest_resolved_layer_ratio; }
};

struct Layers {
  std::vector<Layer> patches;      ///< one for each patch of the mesh; ratio 0 where it holds no charge or potential
  std::vector<double> cell_ratio;  ///< n_cells: height over thickness at faces on such patches, 0 elsewhere
};

/// Collective: exact sums. `max_cells` is the largest mesh that the user would make.
Layers find_layers(const par::Comm& comm, const State& state, double max_cells);

}  // namespace pamr::poisson_boltzmann
