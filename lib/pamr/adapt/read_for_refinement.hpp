// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "pamr/adapt/balance_parents.hpp"
#include "pamr/base/exact.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::adapt {

/// Whether cells and nodes are put along a space-filling curve before the mesh is refined.
enum class Ordering {
  automatic,  ///< where their numbers say little of where they lie (`order::is_ordered`)
  keep,
  curve,
};
/// By the word of the command line: auto, keep, curve.
Ordering ordering_named(const std::string& name);

struct ReadingOptions {
  std::string marks_field = "refine";  ///< integer cell field, 1 for a cell to be refined; without it cells count alike
  Ordering ordering = Ordering::automatic;
  Balancing balancing = {};                                    ///< whose field of weights is checked
  Exact<bool> build_surfaces = true;                           ///< see `io::ReadOptions`
  std::function<void(const std::string& remark)> remark = {};  ///< see `io::ReadOptions`
};

/// Reads a mesh to be refined, valid, its cells on the ranks in runs that become about the same number of cells:
/// - by the field of the work that belongs to the marks (`balance::work_field`), which is not part of the result;
/// - without it, by what marks and connectivity let expect (`balance::work_from_marks`).
/// Where the mesh was put in order, `cell_origin` has the number of each cell in the file.
/// Errors name cells and nodes by their numbers in the file: if something is wrong with a mesh that was put in order,
/// it is read once more as it is. `timer` gets the steps read, preprocessing and balance. Collective; throws the same
/// `Error` on every rank.
mesh::DistMesh read_for_refinement(const par::Comm& comm, const std::filesystem::path& file,
                                   const ReadingOptions& options, StepTimer& timer);

}  // namespace pamr::adapt
