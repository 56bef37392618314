// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pamr/coarsen/coarsen.hpp"
#include "pamr/coarsen/octets.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::coarsen {

/// Which fields are carried how.
struct FieldRules {
  std::vector<std::string> left_out{};   ///< cell fields that the coarse mesh does not have
  std::vector<std::string> integrals{};  ///< cell fields of reals of which sums of value times volume are kept
};

/// Gives the coarse mesh what splits have to know of level 0: the fields of `mesh::Level0Map`, if there is one. Local.
void carry_level0(const mesh::DistMesh& old, std::span<const Group> groups, Coarsened& coarsened);

/// Gives the coarse mesh the other fields of the old one, and `cell_origin`.
/// - Nodal fields: nodes that stay keep their values. `off_surface` and `off_facets` are dropped when no node is left
///   that they say anything of.
/// - Cell fields of reals: the cells of a group get the mean of those that they replace, weighted by volume: where
///   these have one value, that value exactly. Those in `integrals`: the sum of value times volume over the volume of
///   the new cells; the two differ at walls whose nodes were moved.
/// - Cell fields of integers: the value that most of the group's volume has; of equal ones the smallest.
/// - `cell_origin`: the number of the old cell that holds a new cell's centroid.
///
/// `groups`: those that made it. Collective: one reduction. Cost: O(cells) for each field.
void carry_fields(const par::Comm& comm, const mesh::DistMesh& old, std::span<const Group> groups,
                  const FieldRules& rules, Coarsened& coarsened);

/// A cell that is in the mesh no more: `number` is its own, `into` that of an old cell (a `parent` in the new mesh)
/// whose place in the new mesh holds its centroid.
struct Merged {
  GlobalId number = 0;
  GlobalId into = 0;
};

/// The cells of the groups that are nobody's origin, ascending. Pre: `carry_fields` was called. Local.
std::vector<Merged> find_merged(const mesh::DistMesh& old, std::span<const Group> groups, const Coarsened& coarsened);

}  // namespace pamr::coarsen
