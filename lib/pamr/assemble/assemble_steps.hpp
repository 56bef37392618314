// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// The steps of `assemble`, in its order. Private to the library.
namespace pamr::assemble {

/// What the blocks hold, the same on every rank.
struct Contents {
  bool has_neighbors = false;
  bool has_lineage = false;
  bool has_origin = false;
  bool has_destinations = false;
};

/// Refuses blocks whose sizes do not fit together and numbers out of range. Collective.
Contents check_block(const par::Comm& comm, const mesh::BlockMesh& block, std::span<const Rank> destination);

/// The rank each cell of the block goes to: its destination, or this rank where there are none; whole closure families
/// go where their first member goes. Refuses families that are not whole. Collective: one sparse exchange.
std::vector<Rank> family_destinations(const par::Comm& comm, const mesh::BlockMesh& block,
                                      std::span<const Rank> destination, const Contents& contents);

/// This rank's cells in global numbers, ascending.
struct GlobalCells {
  std::vector<GlobalId> id;
  std::vector<std::array<GlobalId, 4>> node;
  std::vector<std::array<GlobalId, 4>> neighbor;  ///< empty: to be built
  std::vector<mesh::Lineage> lineage;
  std::vector<GlobalId> origin;  ///< empty: none
  std::vector<mesh::CellField> field;
};

/// The cells of the block, taken out of it, without numbers; lineage is made where there is none. Local.
GlobalCells take_cells(mesh::BlockMesh& block, const Contents& contents);

/// Sends the cells, which have their numbers in any order, to the ranks `to`, in rounds of at most 2^17 cells a rank;
/// what is then here ascends. Collective.
void exchange_cells(const par::Comm& comm, GlobalCells& cells, const std::vector<Rank>& to, const Contents& contents);

/// Sends the cells to their ranks, in rounds of at most 2^17 cells a rank. Takes the cells out of the block.
/// Collective.
GlobalCells send_cells(const par::Comm& comm, mesh::BlockMesh& block, std::vector<Rank> to, const Contents& contents);

/// Who holds a cell: ascending first cells of the ranks where every rank holds a run of numbers, else the ranks of the
/// canonical block of cells, to be asked for.
struct CellOwners {
  std::vector<GlobalId> first;
  std::vector<Rank> of_block;
};

/// Collective.
CellOwners find_owners(const par::Comm& comm, IdRange cells, const std::vector<GlobalId>& id, const Contents& contents);

/// Sets `cell_to_cell` and the rank-border faces from global neighbors, whose patches must be in range. Refuses
/// neighbors that are not reciprocal. Collective.
void link_neighbors(const par::Comm& comm, mesh::DistMesh& mesh, std::vector<std::array<GlobalId, 4>> neighbor,
                    const CellOwners& owners);

/// Sets them from the nodes alone; faces without a second cell get patch 0. Refuses a face in three cells. Collective.
void build_neighbors(const par::Comm& comm, mesh::DistMesh& mesh);

}  // namespace pamr::assemble
