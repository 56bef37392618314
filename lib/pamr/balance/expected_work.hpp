// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// What refining will cost in each cell, in cells that come of it, before the mesh is put together: by it the cells are
/// distributed when they are read. Where it is wrong the refined mesh is the same and the ranks are less even.
namespace pamr::balance {

/// Name of the integer cell field of the work (1 to 255) that belongs to a field of marks: who writes the marks may
/// know it exactly (`adapt::Forecast`).
std::string work_field(const std::string& marks_field);
inline constexpr auto work_type = mesh::StorageType::uint8;  ///< of a field that `set_work` has put

/// Puts that field into the mesh in place of an older one; without `work` only removes the older one. On all ranks or
/// on none. Local.
void set_work(mesh::DistMesh& mesh, const std::string& marks_field,
              const std::optional<std::vector<std::uint8_t>>& work);

/// The work that such a field states; values out of range count as 1 or 255.
std::vector<std::uint8_t> work_from_values(std::span<const std::int64_t> values);

/// About how many cells each of a block of cells becomes when the marked ones are refined, in eighths of a cell, from
/// the block alone:
/// - 64 for a marked cell; for another one by how many of its edges are edges of marked cells of the block.
/// - A closure cell that is marked counts 40, since its family becomes one cell that is split before; where none of a
///   family is marked, its members count by the edges of the one that has most.
/// - `cell_to_node`: n x 4, global ids; `marks`: n values, 1 for a marked cell; `lineage`: n, or empty where all cells
///   are regular. The block may begin and end in the midst of a family.
/// - The largest of 64 parts is within 2 to 10 % of the mean for the marks of a flow around a cone (1,000,000 to 60,000
///   refined cells); the exact number is known after `refine::close`. An edge is one hashed bit, so one in fifty or
///   fewer may be taken for that of a marked cell that it is not.
/// Local. Memory: a byte a cell and at most 16 bytes for each of the block.
std::vector<std::uint8_t> work_from_marks(std::span<const std::array<GlobalId, 4>> cell_to_node,
                                          std::span<const std::int64_t> marks, std::span<const mesh::Lineage> lineage);

/// The number of cells in the runs of the ranks before this one when the runs are about the same work: the row at which
/// this rank's run begins. `work`: of this rank's cells, the ranks' cells following one another. Collective: a gather
/// of a number a rank and a reduction.
GlobalId first_cell_of_run(const par::Comm& comm, std::span<const std::uint8_t> work);

}  // namespace pamr::balance
