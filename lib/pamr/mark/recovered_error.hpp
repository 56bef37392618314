// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mark/indicator.hpp"

namespace pamr::mark {

/// Error of the gradient of a nodal field, estimated by comparing it with a smoother, recovered one.
struct RecoveredError {
  std::vector<double> squared;  ///< e_K^2 of each cell of this rank: integral over the cell of |G* - grad f|^2
  double total_squared = 0;     ///< sum of e_K^2 over all cells
  double norm_squared = 0;      ///< integral of |grad f|^2 over the mesh
};

/// The recovered gradient G* is linear in each cell; at a node it is the mean of the gradients of the cells around it,
/// weighted with their volumes. The gradient of f itself is constant in a cell. Sums over the cells around a node are
/// kept in 64-bit fixed point scaled to the largest of them, those over the mesh are exact, so every number has the
/// same bits for every number of ranks and every order of the cells.
/// Collective: finds the shared nodes, two exchanges, one reduction. O(cells); 72 bytes a node of memory. Throws
/// `Error` on every rank when there is no nodal field of that name, it has several components or a value that is not
/// finite. Pre: every cell has positive volume. Source: O. C. Zienkiewicz, J. Z. Zhu, "A simple error estimator and
/// adaptive procedure for practical engineering analysis", Int. J. Numer. Meth. Engng 24 (1987).
RecoveredError recovered_error(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field);

/// Cells whose squared error is above theta times the mean square: e_K^2 > theta * norm_squared / cells, both rounded
/// to 20 bits. A tolerance eps for the relative error is theta = eps^2. Indicator: by how much, over the bar.
/// Local. Throws `Error` when theta is not positive.
Indicator above_mean_share(const RecoveredError& error, Exact<GlobalId> n_global_cells, double theta);

/// The fewest cells that carry at least `fraction` of the total squared error, those of largest error first (errors
/// rounded to 20 bits; ties by the centroid's coordinates). Indicator: the squared error. Collective: up to 64 choices
/// of cells. Throws `Error` when the fraction is not within 0 to 1. Source: W. Doerfler, "A convergent adaptive
/// algorithm for Poisson's equation", SIAM J. Numer. Anal. 33 (1996).
Indicator bulk_of_error(const par::Comm& comm, const mesh::DistMesh& mesh, const RecoveredError& error,
                        double fraction);

}  // namespace pamr::mark
